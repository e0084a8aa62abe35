#include "geometry/polygon.h"

namespace exitance {

Vec3 area_vector(const std::vector<Vec3>& loop) {
  Vec3 sum;
  for (std::size_t i = 2; i < loop.size(); ++i) sum = sum + cross(loop[i - 1] - loop[0], loop[i] - loop[0]);
  return 0.5 * sum;
}

Vec3 area_vector(const Polygon& polygon) {
  Vec3 sum = area_vector(polygon.outer);
  for (const auto& hole : polygon.holes) {
    const Vec3 a = area_vector(hole);
    sum = dot(a, sum) > 0 ? sum - a : sum + a;
  }
  return sum;
}

}  // namespace exitance
