#pragma once
// Where and how an object stands in a scene: moved, turned, scaled, turned over, doubled.

#include <array>

#include "src/scene/scene.h"

namespace exitance {

using Matrix3 = std::array<Vec3, 3>;  ///< rows

Matrix3 product(const Matrix3& a, const Matrix3& b);

/// p ↦ linear · p + translation. Coordinates are rounded once a product and a sum; moves that only permute, negate or
/// scale by powers of two are exact.
struct Placement {
  Matrix3 linear{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 translation;

  Vec3 operator()(const Vec3& p) const {
    return Vec3{dot(linear[0], p), dot(linear[1], p), dot(linear[2], p)} + translation;
  }
  bool mirrors() const { return dot(linear[0], cross(linear[1], linear[2])) < 0; }
};

/// A turn about an axis through the origin, counter-clockwise seen against the axis. Multiples of 90° about a
/// coordinate axis are exact. REQUIRES: the axis is finite and not zero.
Matrix3 rotation(const Vec3& axis, double degrees);

/// Scales along the coordinate axes.
Matrix3 scaling(const Vec3& factors);

/// Moves every surface. A mirror image keeps its front.
void place(Scene& scene, const Placement& placement);

/// Turns every surface over: its front becomes its back.
void flip(Scene& scene);

/// Adds every surface again, turned over, right after itself: a sheet of two patches back to back.
void make_two_sided(Scene& scene);

}  // namespace exitance
