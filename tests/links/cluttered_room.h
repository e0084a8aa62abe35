#pragma once
// Rooms full of boxes at random, and points of their nodes.

#include <cmath>
#include <cstdint>
#include <random>

#include "src/links/patch_tree.h"
#include "tests/links/rooms.h"

namespace exitance {

/// Boxes in a room: some stand on the floor or on each other, share planes, edges and corners; all turned at last.
inline Scene cluttered_room(std::mt19937_64& random, bool on_lattice, double degrees) {
  Scene scene = empty_room();
  const int boxes = 3 + static_cast<int>(random() % 4);
  for (int k = 0; k < boxes; ++k) {
    const auto some = [&](double low, double high) {
      const double v = uniform(random, low, high);
      return on_lattice ? std::round(4 * v) / 4 : v;
    };
    const Vec3 low{some(0.25, 2), some(0.25, 2), random() % 2 ? 0 : some(0, 1.5)};
    const Vec3 size{some(0.25, 0.8), some(0.25, 0.8), some(0.25, 0.8)};
    add(scene, "box", box_faces(low, low + size, 2, 0));
  }
  Placement turn{rotation({1, 2, 2}, degrees), {}};
  place(scene, turn);
  return scene;
}

/// Of the inside of a node.
inline Vec3 point_of(const Node& node, std::mt19937_64& random) {
  const double u = uniform(random, 0.001, 0.999), v = uniform(random, 0.001, 0.999);
  const auto& c = node.corner;
  return (1 - v) * ((1 - u) * c[0] + u * c[1]) + v * ((1 - u) * (node.corners == 4 ? c[3] : c[2]) + u * c[2]);
}

}  // namespace exitance
