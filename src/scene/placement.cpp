#include "src/scene/placement.h"

#include <algorithm>
#include <numbers>
#include <utility>

namespace exitance {
namespace {

// The first vertex stays the first.
void reverse(Polygon& polygon) {
  const auto turn_round = [](std::vector<Vec3>& loop) {
    if (!loop.empty()) std::reverse(loop.begin() + 1, loop.end());
  };
  turn_round(polygon.outer);
  std::ranges::for_each(polygon.holes, turn_round);
}

// Cosine and sine, exact for multiples of 90°.
std::pair<double, double> cos_sin(double degrees) {
  const double turn = std::remainder(degrees, 360);
  if (turn == 0) return {1, 0};
  if (turn == 90) return {0, 1};
  if (turn == -90) return {0, -1};
  if (std::fabs(turn) == 180) return {-1, 0};
  const double radians = turn * (std::numbers::pi / 180);
  return {std::cos(radians), std::sin(radians)};
}

template <typename Change>
void for_each_vertex(Polygon& polygon, Change change) {
  for (Vec3& p : polygon.outer) p = change(p);
  for (auto& hole : polygon.holes) {
    for (Vec3& p : hole) p = change(p);
  }
}

}  // namespace

Matrix3 product(const Matrix3& a, const Matrix3& b) {
  const auto row = [&](const Vec3& r) { return r.x * b[0] + r.y * b[1] + r.z * b[2]; };
  return {row(a[0]), row(a[1]), row(a[2])};
}

Matrix3 rotation(const Vec3& axis, double degrees) {
  // Rodrigues: R = c I + s [k]× + (1 − c) k kᵀ
  const auto [c, s] = cos_sin(degrees);
  const Vec3 k = normalized(axis);
  const double t = 1 - c;
  return {Vec3{c + t * k.x * k.x, t * k.x * k.y - s * k.z, t * k.x * k.z + s * k.y},
          Vec3{t * k.y * k.x + s * k.z, c + t * k.y * k.y, t * k.y * k.z - s * k.x},
          Vec3{t * k.z * k.x - s * k.y, t * k.z * k.y + s * k.x, c + t * k.z * k.z}};
}

Matrix3 scaling(const Vec3& factors) {
  return {Vec3{factors.x, 0, 0}, Vec3{0, factors.y, 0}, Vec3{0, 0, factors.z}};
}

void place(Scene& scene, const Placement& placement) {
  const bool mirrors = placement.mirrors();
  for (Surface& surface : scene.surfaces) {
    for_each_vertex(surface.polygon, placement);
    if (mirrors) reverse(surface.polygon);
  }
}

void flip(Scene& scene) {
  for (Surface& surface : scene.surfaces) reverse(surface.polygon);
}

void make_two_sided(Scene& scene) {
  std::vector<Surface> doubled;
  doubled.reserve(2 * scene.surfaces.size());
  for (Surface& surface : scene.surfaces) {
    doubled.push_back(surface);
    doubled.push_back(std::move(surface));
    reverse(doubled.back().polygon);
  }
  scene.surfaces = std::move(doubled);
}

}  // namespace exitance
