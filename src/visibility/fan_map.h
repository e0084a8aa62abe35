#pragma once
// Points spread evenly over a convex polygon.

#include <boost/container/small_vector.hpp>
#include <cmath>

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

/// Maps the unit square to a convex loop of three corners or more, uniformly and without a jump: u turns around the
/// first corner, √v goes away from it. The loop must outlive the map.
class FanMap {
 public:
  explicit FanMap(const ConvexLoop& loop) : loop_(loop) {
    up_to_.push_back(0);
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
      up_to_.push_back(up_to_.back() + norm(cross(loop[k] - loop[0], loop[k + 1] - loop[0])));
    }
  }
  double twice_area() const { return up_to_.back(); }

  Vec3 operator()(double u, double v) const {
    const double a = u * twice_area();
    std::size_t k = 1;
    while (k + 1 < up_to_.size() && a > up_to_[k]) ++k;
    const double t = (a - up_to_[k - 1]) / (up_to_[k] - up_to_[k - 1]);
    return loop_[0] + std::sqrt(v) * ((1 - t) * (loop_[k] - loop_[0]) + t * (loop_[k + 1] - loop_[0]));
  }

  /// Of the area.
  Vec3 centre() const {
    Vec3 sum;
    for (std::size_t k = 1; k + 1 < loop_.size(); ++k) {
      const double share = (up_to_[k] - up_to_[k - 1]) / twice_area();
      sum = sum + (share / 3) * ((loop_[k] - loop_[0]) + (loop_[k + 1] - loop_[0]));
    }
    return loop_[0] + sum;
  }

 private:
  const ConvexLoop& loop_;
  boost::container::small_vector<double, 12> up_to_;  // twice the area of the triangles before
};

}  // namespace exitance
