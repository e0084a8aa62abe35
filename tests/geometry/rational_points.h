#pragma once
// Points and determinants in rational numbers: what predicates are compared with.

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <array>

#include "geometry/vec3.h"

namespace exitance {

using Q = CGAL::Exact_predicates_exact_constructions_kernel::FT;
using Point = std::array<Q, 3>;

inline Point exact(const Vec3& v) {
  return {Q(v.x), Q(v.y), Q(v.z)};
}
inline Point operator-(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Q determinant(const Point& a, const Point& b, const Point& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}
inline int sign(const Q& q) {
  return static_cast<int>(CGAL::sign(q));
}

}  // namespace exitance
