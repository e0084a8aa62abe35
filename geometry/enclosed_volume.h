#pragma once
// The volume that a closed surface encloses.

#include <span>

#include "geometry/bounded.h"
#include "geometry/vec3.h"

namespace exitance {

/// Sums the volume of a closed surface, positive where its loops run counter-clockwise seen from outside, over pyramids
/// from a point near it. However flat what is enclosed, its sign is right: where rounding hides it, as of a sheet's two
/// sides, which enclose nothing, the volume is 0.
class EnclosedVolume {
 public:
  explicit EnclosedVolume(const Vec3& apex) : apex_(apex) {}

  /// A loop of at least three points; one that is not planar counts as its fan of triangles from the first point.
  void add(std::span<const Vec3> loop) {
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) add(loop[0], loop[k], loop[k + 1]);
  }
  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Difference p(a, apex_), q(b, apex_), r(c, apex_);
    six_times_ =
        six_times_ + (p.y * q.z - p.z * q.y) * r.x + (p.z * q.x - p.x * q.z) * r.y + (p.x * q.y - p.y * q.x) * r.z;
  }

  /// [m³]
  double value() const {
    return certain_sign(six_times_).value_or(0) == 0 ? 0 : static_cast<double>(six_times_.value() / 6);
  }

 private:
  struct Difference {
    Bounded x, y, z;
    Difference(const Vec3& a, const Vec3& b)
        : x(Bounded(a.x) - Bounded(b.x)), y(Bounded(a.y) - Bounded(b.y)), z(Bounded(a.z) - Bounded(b.z)) {}
  };

  Vec3 apex_;
  Bounded six_times_{0};
};

}  // namespace exitance
