#include "src/stress/placement.h"

namespace exitance {

Placement random_rotation(const std::string& name, const Vec3& origin, double scale, Random& random) {
  double q[4], square = 0;
  do {
    square = 0;
    for (double& c : q) {
      c = random.real(-1, 1);
      square += c * c;
    }
  } while (square > 1 || square < 0.01);
  const double s = 2 / square, a = q[0], b = q[1], c = q[2], d = q[3];
  return {name,
          {1 - s * (c * c + d * d), s * (b * c + a * d), s * (b * d - a * c)},
          {s * (b * c - a * d), 1 - s * (b * b + d * d), s * (c * d + a * b)},
          {s * (b * d + a * c), s * (c * d - a * b), 1 - s * (b * b + c * c)},
          origin,
          scale};
}

Polygon Placement::operator()(Polygon polygon) const {
  for (Vec3& p : polygon.outer) p = (*this)(p);
  for (auto& hole : polygon.holes) {
    for (Vec3& p : hole) p = (*this)(p);
  }
  return polygon;
}

std::vector<Placement> placements(std::string_view name) {
  Random random(name);
  const Vec3 u{2, 1, -1}, v{-1, 3, 1}, w{1, -1, 2};  // determinant 18
  const Vec3 near{5, -3, 7}, far{1000003, -2000001, 1500007};
  return {{"lattice", {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}, 1},
          {"tenth", {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, near, 0.1},
          {"tilted", u, v, w, near},
          {"tilted_far", u, v, w, far},
          {"tilted_2^-40", u, v, w, near, 0x1p-40},
          random_rotation("rotated", near, 1, random),
          random_rotation("rotated_far", far, 1, random),
          random_rotation("rotated_1e-12", {}, 1e-12, random),
          random_rotation("rotated_1e12", near, 1e12, random)};
}

}  // namespace exitance
