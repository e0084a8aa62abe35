#pragma once
// Contact: polygons that lie in one plane and share area of it.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon.h"

namespace exitance {

struct CoplanarOverlap {
  std::uint32_t a = 0, b = 0;  ///< polygons, a < b
  double area = 0;             ///< [m²], relative error about 1e-15
  bool same_facing = false;    ///< the fronts point the same way (one lies on the other), else against each other
};

/// All pairs of polygons that overlap with positive area in exactly the same plane, ascending by a, then b. Decided
/// exactly on the input coordinates: touching along an edge or at a point is no overlap, nor is a gap of one ulp; unless
/// `near` [m] is not 0: then those that are level within it (level.h) are in one plane, too, their area about exact.
/// Polygons that are not exactly planar take part as their facets; one pair may then overlap facing both ways (folded
/// polygons) and is given twice. Polygons of zero area overlap nothing. REQUIRES: no other defects (find_defect).
std::vector<CoplanarOverlap> coplanar_overlaps(std::span<const Polygon> polygons, double near = 0);

}  // namespace exitance
