#pragma once
// Convex polygons relative to a point of view, in double precision.

#include <boost/container/small_vector.hpp>
#include <cmath>
#include <numbers>

#include "geometry/vec3.h"

namespace exitance {

using ConvexLoop = boost::container::small_vector<Vec3, 12>;

/// What of a loop lies where dot(normal, v) ≥ 0, in the same order.
inline ConvexLoop part_above(const Vec3& normal, const ConvexLoop& loop) {
  ConvexLoop part;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 &p = loop[k], &q = loop[(k + 1) % loop.size()];
    const double hp = dot(normal, p), hq = dot(normal, q);
    if (hp >= 0) part.push_back(p);
    if ((hp > 0 && hq < 0) || (hp < 0 && hq > 0)) part.push_back((1 / (hp - hq)) * (hp * q - hq * p));
  }
  return part;
}

/// Lambert's form factor of a loop relative to the point of view, above the horizon, as if nothing stood between. Its
/// sign tells which way it runs: positive where it is clockwise seen from the point. Errors are those of rounding, some
/// 2^-50; no bound is proven.
inline double lambert(const ConvexLoop& loop, const Vec3& unit_normal) {
  double sum = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 &p = loop[k], &q = loop[(k + 1) % loop.size()];
    const Vec3 c = cross(p, q);
    const double s = norm(c);
    if (s > 0) sum += std::atan2(s, dot(p, q)) * dot(unit_normal, c) / s;
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace exitance
