#pragma once
// Powers of two that bring coordinates near 1, so that products of them neither overflow nor vanish.

#include <limits>
#include <vector>

#include "geometry/polygon.h"

namespace exitance {

/// Collects coordinates, then scales them. Multiplying by a power of two is exact; form factors do not change by it.
class ExactScale {
 public:
  void include(const Vec3& point);
  void include(const Polygon& polygon);

  /// v = scaled · 2^exponent(). The largest coordinate comes to lie in [1, 2), or as near to it as the smallest one
  /// allows without loss. Throws std::invalid_argument when the coordinates span too many orders of magnitude for that.
  int exponent() const;

  static Vec3 scaled(const Vec3& point, int exponent);
  static Polygon scaled(Polygon polygon, int exponent);

 private:
  int largest_ = std::numeric_limits<int>::min(), smallest_ = std::numeric_limits<int>::max();
};

}  // namespace exitance
