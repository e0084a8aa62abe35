#pragma once
// A scene whose radiosity has a closed form: a floor below an emitter, half of which a sheet hides.

#include <cmath>
#include <numbers>

#include "src/scene/scene.h"

namespace exitance {

inline Vec3 turned_about_z(const Vec3& p, double angle) {
  return {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y, p.z};
}

/// Floor (rho 0.5) and, one above it, black emitter (E = 1), both unit squares, x and y from 0 to 1; between them at
/// 1/2 a black sheet that covers x < edge. Surfaces 0, 1, 2. All turned about the z axis.
inline Scene half_shadow(double edge, double angle = 0) {
  Scene scene;
  scene.name = "half shadow";
  scene.bands = 1;
  scene.materials = {{"floor", {0.5}, {0}}, {"emitter", {0}, {1}}, {"black", {0}, {0}}};
  scene.objects.push_back({"all", ""});
  const auto add = [&](std::vector<Vec3> loop, std::uint32_t material) {
    for (Vec3& p : loop) p = turned_about_z(p, angle);
    Surface surface;
    surface.polygon.outer = std::move(loop);
    surface.material = material;
    scene.surfaces.push_back(surface);
  };
  add({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 0);
  add({{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}, 1);
  if (edge > -5) add({{-5, -5, 0.5}, {edge, -5, 0.5}, {edge, 6, 0.5}, {-5, 6, 0.5}}, 2);
  return scene;
}

/// Of a point to a parallel rectangle at distance 1 that begins straight above it: Hottel's corner formula.
inline double to_corner(double a, double b) {
  const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
  return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * std::numbers::pi);
}

/// B of the floor at x, y (before it is turned): of the emitter, what lies beyond 2 edge − x is seen.
inline double half_shadow_B(double edge, double x, double y) {
  const double from = std::min(1.0, std::max(0.0, 2 * edge - x)) - x, to = 1 - x;
  return 0.5 * (to_corner(to, 1 - y) + to_corner(to, y) - to_corner(from, 1 - y) - to_corner(from, y));
}

}  // namespace exitance
