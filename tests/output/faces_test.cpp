#include "src/output/faces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace exitance {
namespace {

using testing::ElementsAre;

std::vector<Vec3> rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
}

TEST(Faces, NeighboursOfOneSurfaceShareTheirCorners) {
  Faces faces(1e-9);
  faces.add(0, 0, 0, rectangle(0, 0, 1, 1));
  faces.add(0, 0, 1, rectangle(1 + 5e-10, -3e-10, 2, 1));
  EXPECT_EQ(faces.points().size(), 6u);
  EXPECT_THAT(faces.corners(1), ElementsAre(1, 4, 5, 2));
  EXPECT_EQ(faces.area(0), 1);
}

TEST(Faces, SurfacesDoNotShareCorners) {
  Faces faces(1e-9);
  faces.add(0, 0, 0, rectangle(0, 0, 1, 1));
  faces.add(1, 1, 1, rectangle(0, 0, 1, 1));
  EXPECT_EQ(faces.points().size(), 8u);
}

TEST(Faces, CloseButDistinctCornersStayApart) {
  Faces faces(1e-9);
  faces.add(0, 0, 0, rectangle(0, 0, 1, 1));
  faces.add(0, 0, 1, rectangle(1 + 1e-8, 0, 2, 1));
  EXPECT_EQ(faces.points().size(), 8u);
}

TEST(Faces, MergingDoesNotDependOnWhereTheGridFalls) {
  // Corners an ulp apart all along an edge, at coordinates of either sign.
  for (double x = -3; x < 3; x += 0.0137) {
    for (const double merge_distance : {0.0, 1e-9, 1e-3}) {
      Faces faces(merge_distance);
      faces.add(0, 0, 0, rectangle(x - 1, 0, x, 1));
      const double beside = merge_distance > 0 ? std::nextafter(x, 9.0) : x;
      faces.add(0, 0, 1, rectangle(beside, 0, x + 1, 1));
      EXPECT_EQ(faces.points().size(), 6u) << x;
    }
  }
}

// A square, an L, a square with a square hole, a square bent along its diagonal; areas 4, 3, 8 and about 1.
Scene four_surfaces() {
  Scene scene;
  scene.materials.resize(1);
  const auto add = [&](Polygon polygon) {
    Surface surface;
    surface.polygon = std::move(polygon);
    scene.surfaces.push_back(surface);
  };
  add({rectangle(0, 0, 2, 2), {}});
  add({{{0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1}, {1, 2, 1}, {0, 2, 1}}, {}});
  add({rectangle(5, 0, 8, 3), {rectangle(6, 1, 7, 2)}});
  add({{{0, 5, 0}, {1, 5, 0}, {1, 6, 0.25}, {0, 6, 0}}, {}});
  return scene;
}

TEST(MakeFaces, TileTheElementsWhateverTheMesh) {
  const Scene scene = four_surfaces();
  const PolygonSoup soup = make_soup(scene);
  for (const double patch_size : {0.0, 0.4}) {
    for (const std::uint32_t per_edge : {1u, 2u}) {
      const PatchMesh mesh = make_patch_mesh(scene, soup, {patch_size, per_edge});
      const Faces faces = make_faces(mesh, soup);
      std::vector<double> area(mesh.elements.size()), of_surface(scene.surfaces.size());
      for (std::size_t f = 0; f < faces.size(); ++f) {
        area[faces.element(f)] += faces.area(f);
        of_surface[faces.surface(f)] += faces.area(f);
        EXPECT_EQ(faces.patch(f), mesh.elements[faces.element(f)].patch);
      }
      for (std::size_t e = 0; e < area.size(); ++e) EXPECT_NEAR(area[e], mesh.elements[e].area, 1e-12);
      EXPECT_NEAR(of_surface[0], 4, 1e-12);
      EXPECT_NEAR(of_surface[1], 3, 1e-12);
      EXPECT_NEAR(of_surface[2], 8, 1e-12);
    }
  }
}

TEST(MakeFaces, AGridOfElementsIsConnected) {
  Scene scene = four_surfaces();
  scene.surfaces.resize(1);
  const PolygonSoup soup = make_soup(scene);
  const Faces faces = make_faces(make_patch_mesh(scene, soup, {0.3, 3}), soup);  // 7 × 7 patches of 3 × 3 elements
  EXPECT_EQ(faces.size(), 21u * 21);
  EXPECT_EQ(faces.points().size(), 22u * 22);
}

TEST(PointAverages, WeighByArea) {
  Faces faces(1e-9);
  faces.add(0, 0, 0, rectangle(0, 0, 1, 1));
  faces.add(0, 0, 1, rectangle(1, 0, 4, 1));
  const std::vector<double> values{8, 80, 4, 40};  // two components
  EXPECT_THAT(point_averages(faces, values, 2), ElementsAre(8, 80, 5, 50, 5, 50, 8, 80, 4, 40, 4, 40));
}

TEST(PointAverages, HiddenElementsAreLeftOut) {
  Faces faces(1e-9);
  faces.add(0, 0, 0, rectangle(0, 0, 1, 1));
  faces.add(0, 0, 1, rectangle(1, 0, 2, 1));
  const std::vector<double> values{0, 4};
  const std::vector<std::uint8_t> hidden{1, 0};
  EXPECT_THAT(point_averages(faces, values, 1, hidden), ElementsAre(0, 4, 4, 0, 4, 4));
}

}  // namespace
}  // namespace exitance
