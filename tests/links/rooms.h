#pragma once
// Small scenes with things that move.

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "src/scene/edit.h"
#include "src/scene/scene.h"

namespace exitance {

inline Material grey(double rho, double E) {
  return {"grey", {rho}, {E}};
}

/// The six faces of a box, outward; inward where `room`.
inline std::vector<Surface> box_faces(const Vec3& low, const Vec3& high, std::uint32_t material, std::uint32_t object,
                                      bool room = false) {
  const auto at = [&](int x, int y, int z) { return Vec3{x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z}; };
  std::vector<std::vector<Vec3>> faces = {
      {at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0)}, {at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)},
      {at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)}, {at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0)},
      {at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0)}, {at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1)}};
  std::vector<Surface> surfaces;
  for (auto& face : faces) {
    if (room) std::reverse(face.begin(), face.end());
    Surface s;
    s.polygon.outer = face;
    s.material = material;
    s.object = object;
    surfaces.push_back(s);
  }
  return surfaces;
}

/// A room of one band, 3 × 3 × 3, whose ceiling glows. Materials: 0 walls, 1 ceiling, 2 things, 3 a lamp, 4 dark.
inline Scene empty_room() {
  Scene scene;
  scene.name = "room";
  scene.bands = 1;
  scene.materials = {grey(0.5, 0), grey(0.5, 1), grey(0.6, 0), grey(0.3, 2), grey(0.1, 0)};
  scene.objects = {{"room", ""}};
  scene.surfaces = box_faces({0, 0, 0}, {3, 3, 3}, 0, 0, true);
  scene.surfaces[1].material = 1;
  return scene;
}

inline void add(Scene& scene, const std::string& name, const std::vector<Surface>& surfaces) {
  const auto object = static_cast<std::uint32_t>(scene.objects.size());
  scene.objects.push_back({name, ""});
  for (Surface s : surfaces) {
    s.object = object;
    scene.surfaces.push_back(s);
  }
}

inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

inline Edit move_to(std::uint32_t object, const Vec3& translation, double degrees = 0) {
  Edit edit;
  edit.operation = Operation::move;
  edit.object = object;
  edit.placement = Placement{rotation({0, 0, 1}, degrees), translation};
  return edit;
}

}  // namespace exitance
