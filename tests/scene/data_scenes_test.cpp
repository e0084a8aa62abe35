// The scenes under data/, as they are read.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include "src/scene/patch_mesh.h"
#include "src/scene/reader.h"
#include "src/scene/scene_check.h"
#include "src/scene/scene_file.h"
#include "tests/places.h"

namespace exitance {
namespace {

Scene scene_called(const char* name) {
  return read_scene(source_file("data/" + std::string(name) + ".toml"));
}

double total_area(const Scene& scene) {
  double sum = 0;
  for (const Surface& s : scene.surfaces) sum += norm(area_vector(s.polygon));
  return sum;
}

TEST(DataScenes, CornellBoxIsOpenInFrontAndCloseableByOneWall) {
  const Scene open = scene_called("cornell_box"), closed = scene_called("cornell_box_closed");
  EXPECT_TRUE(open.warnings.empty());
  EXPECT_FALSE(is_closed(open));
  EXPECT_TRUE(is_closed(closed));
  ASSERT_EQ(open.surfaces.size(), 18u);
  ASSERT_EQ(closed.surfaces.size(), 19u);
  EXPECT_EQ(open.bands, 3u);
  EXPECT_TRUE(open.camera && closed.camera);
  EXPECT_TRUE(check_scene(closed).watertight);
}

TEST(DataScenes, CornellBoxLightIsAsPublished) {
  const Scene scene = scene_called("cornell_box");
  int lights = 0;
  for (const Surface& s : scene.surfaces) {
    const Material& m = scene.materials[s.material];
    if (m.E[0] == 0) continue;
    ++lights;
    EXPECT_NEAR(area_vector(s.polygon).y, -0.130 * 0.105, 1e-15) << "130 mm x 105 mm, shining down";
    EXPECT_NEAR(m.E[0], 18.0504 * std::numbers::pi, 1e-12) << "published as radiance";
    EXPECT_EQ(m.rho[1], 0.78);
  }
  EXPECT_EQ(lights, 1);
}

TEST(DataScenes, FurnaceCubeIsAUnitCubeSeenFromWithin) {
  const Scene scene = scene_called("furnace_cube");
  EXPECT_EQ(scene.surfaces.size(), 6u);
  EXPECT_TRUE(is_closed(scene));
  EXPECT_EQ(total_area(scene), 6);
  for (const Surface& s : scene.surfaces) {
    EXPECT_LT(dot(area_vector(s.polygon), s.polygon.outer[0] - Vec3{0.5, 0.5, 0.5}), 0);
    EXPECT_EQ(scene.materials[s.material].rho[0], 0.5);
    EXPECT_EQ(scene.materials[s.material].E[0], 1);
  }
}

TEST(DataScenes, BoxOnFloorHasElevenPolygonsAndSquarePatches) {
  const Scene scene = scene_called("box_on_floor");
  EXPECT_EQ(scene.surfaces.size(), 11u);
  EXPECT_TRUE(is_closed(scene));
  EXPECT_EQ(total_area(scene), 6 * 9 - 1 + 5);
  const PolygonSoup soup = make_soup(scene);
  EXPECT_EQ(make_patch_mesh(scene, soup, {1.0 / 3, 1}).patches.size(), 522u);
  EXPECT_GT(make_patch_mesh(scene, soup, {0.333333, 1}).patches.size(), 522u) << "a size is never exceeded";
  EXPECT_EQ(make_patch_mesh(scene, soup, {1.0 / 7, 1}).patches.size(), 2842u);
}

/// Patches and elements of a scene cut as it says itself.
std::pair<std::size_t, std::size_t> counts_of(const Scene& scene) {
  MeshOptions options{scene.mesh.patch_size, scene.mesh.elements_per_edge};
  options.small_patch = scene.mesh.small_patch;
  const PolygonSoup soup = make_soup(scene);
  const PatchMesh mesh = make_patch_mesh(scene, soup, options);
  return {mesh.patches.size(), mesh.elements.size()};
}

void expect_counts_within_two_percent(const char* name, double patches, double elements) {
  const DynamicScene given = read_dynamic_scene(source_file("data/" + std::string(name)), Emission::exitance);
  EditedScene edited(given.scene);
  for (std::size_t k = 0; k <= given.events.size(); ++k) {
    if (k > 0) edited.apply(given.events[k - 1].edit);
    if (k > 1) continue;  // without what comes and goes, and with it
    EXPECT_TRUE(is_closed(edited.scene())) << name << " after event " << k;
    const auto [p, e] = counts_of(edited.scene());
    EXPECT_NEAR(static_cast<double>(p), patches, 0.02 * patches) << name << " after event " << k;
    EXPECT_NEAR(static_cast<double>(e), elements, 0.02 * elements) << name << " after event " << k;
  }
}

TEST(DataScenes, CubeAndRobotAreAsLargeAsInThePaper) {
  expect_counts_within_two_percent("cube.toml", 450, 1750);
  expect_counts_within_two_percent("robot.toml", 12700, 45900);
}

}  // namespace
}  // namespace exitance
