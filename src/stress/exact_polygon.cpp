#include "src/stress/exact_polygon.h"

#include <stdexcept>

namespace exitance {

ExactPoint exact_point(const Vec3& p) {
  return {p.x, p.y, p.z};
}

ExactLoop exact_loop(const Loop& loop) {
  ExactLoop points;
  for (const Vec3& p : loop) points.push_back(exact_point(p));
  return points;
}

ExactPoint exact_mean(const ExactLoop& points) {
  ExactKernel::Vector_3 sum = CGAL::NULL_VECTOR;
  for (const ExactPoint& p : points) sum = sum + (p - CGAL::ORIGIN);
  return CGAL::ORIGIN + sum / ExactKernel::FT(static_cast<int>(points.size()));
}

ExactSide exact_plane(const ExactLoop& loop) {
  for (std::size_t i = 2; i < loop.size(); ++i) {
    for (std::size_t j = 1; j < i; ++j) {
      const ExactKernel::Vector_3 n = CGAL::cross_product(loop[j] - loop[0], loop[i] - loop[0]);
      if (n != CGAL::NULL_VECTOR) return {loop[0], n};
    }
  }
  throw std::logic_error("a facet without area");
}

ExactLoop clipped(const ExactLoop& loop, const ExactSide& side) {
  ExactLoop kept;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const ExactPoint &p = loop[i], &q = loop[(i + 1) % loop.size()];
    const ExactKernel::FT at_p = side.value(p), at_q = side.value(q);
    if (at_p >= 0) kept.push_back(p);
    if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) kept.push_back(p + (at_p / (at_p - at_q)) * (q - p));
  }
  return kept;
}

bool has_area(const ExactLoop& loop) {
  for (std::size_t k = 2; k < loop.size(); ++k) {
    if (CGAL::cross_product(loop[k - 1] - loop[0], loop[k] - loop[0]) != CGAL::NULL_VECTOR) return true;
  }
  return false;
}

}  // namespace exitance
