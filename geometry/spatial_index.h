#pragma once
// A hierarchy of boxes around facets, searched by convex cones and by boxes.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "geometry/vec3.h"

namespace exitance {

struct Box {
  Vec3 lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
  Vec3 upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
             -std::numeric_limits<double>::infinity()};

  void extend(const Vec3& p) {
    lower = {std::fmin(lower.x, p.x), std::fmin(lower.y, p.y), std::fmin(lower.z, p.z)};
    upper = {std::fmax(upper.x, p.x), std::fmax(upper.y, p.y), std::fmax(upper.z, p.z)};
  }
  void extend(const Box& b) {
    extend(b.lower);
    extend(b.upper);
  }
  bool contains(const Vec3& p) const {
    return lower.x <= p.x && p.x <= upper.x && lower.y <= p.y && p.y <= upper.y && lower.z <= p.z && p.z <= upper.z;
  }
  bool overlaps(const Box& b) const {
    return lower.x <= b.upper.x && b.lower.x <= upper.x && lower.y <= b.upper.y && b.lower.y <= upper.y &&
           lower.z <= b.upper.z && b.lower.z <= upper.z;
  }
};

}  // namespace exitance
