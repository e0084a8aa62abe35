#pragma once
// The shaft between two convex polygons: all lines from the one to the other, and what stands in it, exactly.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/open_region.h"
#include "geometry/polygon_soup.h"

namespace exitance {

/// One end of a shaft: a convex polygon in a facet's plane, the whole facet (empty loop) or a piece of it, whose
/// points, counter-clockwise seen from the front, lie in the facet's plane by identity though they are rounded.
struct ShaftEnd {
  std::uint32_t facet = 0;
  std::span<const Vec3> loop;
};

/// The open shaft: the interior of the convex hull of both ends, in front of the planes of both. It consists of the
/// lines without their end points between interior points of the one end's part above the other's plane and of the
/// other's part above the one's.
///
/// An item, a facet or a convex shell by its number in the soup's index, *enters* when the relative interior of the
/// facet, or of one of the shell's facets, meets the open shaft. Degenerate cases:
///  - touching the shaft's boundary (face, edge or vertex) from outside is not entering; an item seen edge-on that has
///    points in the open shaft does enter (partial);
///  - a shell around the whole shaft does not enter: nothing of its surface lies between;
///  - an end that crosses the other's plane counts only above it: an item that reaches only lines from the rest does
///    not enter, and one is blocking only when it blocks the lines from the rest, too;
///  - an end's own facet, and the shell it bounds, do not enter; other facets of a bent polygon may;
///  - a facet in the plane of an end (soup.coplanar) enters when it covers the end (soup.covers) on a positive area and
///    is blocking when it holds all of it; so does a shell that has such a facet; otherwise it does not enter;
///  - ends in one plane, or with nothing of the one above the other's plane, do not face each other: nothing enters;
///  - ends that share an edge or a vertex are no special case;
///  - of pieces, whose points are rounded, the shaft is that of the rounded points: it may hold, or leave out, items
///    that lie along the unrounded one's boundary within rounding, but it never crosses the plane of a facet that both
///    ends' whole facets lie on one side of (neighbours do not enter), and no plane that rounding has put wrong narrows
///    it. Pieces of polygons in one plane but for rounding have a flat shaft of rounding errors.
///
/// Blocking is decided exactly but for two cases that are called partial: an end that crosses the other's plane (as
/// above), and a shell of which no face's plane, nor an end's plane, separates one of the ends.
///
/// Not for several threads at once: it keeps memory between questions. The soup must live as long.
class Shaft {
 public:
  enum class Overlap : std::uint8_t {
    outside,  ///< does not enter: hides nothing
    partial,  ///< enters
    blocking  ///< blocks every line between interior points of the ends: hides all
  };

  explicit Shaft(const PolygonSoup& soup);
  Shaft(const PolygonSoup& soup, const ShaftEnd& a, const ShaftEnd& b) : Shaft(soup) { reset(a, b); }
  Shaft(const Shaft&) = delete;  // planes point to the ends' points
  Shaft& operator=(const Shaft&) = delete;

  /// Goes on with other ends. Loops are copied.
  void reset(const ShaftEnd& a, const ShaftEnd& b);

  /// Whether some of b lies above a's plane and some of a above b's, exactly: else they exchange nothing.
  bool face_each_other() const { return facing_; }

  /// Fills `items` with the index items that enter, ascending. Returns outside when there is none (the shaft is open),
  /// blocking when one of them blocks, else partial.
  Overlap find_occluders(std::vector<std::uint32_t>& items);

  /// Of one index item: k < facets().size() is facet k, else convex shell k − facets().size().
  Overlap overlap(std::uint32_t item);

  const StageCounts& stage_counts() const { return counts_; }

 private:
  struct End {
    std::uint32_t facet = 0;
    bool whole = true;
    std::vector<Vec3> points;
    std::vector<std::int8_t> height;  ///< sign of each point against the other end's plane
    std::vector<std::uint8_t> given;  ///< whether the edge from the point lies in a plane that the other end has added
  };

  /// Of a set of points against a plane.
  enum Sides : std::uint8_t { in_plane = 0, front = 1, back = 2, both = 3 };

  Sides sides_of_facet(std::uint32_t facet, std::uint32_t plane_facet);
  Sides sides_of_end(const End& end, std::uint32_t plane_facet);
  bool set_heights(End& end, const End& other);
  void add_sides(std::size_t end);
  bool supports(std::size_t plane, const End& one, const End& other, std::size_t count);
  bool coplanar(std::uint32_t facet, const End& end) const;
  void set_prism(std::span<const Vec3> loop, const Vec3& normal);
  bool overlap_in_plane(const Facet& facet, std::span<const Vec3> loop, const Vec3& normal, const Plane& in_front);
  Overlap cover(std::uint32_t facet, std::size_t end);
  bool beside(std::uint32_t facet);
  bool enters(std::uint32_t facet);
  Overlap overlap_of_facet(std::uint32_t facet);
  Overlap overlap_of_shell(std::uint32_t shell);
  bool blocks(std::uint32_t facet);
  bool blocks(const Shell& shell);
  bool crosses(const Shell& shell, const Vec3& from, const Vec3& to);

  const PolygonSoup& soup_;
  std::array<End, 2> ends_;
  bool facing_ = false;
  Box box_;            ///< of both ends
  double reach_ = 0;   ///< no two points of the soup or the ends are farther apart, in the sum over the axes
  OpenRegion region_;  ///< planes 0 and 1 are those of the ends
  OpenRegion prism_;
  std::vector<Vec3> loop_, lifted_;  ///< of the prism
  std::vector<HalfSpace> half_spaces_;
  std::vector<std::int8_t> coplanarities_;  ///< [edge of the first end][edge of the second], where asked for
  std::vector<std::uint64_t> known_sides_;  ///< of facets against planes of facets: a cache
  StageCounts counts_;
};

}  // namespace exitance
