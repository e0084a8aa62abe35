#pragma once
// Rays from one point to the faces.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "src/output/faces.h"

namespace exitance {

/// Where a ray meets a face.
struct FaceHit {
  std::uint32_t face = 0;
  /// Points of the triangle or quadrilateral that was hit (a face with more corners is a fan of triangles).
  std::array<std::uint32_t, 4> corners{};
  std::uint32_t corner_count = 3;
  /// Triangle: weights of corners 1 and 2. Quadrilateral: from corner 0 towards 1 (u) and towards 3 (v), in [0, 1].
  double u = 0, v = 0;
};

/// Casts with Embree, in float and relative to the origin, in its robust mode: for pictures, not for form factors. May
/// be used by any number of threads. The floating-point environment is left alone (Embree's manual advises
/// flush-to-zero; that would break exact predicates elsewhere).
class FaceRays {
 public:
  FaceRays(const Faces& faces, const Vec3& origin);
  ~FaceRays();

  /// The nearest face seen from its front; of those that coincide the last, which lies on top.
  std::optional<FaceHit> first_front(const Vec3& direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace exitance
