#include "src/scene/scene_hash.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

namespace exitance {
namespace {

Scene triangle() {
  Scene scene;
  scene.materials = {{"m", {0.5, 0.5, 0.5}, {0, 0, 1}, "", 0}};
  scene.objects = {{"o", ""}};
  Surface surface;
  surface.polygon = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0.1, 0.1, 0}, {0.2, 0.1, 0}, {0.1, 0.2, 0}}}};
  scene.surfaces = {surface};
  return scene;
}

TEST(SceneHash, ChangesWithEverythingThatASolutionDependsOn) {
  const std::vector<std::function<void(Scene&)>> changes = {
      [](Scene&) {},
      [](Scene& s) { s.surfaces[0].polygon.outer[1].x = std::nextafter(1.0, 2.0); },
      [](Scene& s) { s.surfaces[0].polygon.holes[0][2].y = 0.25; },
      [](Scene& s) { s.surfaces[0].polygon.holes.clear(); },
      [](Scene& s) { s.surfaces[0].obstruction_only = true; },
      [](Scene& s) { s.materials[0].rho[0] = 0.25; },
      [](Scene& s) { s.materials[0].E[0] = 0.25; },
      [](Scene& s) { s.surfaces.push_back(s.surfaces[0]); },
      [](Scene& s) { s.unit = "lm/m^2"; },
  };
  std::set<std::string> hashes;
  for (const auto& change : changes) {
    Scene scene = triangle();
    change(scene);
    hashes.insert(scene_hash(scene));
  }
  EXPECT_EQ(hashes.size(), changes.size());
}

TEST(SceneHash, DoesNotDependOnNames) {
  Scene scene = triangle();
  scene.name = "other";
  scene.materials[0].name = "other";
  scene.objects[0].file = "other";
  scene.camera = Camera{};
  EXPECT_EQ(scene_hash(scene), scene_hash(triangle()));
}

}  // namespace
}  // namespace exitance
