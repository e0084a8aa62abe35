#pragma once
// The shadow volume of an object seen from a polygonal shooter (after Nishita and Nakamae 1985): where the shooter's
// visibility can change when the object comes or goes.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/point_shaft.h"
#include "geometry/shaft.h"
#include "geometry/spatial_index.h"

namespace exitance {

/// What an object takes of a shooter's light. The order is that of what is hidden.
enum class Shade : std::uint8_t {
  outside,   ///< nothing: no line from the shooter meets the object
  penumbra,  ///< some, or all of it by several of its pieces together
  umbra      ///< all: one facet or convex piece of the object blocks every line
};

/// An object: some facets of a soup, convex or not, in one piece or in many. Classifies sample points and polygons
/// exactly (PointShaft, Shaft): outside is never wrong, so that no form factor changes there when the object is taken
/// away or put in, and nothing of the shooter is seen from the umbra. Two cases reach beyond the volume of lines and
/// are called penumbra: a facet of the object in the shooter's plane that covers some of it, for every receiver; and a
/// sample point that a facet of the object lies against, or in whose plane and over which it lies.
///
/// Not for several threads at once: each has its own, of the same object (ShadowCaster). The soup must live as long.
class ShadowCaster {
 public:
  /// facets: the object's, ascending; first … last − 1.
  ShadowCaster(const PolygonSoup& soup, std::uint32_t first_facet, std::uint32_t last_facet);

  const PolygonSoup& soup() const { return soup_; }
  bool has(std::uint32_t facet) const { return first_ <= facet && facet < last_; }
  std::uint32_t first() const { return first_; }
  std::uint32_t last() const { return last_; }
  /// Over the object's facets; item k is facet first() + k.
  const SpatialIndex& index() const { return index_; }
  const Box& box() const { return box_; }
  /// Convex shells that consist of the object's facets only.
  std::span<const std::uint32_t> convex_shells() const { return convex_shells_; }
  /// The object's vertices, each once.
  std::span<const std::uint32_t> vertices() const { return vertices_; }

 private:
  const PolygonSoup& soup_;
  std::uint32_t first_, last_;
  SpatialIndex index_;
  Box box_;
  std::vector<std::uint32_t> convex_shells_, vertices_;
};

class ShadowVolume {
 public:
  explicit ShadowVolume(const ShadowCaster& caster);

  /// The shooter is convex: a facet or a piece of one.
  void set_shooter(const ShaftEnd& shooter);

  /// Of a sample point. screens: items of the soup's index, none of the object's; a facet of the object takes nothing
  /// where they hide, together, all lines through it (PointShaft::hidden).
  Shade at(const Receiver& receiver, std::span<const std::uint32_t> screens = {});

  /// Of a polygon: outside, or umbra, where that holds for all lines between interior points (Shaft).
  Shade of(const ShaftEnd& receiver);

  /// Half-spaces that hold every point that is not outside, unless the object covers some of the shooter
  /// (covers_shooter): those of planes that separate shooter and object, through an edge of the shooter and the vertex
  /// of the object that comes nearest to it, and the shooter's own plane moved to the object's nearest vertex. None but
  /// the last where the object reaches behind the shooter's plane.
  std::span<const HalfSpace> region() const { return region_; }

  /// Whether a facet of the object lies in the shooter's plane and covers it somewhere, or may.
  bool covers_shooter() const { return covers_shooter_; }

 private:
  bool lies_over(const Receiver& receiver) const;
  bool is_behind_its_shell(std::uint32_t facet, const Vec3& from);

  const ShadowCaster& caster_;
  ShaftEnd shooter_;
  std::vector<Vec3> loop_;
  bool covers_shooter_ = false;
  std::vector<HalfSpace> region_;
  PointShaft point_shaft_;
  Shaft shaft_;
  std::vector<std::uint32_t> found_;
  StageCounts counts_;
};

}  // namespace exitance
