#include "src/form_factor/exact_scale.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace exitance {
namespace {

// Exponents of doubles whose last digit is 2^-52 times their first one.
constexpr int kSmallestExact = std::numeric_limits<double>::min_exponent - 1;
// Products of six coordinates of this size are far from overflow.
constexpr int kLargestUseful = 100;

}  // namespace

void ExactScale::include(const Vec3& point) {
  for (int axis = 0; axis < 3; ++axis) {
    if (point[axis] == 0 || !std::isfinite(point[axis])) continue;
    const int e = std::ilogb(point[axis]);
    largest_ = std::max(largest_, e);
    smallest_ = std::min(smallest_, e);
  }
}

void ExactScale::include(const Polygon& polygon) {
  for (const Vec3& v : polygon.outer) include(v);
  for (const auto& hole : polygon.holes) {
    for (const Vec3& v : hole) include(v);
  }
}

int ExactScale::exponent() const {
  if (largest_ < smallest_) return 0;
  const int exponent = std::min(largest_, smallest_ - kSmallestExact);
  if (largest_ - exponent > kLargestUseful) {
    throw std::invalid_argument("the coordinates span more orders of magnitude than can be computed with");
  }
  return exponent;
}

Vec3 ExactScale::scaled(const Vec3& point, int exponent) {
  return {std::ldexp(point.x, -exponent), std::ldexp(point.y, -exponent), std::ldexp(point.z, -exponent)};
}

Polygon ExactScale::scaled(Polygon polygon, int exponent) {
  for (Vec3& v : polygon.outer) v = scaled(v, exponent);
  for (auto& hole : polygon.holes) {
    for (Vec3& v : hole) v = scaled(v, exponent);
  }
  return polygon;
}

}  // namespace exitance
