#pragma once
// Scenes that are turned about axes that no polygon has: what lay in one plane does so but for rounding.

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/scene/scene.h"

namespace exitance {

inline Scene turned(Scene scene, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto turn = [&](std::vector<Vec3>& loop) {
    for (Vec3& p : loop) {
      const Vec3 q{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
      p = {q.x, c * q.y - s * q.z, s * q.y + c * q.z};
    }
  };
  for (Surface& surface : scene.surfaces) {
    turn(surface.polygon.outer);
    std::ranges::for_each(surface.polygon.holes, turn);
  }
  return scene;
}

/// A room from 0 to 1, and in it a solid of its shape and half its size, so high above the floor.
inline Scene with_solid(Scene room, double height) {
  for (Surface surface : std::vector(room.surfaces)) {
    for (Vec3& p : surface.polygon.outer) p = {0.25 + 0.5 * p.x, 0.25 + 0.5 * p.y, height + 0.5 * p.z};
    std::ranges::reverse(surface.polygon.outer);
    room.surfaces.push_back(std::move(surface));
  }
  return room;
}

}  // namespace exitance
