// Surfaces that lie on each other: what exact visibility sees of them, and that rays which are told of contacts agree.

#include "src/visibility/contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

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

// --- What is level with a facet ------------------------------------------------------------------------------------

/// Sheets in a room of 4 × 4 × 3 without a floor.
struct Sheets {
  Sheets(const std::vector<std::vector<Vec3>>& loops, const Placement& place) {
    Scene scene = empty_scene();
    for (const std::vector<Vec3>& loop : loops) add(scene, loop, place);
    add(scene, {{-2, -2, 3}, {-2, 2, 3}, {2, 2, 3}, {2, -2, 3}}, place);
    soup.emplace(make_soup(scene));
    contacts.emplace(*soup);
  }

  /// Pairs of facets of two sheets of which the one is level with the other, told by either, and of coplanar ones.
  struct Found {
    int level = 0, coplanar = 0;
  };
  Found between(std::uint32_t p, std::uint32_t q) const {
    Found found;
    for (std::uint32_t f = soup->first_facet(p); f < soup->first_facet(p + 1); ++f) {
      for (std::uint32_t t = soup->first_facet(q); t < soup->first_facet(q + 1); ++t) {
        const auto has = [](std::span<const std::uint32_t> all, std::uint32_t one) {
          EXPECT_TRUE(std::ranges::is_sorted(all));
          return std::ranges::binary_search(all, one);
        };
        const bool is_level = has(contacts->level_with(f), t), is_coplanar = has(soup->coplanar(f), t);
        EXPECT_EQ(has(contacts->level_with(t), f), is_level);
        EXPECT_FALSE(is_level && is_coplanar);
        found.level += is_level;
        found.coplanar += is_coplanar;
      }
    }
    return found;
  }

  std::optional<PolygonSoup> soup;
  std::optional<Contacts> contacts;
};

std::vector<Vec3> rectangle_at(double z, double x0, double y0, double x1, double y1) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}
const std::vector<Vec3> kFloor = rectangle_at(0, -2, -2, 2, 2);

// In one plane by identity, or by rounding as they were turned: each two facets the one or the other, all of which meet.
TEST_P(TurnedOrNot, OfTwoInOnePlaneOneIsLevelOnlyWhereRoundingMovedIt) {
  const Sheets sheets({kFloor, rectangle_at(0, -0.7, -0.9, 1.1, 0.8)}, place);
  const auto [level, coplanar] = sheets.between(0, 1);
  const auto facets = [&](std::uint32_t p) {
    return static_cast<int>(sheets.soup->first_facet(p + 1) - sheets.soup->first_facet(p));
  };
  EXPECT_EQ(level + coplanar, facets(0) * facets(1));
  EXPECT_EQ(level > 0, GetParam() != 0);
}

TEST_P(TurnedOrNot, WhatLiesALittleBeforeOrBehindIsLevel) {
  for (const double height : {0x1p-50, -0x1p-50, 0x1p-52}) {
    const Sheets sheets({kFloor, rectangle_at(height, -1, -1, 1, 1)}, place);
    const auto [level, coplanar] = sheets.between(0, 1);
    EXPECT_GT(level, 0) << height;
    EXPECT_TRUE(coplanar == 0 || GetParam() != 0) << height;
  }
}

TEST_P(TurnedOrNot, WhatIsParallelAtADistanceIsNotLevel) {
  for (const double height : {0x1p-40, -0x1p-40, 1e-9, 1e-3}) {
    const Sheets sheets({kFloor, rectangle_at(height, -1, -1, 1, 1)}, place);
    EXPECT_EQ(sheets.between(0, 1).level, 0) << height;
  }
}

TEST_P(TurnedOrNot, WhatMeetsAlongAnEdgeIsLevel) {
  for (const double height : {0x1p-50, -0x1p-50}) {
    const Sheets sheets({rectangle_at(0, -2, -2, 0, 2), rectangle_at(height, 0, -1.1, 1.7, 2)}, place);
    EXPECT_GT(sheets.between(0, 1).level, 0) << height;
  }
}

TEST_P(TurnedOrNot, WhatFacesTheOtherWayIsNotLevel) {
  std::vector<Vec3> down = rectangle_at(0x1p-50, -1, -1, 1, 1);
  std::ranges::reverse(down);
  EXPECT_EQ(Sheets({kFloor, down}, place).between(0, 1).level, 0);
}

// About an edge that they share, or of which one lies in the other: by an angle that rounding could not do.
TEST_P(TurnedOrNot, WhatIsTiltedIsNotLevel) {
  for (const double rise : {1e-9, -1e-9, 0.1}) {
    const std::vector<Vec3> about_an_edge = {{0, -2, 0}, {2, -2, rise}, {2, 2, rise}, {0, 2, 0}};
    const std::vector<Vec3> within = {{-1, -1, -rise}, {1, -1, rise}, {1, 1, rise}, {-1, 1, -rise}};
    EXPECT_EQ(Sheets({rectangle_at(0, -2, -2, 0, 2), about_an_edge}, place).between(0, 1).level, 0) << rise;
    EXPECT_EQ(Sheets({kFloor, within}, place).between(0, 1).level, 0) << rise;
  }
}

// All of it lies in the floor's plane but for rounding, though the floor does not lie in its.
TEST(Contacts, WhatIsSoNarrowThatRoundingTiltsItIsLevel) {
  const std::vector<Vec3> strip = {{-1, 0, 0x1p-51}, {1, 0, 0x1p-51}, {1, 0x1p-48, 0x1p-50}, {-1, 0x1p-48, 0x1p-50}};
  const Sheets sheets({kFloor, strip}, {});
  EXPECT_GT(sheets.between(0, 1).level, 0);
}

// The facets of a sheet that was bent by rounding are no others than itself.
TEST(Contacts, FacetsOfOnePolygonAreNotLevelWithEachOther) {
  const Sheets sheets({{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0x1p-50}, {-2, 2, 0}}}, {});
  ASSERT_EQ(sheets.soup->first_facet(1) - sheets.soup->first_facet(0), 2u);
  EXPECT_EQ(sheets.between(0, 0).level, 0);
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
