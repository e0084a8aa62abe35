#include "src/form_factor/area_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/form_factor/area_closure.h"
#include "src/scene/reader.h"
#include "tests/places.h"
#include "tests/scene/turned_scene.h"

namespace exitance {
namespace {

Scene scene_in(const char* file) {
  return read_scene(source_file("data/" + std::string(file)));
}

struct Rows : AreaRows {
  AreaClosure closure;
};

Rows rows_of(const Scene& scene, double patch_size, std::uint32_t elements, double tolerance) {
  const PolygonSoup soup = make_soup(scene);
  MeshOptions mesh_options;
  mesh_options.patch_size = patch_size;
  mesh_options.elements_per_edge = elements;
  const PatchMesh mesh = make_patch_mesh(scene, soup, mesh_options);
  Rows rows{area_rows(mesh, soup, {.pairs = {.tolerance = tolerance}}, 1), {}};
  rows.closure = area_closure(mesh, soup, rows.F, true);
  return rows;
}

double entry(const FormFactorMatrix& F, std::size_t row, std::uint32_t column) {
  const auto columns = F.row_columns(row);
  const auto place = std::ranges::find(columns, column);
  return place == columns.end() ? 0 : F.row(row)[static_cast<std::size_t>(place - columns.begin())];
}

TEST(AreaRows, OfACubeAreItsClosedForms) {
  const Rows whole = rows_of(scene_in("furnace_cube.toml"), 0, 1, 1e-12),
             halves = rows_of(scene_in("furnace_cube.toml"), 0, 2, 1e-12);
  ASSERT_EQ(whole.F.rows(), 6u);
  ASSERT_EQ(halves.F.rows(), 24u);
  EXPECT_EQ(halves.F.columns, 6u);
  constexpr double kOpposite = 0.19982489569838744;
  for (std::size_t i = 0; i < 6; ++i) {
    ASSERT_EQ(whole.F.row(i).size(), 5u);
    double opposite = 1;
    for (const double F : whole.F.row(i)) opposite = std::fmin(opposite, F);
    EXPECT_NEAR(opposite, kOpposite, 1e-14);
    // What a face sees is what its quarters see on average.
    for (std::uint32_t j = 0; j < 6; ++j) {
      double mean = 0;
      for (std::size_t quarter = 0; quarter < 4; ++quarter) mean += 0.25 * entry(halves.F, 4 * i + quarter, j);
      EXPECT_NEAR(mean, entry(whole.F, i, j), 1e-13) << i << " " << j;
    }
  }
  EXPECT_LT(halves.closure.max_defect, 1e-13);
  EXPECT_EQ(halves.closure.not_judged, 0u);
  EXPECT_FALSE(halves.reciprocity_max_defect) << "nothing is partial";
}

TEST(AreaRows, OfElementsAreTheirPatchsOnAverage) {
  const Rows patches = rows_of(scene_in("box_on_floor.toml"), 1.5, 1, 1e-8),
             elements = rows_of(scene_in("box_on_floor.toml"), 1.5, 2, 1e-8);
  EXPECT_LE(patches.closure.max_defect, patches.closure.largest_row_error + 1e-13);
  EXPECT_LE(elements.closure.max_defect, elements.closure.largest_row_error + 1e-13);
  EXPECT_LE(*elements.reciprocity_max_defect, 1e-7);
  EXPECT_GT(elements.F.rows(), patches.F.rows());
  EXPECT_EQ(elements.F.columns, patches.F.columns);
}

/// What a box lies on is no hole in a closed room, also where turning both has moved the one off the other by rounding.
TEST(AreaRows, OfATurnedRoomWithContactsAreClosed) {
  const Scene room = with_solid(scene_in("furnace_cube.toml"), 0);
  for (const double turn : {0.0, 0.3, 1.1, 2.2}) {
    const Rows rows = rows_of(turned(room, turn), 0, 1, 1e-3);
    EXPECT_LE(rows.closure.max_defect, rows.closure.largest_row_error + 1e-13) << turn;
    EXPECT_EQ(rows.closure.not_judged, 2u) << turn << ": floor and bottom";
  }
}

/// A sheet shows its back to what is behind it, and rows tell of fronts only: what sees it is not judged, all else is.
TEST(AreaRows, WhatSeesBacksNeedNotSeeOneInAll) {
  Scene room = scene_in("furnace_cube.toml");
  const std::vector<Vec3> floor = room.surfaces[0].polygon.outer;
  const Vec3 middle = 0.5 * (floor[0] + floor[2]);
  const Vec3 up = 0.5 * norm(floor[1] - floor[0]) * normalized(area_vector(floor));
  Surface sheet = room.surfaces[0];
  for (Vec3& v : sheet.polygon.outer) v = middle + 0.3 * (v - middle) + up;
  for (const bool only_obstructs : {false, true}) {
    sheet.obstruction_only = only_obstructs;
    Scene scene = room;
    scene.surfaces.push_back(sheet);
    for (const double turn : {0.0, 0.3}) {
      // Whole walls, too: some of their points see the back.
      const Rows walls = rows_of(turned(scene, turn), 0, 1, 1e-6);
      EXPECT_LE(walls.closure.max_defect, walls.closure.largest_row_error + 1e-13) << turn;
      EXPECT_EQ(walls.closure.not_judged, only_obstructs ? 6u : 5u) << turn;
      const Rows rows = rows_of(turned(scene, turn), 0, 2, 1e-6);
      EXPECT_LE(rows.closure.max_defect, rows.closure.largest_row_error + 1e-13) << turn;
      // The quarters of the floor, and those of the walls that are below.
      EXPECT_EQ(rows.closure.not_judged, only_obstructs ? 24u : 12u) << turn;
      FormFactorMatrix less = rows.F;
      for (double& F : less.F) F *= 1 - 1e-4;
      const PolygonSoup soup = make_soup(turned(scene, turn));
      const PatchMesh mesh = make_patch_mesh(turned(scene, turn), soup, {.elements_per_edge = 2});
      const AreaClosure wrong = area_closure(mesh, soup, less, true);
      if (!only_obstructs) {
        EXPECT_NEAR(wrong.max_defect, 1e-4, 1e-6) << "what sees no backs is judged";
      }
      EXPECT_EQ(area_closure(mesh, soup, less, false).max_defect, 0);
      for (double& F : less.F) F *= 2;
      EXPECT_GT(area_closure(mesh, soup, less, true).max_defect, 0.5) << "too much is no view of backs";
    }
  }
}

/// Walls of two pieces that meet along an edge. Where they lie in one plane exactly the one might cover the other, as
/// far as is looked; where they do so but for rounding it is looked whether they overlap.
TEST(AreaRows, OfATurnedRoomWithCutWallsAreNoLessJudgedThanOfAStraightOne) {
  const Scene whole = scene_in("furnace_cube.toml");
  Scene room = whole;
  room.surfaces.clear();
  for (Surface surface : whole.surfaces) {
    const std::vector<Vec3> v = surface.polygon.outer;
    ASSERT_EQ(v.size(), 4u);
    const Vec3 a = v[0] + 0.375 * (v[1] - v[0]), b = v[3] + 0.375 * (v[2] - v[3]);
    surface.polygon.outer = {v[0], a, b, v[3]};
    room.surfaces.push_back(surface);
    surface.polygon.outer = {a, v[1], v[2], b};
    room.surfaces.push_back(surface);
  }
  for (const double turn : {0.0, 0.3, 1.1, 2.2}) {
    const Rows rows = rows_of(turned(room, turn), 0, 1, 1e-6);
    EXPECT_EQ(rows.F.rows(), 12u);
    EXPECT_LE(rows.closure.max_defect, rows.closure.largest_row_error + 1e-13) << turn;
    EXPECT_LE(rows.closure.not_judged, turn == 0 ? 6u : 1u) << turn;
  }
}

}  // namespace
}  // namespace exitance
