// Meshes that are refined along shadow boundaries.

#include "src/reference/refined_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <stdexcept>

#include "src/scene/reader.h"
#include "tests/places.h"
#include "tests/reference/half_shadow.h"

namespace exitance {
namespace {

double area_of(const PatchMesh& mesh) {
  double area = 0;
  for (const Element& e : mesh.elements) area += e.area;
  return area;
}

std::vector<Vec3> loop_of(const PatchMesh& mesh, const Element& e) {
  const auto loop = mesh.loop(e);
  return {loop.begin(), loop.end()};
}

/// Whether no element of the surface has points on both sides of x = place.
bool is_cut_at(const PatchMesh& mesh, std::uint32_t surface, double place) {
  return std::ranges::all_of(mesh.elements, [&](const Element& e) {
    if (mesh.patches[e.patch].surface != surface) return true;
    const auto loop = mesh.loop(e);
    return std::ranges::all_of(loop, [&](const Vec3& v) { return v.x < place + 1e-12; }) ||
           std::ranges::all_of(loop, [&](const Vec3& v) { return v.x > place - 1e-12; });
  });
}

TEST(RefinedMeshTest, TilesSurfacesAtEveryLevelAndKeepsOtherElements) {
  const Scene scene = read_scene(source_file("data/box_on_floor.toml"));
  const PolygonSoup soup = make_soup(scene);
  RefinedMesh refined(scene, soup, {.elements_per_edge = 4});
  const double area = area_of(refined.mesh());
  EXPECT_NEAR(area, 5 * 9 + 8 + 5, 1e-12);
  for (int level = 0; level < 4; ++level) {
    const PatchMesh before = refined.mesh();
    const auto last = static_cast<std::uint32_t>(before.patches.size() - 1);
    const std::vector<RefinedMesh::Origin> old = refined.split(std::vector<std::uint32_t>{0, 2, last});
    const PatchMesh& mesh = refined.mesh();
    ASSERT_EQ(old.size(), mesh.patches.size());
    EXPECT_GE(mesh.patches.size(), before.patches.size() + 3);
    EXPECT_NEAR(area_of(mesh), area, 1e-12);
    EXPECT_TRUE(std::ranges::is_partitioned(old, std::logical_not(), &RefinedMesh::Origin::kept));
    EXPECT_EQ(std::ranges::count(old, true, &RefinedMesh::Origin::kept),
              static_cast<std::ptrdiff_t>(before.patches.size() - 3));
    for (std::uint32_t p = 0; p < old.size(); ++p) {
      const Patch &now = mesh.patches[p], &then = before.patches[old[p].patch];
      EXPECT_EQ(now.surface, then.surface);
      if (!old[p].kept) continue;
      ASSERT_EQ(now.element_count, then.element_count);
      for (std::uint32_t e = 0; e < now.element_count; ++e) {
        EXPECT_EQ(loop_of(mesh, mesh.elements[now.element_first + e]),
                  loop_of(before, before.elements[then.element_first + e]));
      }
    }
  }
}

TEST(RefinedMeshTest, GridsTilePatchesAndFaceTheirWay) {
  const Scene scene = read_scene(source_file("data/box_on_floor.toml"));
  const PolygonSoup soup = make_soup(scene);
  const RefinedMesh refined(scene, soup, {.elements_per_edge = 3});
  const PatchMesh& mesh = refined.mesh();
  for (const Patch& patch : mesh.patches) {
    EXPECT_EQ(patch.element_count, 9u);
    EXPECT_NEAR(patch.area, mesh.pieces_of(patch)[0].area, 1e-13);
  }
  for (const Element& e : mesh.elements) {
    const auto loop = mesh.loop(e);
    EXPECT_GT(dot(cross(loop[1] - loop[0], loop[2] - loop[1]), e.normal), 0);
  }
}

TEST(RefinedMeshTest, PatchesAreCutAlongTheEdgesOfUmbraAndPenumbra) {
  for (const double turn : {0.0, 0.3}) {  // rotated about z: x no longer tells, but the number of parts does
    const Scene scene = half_shadow(0.75, turn);
    const PolygonSoup soup = make_soup(scene);
    RefinedMesh refined(scene, soup, {.elements_per_edge = 2});
    refined.split(std::vector<std::uint32_t>{0});
    // The edge of the blocker at x = 0.75, seen past from the emitter's sides x = 0 and x = 1: shadow edges at 1.5
    // (outside the floor) and 0.5.
    const PatchMesh& mesh = refined.mesh();
    EXPECT_TRUE(turn != 0 || is_cut_at(mesh, 0, 0.5));
    EXPECT_EQ(std::ranges::count(mesh.patches, 0u, &Patch::surface), 2);
  }
}

TEST(RefinedMeshTest, NeedsAnElement) {
  const Scene scene = half_shadow(0.5);
  const PolygonSoup soup = make_soup(scene);
  EXPECT_THROW(RefinedMesh(scene, soup, {.elements_per_edge = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace exitance
