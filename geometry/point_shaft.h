#pragma once
// The shaft from a sample point to a convex polygon: all that can stand between, exactly.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/open_region.h"
#include "geometry/shaft.h"
#include "geometry/view.h"

namespace exitance {

/// The open pyramid over a polygon (the shooter) with its apex in a point (the receiver): the lines without their end
/// points from the receiver to interior points of the shooter, above the receiver's plane and in front of the
/// shooter's. Degenerate cases:
///  - a receiver in the shooter's plane or behind it, or a shooter nothing of which lies above the receiver's plane:
///    empty, nothing enters;
///  - the points of a piece of a facet are rounded: the pyramid is that of the rounded points;
///  - a receiver on no facet has no plane of its own.
///
/// Not for several threads at once. The soup must live as long.
class PointShaft {
 public:
  explicit PointShaft(const PolygonSoup& soup);
  PointShaft(const PointShaft&) = delete;  // planes point to its points
  PointShaft& operator=(const PointShaft&) = delete;

  /// Goes on with other ends. The loop is copied.
  void reset(const Receiver& receiver, const ShaftEnd& shooter);

  bool is_empty() const { return empty_; }

  /// Whether the relative interior of a facet other than the receiver's own meets the open pyramid, exactly. One in the
  /// plane of either end does not.
  bool enters(std::uint32_t facet);

  /// Whether every line from the receiver to the shooter meets the facet, exactly: then nothing of the shooter is seen.
  bool blocks(std::uint32_t facet);

  /// The same of a convex shell's solid, where no line starts or ends within it; false where one may.
  bool blocks(const Shell& shell);

  /// Until the next reset, takes as screens those of some items of the soup's index, facets and convex shells, that can
  /// hide something of the pyramid from the receiver and lie as a whole in front of the shooter's plane, so that each
  /// line that meets one from there meets it before the shooter.
  void set_screens(std::span<const std::uint32_t> items);

  /// Whether every line of the pyramid that crosses a facet meets one of the screens: before the facet or behind it,
  /// they hide there together what the facet would. True, too, of a facet that hides nothing, as it does not enter or
  /// is seen edge-on. Exact when true; false also where that would take too long to find.
  bool hidden(std::uint32_t facet);

  /// Half-spaces and a box that hold the pyramid, for searches.
  std::span<const HalfSpace> half_spaces();
  const Box& box() const { return box_; }

 private:
  /// An edge of what is seen of a screen, which lies to its left.
  struct OutlineEdge {
    const Vec3 *from, *to;
  };
  struct Screen {
    std::uint32_t item;
    std::size_t first, last;  ///< its edges
  };

  bool lies_in_an_end(std::uint32_t facet) const;
  bool meets_region(const Facet& facet);
  bool is_screen(std::uint32_t item);
  bool enters_seen(std::uint32_t item);
  void append_outline(std::uint32_t item);
  bool sticks_out(const Facet& facet);
  bool rest_is_hidden(const Facet& facet, std::size_t screen);

  const PolygonSoup& soup_;
  Receiver receiver_;
  ShaftEnd shooter_;
  std::vector<Vec3> loop_;
  Box box_;
  bool empty_ = true;
  OpenRegion region_;
  std::vector<HalfSpace> half_spaces_;
  std::vector<OutlineEdge> outlines_;  ///< of the screens
  std::vector<Screen> screens_;
  bool only_entering_ = false;  ///< whether those are left out that have no part in the pyramid
  std::uint32_t cuts_left_ = 0;
  StageCounts counts_;
};

}  // namespace exitance
