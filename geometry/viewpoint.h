#pragma once
// What is seen of polygons from one point, exactly.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/view.h"

namespace exitance {

/// A convex source: a whole facet (empty loop) or a piece of it, whose loop runs counter-clockwise seen from the
/// facet's front. A point of a piece lies in the facet's plane by identity: if rounded, it stands for the point exactly
/// in the plane to which it drops along a coordinate axis (ViewFrame). Pieces that share corners tile the facet
/// exactly, whatever lies in contact with it, and edges that they do not share with it miss its edges by a rounding: of
/// what protrudes from the facet so, only occluders that hide something of the facet itself hide anything.
struct Source {
  std::uint32_t facet = 0;
  std::span<const Vec3> loop;
};

/// The corners of a source, of whichever kind.
std::vector<Vec3> corners_of(const PolygonSoup& soup, const Source& source);

enum class Side : std::uint8_t { front, back, edge_on };

enum class Visibility : std::uint8_t {
  away,     ///< below the receiver's horizon, edge-on, or in the receiver's own plane: nothing can be seen
  open,     ///< no occluder reaches between: closed form
  partial,  ///< occluders hide some of it
  blocked   ///< nothing is left
};

/// Form factor from a point to the visible part of a source, and a proven bound of its error.
struct PointFormFactor {
  double F = 0;
  double error = 0;
  Side side = Side::edge_on;  ///< which side of the source the point sees; energy comes from the front only
  Visibility visibility = Visibility::away;
};

/// A stretch of the boundary of a visible region, in the source's plane; the region lies to its left as seen from the
/// point.
struct BoundaryPiece {
  Vec3 from, to;
  bool of_source = false;  ///< lies on the source's own boundary or on the horizon, else on an occluder's shadow
};

/// An edge of what is seen of a source: the line in space that it lies on, the same from every point of a receiver, and
/// the stretch of it that bounds.
struct SeenEdge {
  std::uint64_t id = 0;  ///< of the line
  Vec3 a, b;             ///< two points of the line
  Vec3 from, to;         ///< ends of the stretch, as unit vectors from the point of view
};

/// One point of view. Holds scratch memory: one object a thread, used for many points of one soup, which must outlive
/// it.
class Viewpoint {
 public:
  explicit Viewpoint(const PolygonSoup& soup);
  ~Viewpoint();
  Viewpoint(Viewpoint&&) noexcept;
  Viewpoint& operator=(Viewpoint&&) noexcept;

  /// Sets the point. Throws std::invalid_argument on a zero or non-finite normal and on a non-finite point.
  void look_from(const Receiver& receiver);

  /// Whether something that lies in the receiver's own plane covers it (only a receiver on a facet can be), a solid
  /// that touches its surface included: it sees nothing, and all its form factors are 0.
  bool covered() const;

  /// F from the point to the visible part of the source, from whichever side it is seen. Where double precision cannot
  /// prove an error within `tolerance`, it is computed again with more digits, at last with 80; what can be proven then
  /// is in `error`.
  PointFormFactor form_factor(const Source& source, double tolerance = 1e-13);

  /// The same where it is known what may stand between: items of the soup's index, ascending. Others are not looked
  /// for.
  PointFormFactor form_factor(const Source& source, std::span<const std::uint32_t> items, double tolerance);

  /// A fingerprint of which edges bound what the last form factor saw, and how often each; 0 where it saw nothing, and
  /// unless items were given. Stretches that are next to nothing don't count.
  std::uint64_t outline() const;
  /// Those edges themselves.
  std::vector<SeenEdge> seen_edges();

  /// The boundary of the visible part of the source above the horizon, in no particular order.
  std::vector<BoundaryPiece> visible_region(const Source& source);

  /// How the predicates were decided, since this object was made.
  const StageCounts& stage_counts() const;
  /// Questions that double precision could not answer to the tolerance.
  std::uint64_t extended_count() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Area enclosed by boundary pieces [m²].
double area(std::span<const BoundaryPiece> region);

}  // namespace exitance
