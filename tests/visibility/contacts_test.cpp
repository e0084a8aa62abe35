// Surfaces that lie on each other: what exact visibility sees of them, and that rays which are told of contacts agree.

#include "src/visibility/contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/contour_form_factor.h"
#include "src/form_factor/area_rows.h"
#include "src/form_factor/point_rows.h"
#include "src/form_factor/sampled_area_rows.h"
#include "src/scene/furnished_room.h"
#include "src/visibility/exact_visibility.h"
#include "src/visibility/ray_sampled_visibility.h"

namespace exitance {
namespace {

struct Placement {
  double angle = 0;  ///< about two axes, so that coordinates are rounded
  Vec3 operator()(const Vec3& v) const {
    const double c = std::cos(angle), s = std::sin(angle);
    const Vec3 w{c * v.x - s * v.y, s * v.x + c * v.y, v.z};
    return {w.x, c * w.y - s * w.z, s * w.y + c * w.z};
  }
};

Scene empty_scene() {
  Scene scene;
  scene.bands = 1;
  scene.materials = {{"grey", {0.5}, {1}}};
  scene.objects = {{"object", ""}};
  return scene;
}

void add(Scene& scene, std::vector<Vec3> loop, const Placement& place) {
  for (Vec3& v : loop) v = place(v);
  Surface surface;
  surface.polygon = {std::move(loop), {}};
  scene.surfaces.push_back(surface);
}

/// The six sides of a box, out or in: bottom and top first.
void add_box(Scene& scene, const Vec3& a, const Vec3& b, bool outward, const Placement& place) {
  const std::vector<std::vector<Vec3>> loops = {{{a.x, a.y, a.z}, {a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, a.y, a.z}},
                                                {{a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z}},
                                                {{a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z}},
                                                {{b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {b.x, a.y, b.z}},
                                                {{b.x, b.y, a.z}, {a.x, b.y, a.z}, {a.x, b.y, b.z}, {b.x, b.y, b.z}},
                                                {{a.x, b.y, a.z}, {a.x, a.y, a.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}}};
  for (std::vector<Vec3> loop : loops) {
    if (!outward) std::ranges::reverse(loop);
    add(scene, loop, place);
  }
}

struct Rows {
  explicit Rows(Scene s, const MeshOptions& options = {})
      : scene(std::move(s)), soup(make_soup(scene)), mesh(make_patch_mesh(scene, soup, options)) {}

  std::vector<std::vector<double>> dense(const FormFactorMatrix& F) const {
    std::vector<std::vector<double>> rows(F.rows(), std::vector<double>(F.columns));
    for (std::size_t i = 0; i < F.rows(); ++i) {
      for (std::size_t k = 0; k < F.row(i).size(); ++k) rows[i][F.row_columns(i)[k]] = F.row(i)[k];
    }
    return rows;
  }
  PointRows rows_of(const MeshVisibility& visibility) const { return point_rows(visibility, 0, mesh.elements.size()); }
  PointRows exact() const { return rows_of(ExactVisibility(mesh, soup)); }
  PointRows by_rays(const RayOptions& options) const { return rows_of(RaySampledVisibility(mesh, soup, options)); }

  Scene scene;
  PolygonSoup soup;
  PatchMesh mesh;
};

double rms(const std::vector<std::vector<double>>& a, const std::vector<std::vector<double>>& b) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < a[i].size(); ++j, ++count) sum += (a[i][j] - b[i][j]) * (a[i][j] - b[i][j]);
  }
  return std::sqrt(sum / count);
}

/// What is left of an error by 16 times the rays. Of independent ones it is a quarter, of evenly spread ones less. An
/// rms over twenty pairs or more that rays find in part is known to 1 / √40, a ratio of two to 0.22 of itself: an error
/// that is of chance alone falls to less than 0.42, three deviations above, and one that is not stays as it is.
constexpr double kApproach = 0.25 * (1 + 3 * 0.22);

double left_of_error(const Rows& rows, const PointRows& exact, RayOptions options) {
  const auto truth = rows.dense(exact.F);
  const double before = rms(rows.dense(rows.by_rays(options).F), truth);
  options.rays *= 16;
  return rms(rows.dense(rows.by_rays(options).F), truth) / before;
}

/// A shelf's board on the floor of a room and a book on the board: 0 … 5 the room, 6 … 11 the board, 12 … 17 the book.
Scene book_on_board(const Placement& place) {
  Scene scene = empty_scene();
  add_box(scene, {-2, -2, 0}, {2, 2, 3}, false, place);
  add_box(scene, {-1, -1, 0}, {1, 1, 0.25}, true, place);
  add_box(scene, {-0.25, -0.25, 0.25}, {0.5, 0.5, 1}, true, place);
  return scene;
}

class TurnedOrNot : public testing::TestWithParam<double> {
 protected:
  Placement place{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Contacts, TurnedOrNot, testing::Values(0.0, 0.4));

TEST_P(TurnedOrNot, BothSidesOfASheetSee) {
  Scene scene = empty_scene();
  add_box(scene, {-2, -2, 0}, {2, 2, 3}, false, place);
  const std::vector<Vec3> sheet = {{-1, -1, 1.5}, {1, -1, 1.5}, {1, 1, 1.5}, {-1, 1, 1.5}};
  add(scene, sheet, place);
  add(scene, {sheet.rbegin(), sheet.rend()}, place);
  for (const double patch_size : {0.0, 1.0, 0.7}) {  // sample points on the diagonal of the sheet, too
    const Rows rows(scene, {.patch_size = patch_size});
    const PointRows exact = rows.exact();
    EXPECT_EQ(exact.statistics.covered_points, 0u) << patch_size;
    EXPECT_LT(exact.statistics.closure_max_defect, 1e-12) << patch_size;
    EXPECT_EQ(rows.by_rays({.rays = 16}).statistics.covered_points, 0u) << patch_size;
    EXPECT_LT(left_of_error(rows, exact, {.rays = 64, .estimator = Estimator::hemisphere}), kApproach) << patch_size;
  }
}

TEST_P(TurnedOrNot, PointsBetweenSolidsSeeNothing) {
  const Rows rows(book_on_board(place));
  const auto& elements = rows.mesh.elements;
  const Contacts contacts(rows.soup);
  const PointRows exact = rows.exact();
  for (std::size_t e = 0; e < elements.size(); ++e)
    EXPECT_EQ(contacts.covered(elements[e].facet, elements[e].sample), exact.F.row(e).empty()) << e;
  EXPECT_GE(exact.statistics.covered_points, 3u) << "floor, bottoms of board and book; in the middle, the board's top";
  for (const Estimator estimator : {Estimator::kernel, Estimator::hemisphere}) {
    RayOptions options{.rays = 256, .estimator = estimator};
    EXPECT_EQ(rows.by_rays(options).statistics.covered_points, exact.statistics.covered_points);
    EXPECT_LT(left_of_error(rows, exact, options), kApproach) << to_string(estimator);
    options.contacts = false;
    EXPECT_GT(left_of_error(rows, exact, options), kApproach) << to_string(estimator);
  }
}

/// The book's bottom, 12, lies on the board, whose bottom, 6, lies on the floor, 0: both see nothing. Rays that are not
/// told start and end within the board, and what the one sees of the floor under it is the closed form of two squares;
/// how much of that turned rays get, which end where board and floor lie in one plane but for rounding, is up to the
/// roundings of Embree's kernel for this processor.
TEST_P(TurnedOrNot, AreasBetweenSolidsAreLeftOut) {
  const Rows rows(book_on_board(place));
  Scene squares = empty_scene();
  add(squares, {{-0.25, -0.25, 0.25}, {-0.25, 0.5, 0.25}, {0.5, 0.5, 0.25}, {0.5, -0.25, 0.25}}, place);
  add(squares, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, place);
  const PolygonSoup soup = make_soup(squares);
  const ExchangeScene two(soup);
  const double through =
      unobstructed_exchange(two.pieces(0)[0].radiator, two.pieces(1)[0].radiator).integral / two.area(0);
  for (const Estimator estimator : {Estimator::kernel, Estimator::hemisphere}) {
    RayOptions options{.rays = 1 << 12, .estimator = estimator};
    const auto sampled = [&] {
      return rows.dense(sampled_area_rows(rows.mesh, rows.soup, ExchangeScene::Unit::element, options).F);
    };
    auto F = sampled();
    for (std::size_t other = 0; other < F.size(); ++other) {
      for (const std::size_t hidden : {6u, 12u}) EXPECT_EQ(F[hidden][other] + F[other][hidden], 0) << hidden << other;
    }
    options.contacts = false;
    F = sampled();
    EXPECT_GT(F[12][0], GetParam() == 0 ? through / 2 : 0) << to_string(estimator);
  }
}

TEST(Contacts, AreasThatAreCoveredInPartApproachExactOnes) {
  const Rows rows(book_on_board({}));
  const auto truth = rows.dense(area_rows(rows.mesh, rows.soup, {.pairs = {.tolerance = 1e-3}}, 1).F);
  const auto error = [&](std::uint32_t n) {
    const RayOptions options{.rays = n, .estimator = Estimator::hemisphere};
    return rms(rows.dense(sampled_area_rows(rows.mesh, rows.soup, ExchangeScene::Unit::element, options).F), truth);
  };
  EXPECT_LT(error(1024), kApproach * error(64));
}

TEST(Contacts, WhatLiesOnTopIsSeen) {
  Scene scene = empty_scene();
  add_box(scene, {-2, -2, 0}, {2, 2, 3}, false, {});
  add(scene, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {});  // a rug at the floor's level
  const Rows rows(scene, {.patch_size = 1.5});                       // the rug's edges run within patches of the floor
  const PointRows exact = rows.exact();
  const std::size_t rug = rows.mesh.patches.size() - 1;
  ASSERT_EQ(rows.mesh.patches[rug].surface, 6u);
  double seen = 0;
  for (const std::vector<double>& row : rows.dense(exact.F)) seen += row[rug];
  EXPECT_GT(seen, 0);
  RayOptions options{.rays = 64};
  EXPECT_LT(left_of_error(rows, exact, options), kApproach);
  options.contacts = false;
  EXPECT_GT(left_of_error(rows, exact, options), kApproach);
}

/// Sheets a few roundings apart, not in the order in which they cover each other: that the topmost covers the lowest
/// only those between them tell.
TEST(Contacts, OfAPileOfSheetsAreThoseThatAreSeen) {
  Scene scene = empty_scene();
  add_box(scene, {-2, -2, 0}, {2, 2, 3}, false, {});
  for (const double k : {0.9, 1.8, 0.0, 2.7}) {
    const double z = 1 + k * 0x1p-47 * 3;
    add(scene, {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}}, {});
  }
  const Rows rows(scene);
  const PointRows exact = rows.exact();
  EXPECT_GE(exact.statistics.covered_points, 3u);
  EXPECT_LT(exact.statistics.closure_max_defect, 1e-12);
  for (const Estimator estimator : {Estimator::kernel, Estimator::hemisphere}) {
    const PointRows sampled = rows.by_rays({.rays = 64, .estimator = estimator});
    EXPECT_EQ(sampled.statistics.covered_points, exact.statistics.covered_points) << to_string(estimator);
  }
  EXPECT_LT(left_of_error(rows, exact, {.rays = 64}), kApproach);
}

/// In a furnished room a fifth of all sample points lie in contacts.
TEST(Contacts, RowsOfFurnishedRoomsApproachExactOnes) {
  const Rows rows(make_furnished_room(200, 1));
  const PointRows exact = rows.exact();
  ASSERT_GT(exact.statistics.covered_points, 20u);
  for (const Estimator estimator : {Estimator::kernel, Estimator::hemisphere}) {
    RayOptions options{.rays = 256, .estimator = estimator};
    EXPECT_EQ(rows.by_rays(options).statistics.covered_points, exact.statistics.covered_points);
    EXPECT_LT(left_of_error(rows, exact, options), kApproach) << to_string(estimator);
    options.rays = 16;
    options.contacts = false;
    EXPECT_GT(left_of_error(rows, exact, options), kApproach) << to_string(estimator);
  }
}

}  // namespace
}  // namespace exitance
