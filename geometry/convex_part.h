#pragma once
// Convex polygons cut along a line, in double precision.

#include <cstddef>
#include <vector>

#include "geometry/vec3.h"

namespace exitance {

/// What of a convex loop lies where a linear function of points is not negative (Sutherland and Hodgman 1974). value:
/// the function. What touches the line only is left as its corners there, a loop without area.
template <class Value>
std::vector<Vec3> convex_part(const std::vector<Vec3>& loop, const Value& value) {
  std::vector<Vec3> kept;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 &p = loop[k], &q = loop[(k + 1) % loop.size()];
    const double at_p = value(p), at_q = value(q);
    if (at_p >= 0) kept.push_back(p);
    if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) kept.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  return kept;
}

}  // namespace exitance
