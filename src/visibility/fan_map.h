#pragma once
// Points spread evenly over a convex polygon.

#include <boost/container/small_vector.hpp>
#include <cmath>

#include "src/visibility/convex_loop.h"

namespace exitance {

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
