#pragma once
// What is seen of polygons from one point, exactly.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"

namespace exitance {

/// A point that receives, with the normal of its surface (any length but zero). A point of a facet lies on it by identity,
/// not by sign: it names the facet, and then neither that facet's polygon nor what lies in its plane hides anything from it.
struct Receiver {
  Vec3 point;
  Vec3 normal;
  std::uint32_t facet = kNone;
};

/// A convex source: a whole facet (empty loop) or a piece of it, whose loop runs counter-clockwise seen from the facet's
/// front and whose points, though rounded, lie in the facet's plane by identity.
struct Source {
  std::uint32_t facet = 0;
  std::span<const Vec3> loop;
};

enum class Side : std::uint8_t { front, back, edge_on };

enum class Visibility : std::uint8_t {
  away,     ///< below the receiver's horizon, edge-on, or an excluded polygon: nothing can be seen
  open,     ///< no occluder reaches between: closed form
  partial,  ///< occluders were clipped away
  blocked   ///< nothing left
};

/// Form factor from a point to the visible part of one side of a source, and a proven bound of its error.
struct PointFormFactor {
  double F = 0;
  double error = 0;
  Side side = Side::front;  ///< which side of the source the point sees; F to a back counts in closure only
  Visibility visibility = Visibility::away;
};

/// A stretch of the boundary of a visible region, in the source's plane, the region to its left seen from the point.
struct BoundaryPiece {
  Vec3 from, to;
  bool of_source = false;  ///< lies on the source's own boundary (or on the horizon), else on an occluder's shadow
};

/// One point of view. Holds scratch memory: one object a thread, used for many points.
class Viewpoint {
 public:
  explicit Viewpoint(const PolygonSoup& soup);
  ~Viewpoint();
  Viewpoint(Viewpoint&&) noexcept;

  /// Sets the point. Throws std::invalid_argument on a zero or non-finite normal and on a non-finite point.
  void look_from(const Receiver& receiver);

  /// Whether something lying in the receiver's own plane covers it (only for a receiver on a facet): it then sees nothing.
  bool covered() const;

  /// F from the point to the visible part of the source, from whichever side it is seen. The proven error is at most
  /// `tolerance` where extended precision (200 bits) can reach that.
  PointFormFactor form_factor(const Source& source, double tolerance = 1e-13);

  /// The boundary of the visible part of the source, closed loops' pieces in no particular order.
  std::vector<BoundaryPiece> visible_region(const Source& source);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Twice-signed area [m²] enclosed by boundary pieces: the area of a visible region.
double area(std::span<const BoundaryPiece> region);

}  // namespace exitance
