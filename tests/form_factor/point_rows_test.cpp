#include "src/form_factor/point_rows.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "src/scene/furnished_room.h"
#include "src/visibility/exact_visibility.h"

namespace exitance {
namespace {

Scene empty_scene() {
  Scene scene;
  scene.materials = {{"white", {0.5}, {1}, "", 0}};
  scene.bands = 1;
  scene.objects = {{"object", ""}};
  return scene;
}

void add(Scene& scene, std::vector<Vec3> loop) {
  scene.surfaces.push_back({{std::move(loop), {}}, 0, 0, false, 0});
}

/// Faces of a box, which look outward; in the order −x, +x, −y, +y, −z, +z.
void add_box(Scene& scene, const Vec3& low, const Vec3& high) {
  const auto corner = [&](int x, int y, int z) {
    return Vec3{x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z};
  };
  add(scene, {corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0)});
  add(scene, {corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1)});
  add(scene, {corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)});
  add(scene, {corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0)});
  add(scene, {corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0)});
  add(scene, {corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)});
}

void add_room(Scene& scene, const Vec3& low, const Vec3& high) {
  const std::size_t first = scene.surfaces.size();
  add_box(scene, low, high);
  for (std::size_t k = first; k < scene.surfaces.size(); ++k) {
    auto& loop = scene.surfaces[k].polygon.outer;
    std::swap(loop[1], loop[3]);
  }
}

struct Rows {
  explicit Rows(const Scene& scene, const MeshOptions& options = {})
      : soup(make_soup(scene)), mesh(make_patch_mesh(scene, soup, options)) {}
  PointRows all() const { return point_rows(ExactVisibility(mesh, soup), 0, mesh.elements.size()); }
  PointRows some(std::size_t first, std::size_t last) const {
    return point_rows(ExactVisibility(mesh, soup), first, last);
  }

  PolygonSoup soup;
  PatchMesh mesh;
};

/// Row i with its zeros, of values that belong to the matrix' entries.
std::vector<double> dense(const FormFactorMatrix& F, std::span<const double> values, std::size_t i) {
  std::vector<double> row(F.columns, 0.0);
  for (std::size_t k = F.row_first[i]; k < F.row_first[i + 1]; ++k) row[F.column[k]] = values[k];
  return row;
}
std::vector<double> row(const FormFactorMatrix& F, std::size_t i) {
  return dense(F, F.F, i);
}

std::uint64_t total(const PairCounts& p) {
  return p.facing_away + p.open + p.blocked + p.partial;
}

/// Form factor from a point to the rectangle [0, a] × [0, b] at height 1 above it (Howell's catalogue, B-3).
double corner_form_factor(double a, double b) {
  const double p = std::hypot(1, a), q = std::hypot(1, b);
  return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * std::numbers::pi);
}

TEST(PointRows, InAnEmptyCubeEverythingIsOpen) {
  Scene scene = empty_scene();
  add_room(scene, {0, 0, 0}, {2, 2, 2});
  const PointRows rows = Rows(scene).all();
  EXPECT_EQ(rows.statistics.pairs.open, 30u);
  EXPECT_EQ(rows.statistics.pairs.facing_away, 6u) << "each wall itself";
  EXPECT_EQ(total(rows.statistics.pairs), 36u);
  EXPECT_EQ(rows.statistics.covered_points, 0u);
  EXPECT_LT(rows.statistics.closure_max_defect, 1e-14);
  for (std::size_t i = 0; i < 6; ++i) {
    const double opposite = 4 * corner_form_factor(0.5, 0.5);
    for (std::size_t j = 0; j < 6; ++j) {
      const double expected = i == j ? 0 : i / 2 == j / 2 ? opposite : (1 - opposite) / 4;
      EXPECT_NEAR(row(rows.F, i)[j], expected, 1e-15) << i << ' ' << j;
    }
  }
}

/// Two small squares that face each other at heights 0 and 2 (surfaces 0 and 1), and a thin box between (2 … 7).
Scene plate_between(double x_low) {
  Scene scene = empty_scene();
  add(scene, {{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}});
  add(scene, {{-0.5, -0.5, 2}, {-0.5, 0.5, 2}, {0.5, 0.5, 2}, {0.5, -0.5, 2}});
  add_box(scene, {x_low, -5, 0.9375}, {5, 5, 1.0625});
  return scene;
}

TEST(PointRows, APlateBetweenBlocks) {
  const PointRows rows = Rows(plate_between(-5)).all();
  EXPECT_EQ(rows.statistics.pairs.open, 4u) << "each square and the side of the plate that it sees";
  EXPECT_EQ(rows.statistics.pairs.blocked, 2u) << "the squares";
  EXPECT_EQ(rows.statistics.pairs.partial, 0u);
  EXPECT_EQ(rows.statistics.pairs.facing_away, 58u);
  EXPECT_EQ(row(rows.F, 0)[1], 0);
  EXPECT_EQ(row(rows.F, 1)[0], 0);
  EXPECT_GT(row(rows.F, 0)[6], 0.9);
  EXPECT_EQ(row(rows.F, 0)[7], 0);
}

TEST(PointRows, APlateThatEndsAboveThePointHidesHalf) {
  // The middles of both squares lie in the plane of the plate's side, which they see edge-on.
  const PointRows rows = Rows(plate_between(0)).all();
  const double half = 2 * corner_form_factor(0.25, 0.25);
  EXPECT_NEAR(row(rows.F, 0)[1], half, 1e-15);
  EXPECT_NEAR(row(rows.F, 1)[0], half, 1e-15);
  EXPECT_EQ(rows.statistics.pairs.partial, 2u);
  EXPECT_EQ(rows.statistics.pairs.blocked, 0u);
}

/// Three unit boxes, two of them side by side and one on top of the first, on the floor of a room.
TEST(PointRows, PointsBuriedInAContactSeeNothing) {
  Scene scene = empty_scene();
  add_room(scene, {-3, -3, 0}, {3, 3, 3});
  add_box(scene, {-1, -0.5, 0}, {0, 0.5, 1});
  add_box(scene, {0, -0.5, 0}, {1, 0.5, 1});
  add_box(scene, {-1, -0.5, 1}, {0, 0.5, 2});
  Rows rows(scene);
  EXPECT_NE(rows.mesh.elements[4].sample, (Vec3{0, 0, 0})) << "the line where two boxes meet on the floor";
  rows.mesh.elements[4].sample = {0, 0, 0};
  const PointRows all = rows.all();
  // The bottoms of all boxes, the touching sides of two, the top under the third one; and the floor's middle, where two
  // boxes meet.
  EXPECT_EQ(all.statistics.covered_points, 7u);
  for (const std::size_t buried : {10u, 16u, 22u, 7u, 12u, 11u, 4u}) {
    for (const double F : row(all.F, buried)) EXPECT_EQ(F, 0) << buried;
  }
  EXPECT_LT(all.statistics.closure_max_defect, 1e-12);
}

TEST(PointRows, PointsOfAFloorUnderABoxSeeNothing) {
  Scene scene = empty_scene();
  add_room(scene, {0, 0, 0}, {3, 3, 3});
  add_box(scene, {1, 1, 0}, {2, 2, 1});
  const Rows rows(scene, {.patch_size = 0.34});
  const PointRows all = rows.all();
  std::uint64_t under = 0;
  for (std::size_t e = 0; e < rows.mesh.elements.size(); ++e) {
    const Vec3 p = rows.mesh.elements[e].sample;
    const bool buried = p.z == 0 && 1 < p.x && p.x < 2 && 1 < p.y && p.y < 2;
    under += buried;
    EXPECT_EQ(all.F.row(e).empty(), buried) << p.x << ' ' << p.y << ' ' << p.z;
  }
  EXPECT_EQ(under, 18u) << "nine of the floor and nine of the box";
  EXPECT_EQ(all.statistics.covered_points, under);
  EXPECT_LT(all.statistics.closure_max_defect, 1e-12);
}

class ClosedRoom : public testing::TestWithParam<std::uint64_t> {};

TEST_P(ClosedRoom, FrontsAndBacksAddUpToOne) {
  const Rows rows(make_furnished_room(500, GetParam()));
  const PointRows all = rows.all();
  EXPECT_LT(all.statistics.closure_max_defect, 1e-12);
  EXPECT_GT(all.statistics.covered_points, 20u);
  EXPECT_LT(all.statistics.covered_points, 250u);
  // Where no back is seen at all, the row itself sums to 1.
  std::size_t whole = 0;
  for (const double sum : row_sums(all.F)) {
    EXPECT_LT(sum, 1 + 1e-12);
    whole += std::fabs(sum - 1) < 1e-12;
  }
  EXPECT_GT(whole, 250u);
}

TEST_P(ClosedRoom, CountsAddUp) {
  const Rows rows(make_furnished_room(200, GetParam()));
  for (std::size_t e = 0; e < rows.mesh.elements.size(); ++e) {
    const PointRows one = rows.some(e, e + 1);
    const PairCounts& pairs = one.statistics.pairs;
    EXPECT_LE(one.F.F.size(), pairs.open + pairs.partial) << e;
    if (one.statistics.covered_points == 0) {
      EXPECT_EQ(total(pairs), rows.mesh.patches.size()) << e;
    } else {
      EXPECT_TRUE(one.F.F.empty()) << e;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ClosedRoom, testing::Values(1, 2, 3));

void expect_same(const FormFactorMatrix& a, const FormFactorMatrix& b) {
  EXPECT_EQ(a.row_first, b.row_first);
  EXPECT_EQ(a.column, b.column);
  EXPECT_EQ(a.F, b.F);
  EXPECT_EQ(a.F_error, b.F_error);
  EXPECT_EQ(a.columns, b.columns);
}

TEST(PointRows, AnyNumberOfThreadsGivesTheSameBits) {
  const Rows rows(make_furnished_room(500, 4));
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return rows.all();
  };
  const PointRows one = with_threads(1), two = with_threads(2), again = with_threads(2);
  expect_same(one.F, two.F);
  expect_same(one.F, again.F);
  EXPECT_EQ(one.statistics.closure_max_defect, two.statistics.closure_max_defect);
  EXPECT_EQ(one.statistics.covered_points, two.statistics.covered_points);
  EXPECT_EQ(one.statistics.extended, two.statistics.extended);
  EXPECT_EQ(one.statistics.stages.filter, two.statistics.stages.filter);
  EXPECT_EQ(one.statistics.stages.exact, two.statistics.stages.exact);
  EXPECT_EQ(total(one.statistics.pairs), total(two.statistics.pairs));
}

TEST(PointRows, RowsAndColumnsAreThoseOfTheWholeMatrix) {
  const Rows rows(make_furnished_room(200, 5));
  const PointRows all = rows.all();
  const PointRows middle = rows.some(50, 60);
  for (std::size_t e = 50; e < 60; ++e) EXPECT_EQ(row(middle.F, e - 50), row(all.F, e));
  std::vector<double> F(rows.mesh.elements.size()), F_error(F.size());
  for (const std::size_t patch : {0u, 17u, 199u}) {
    EXPECT_TRUE(point_column(ExactVisibility(rows.mesh, rows.soup), patch, F, F_error));
    for (std::size_t e = 0; e < F.size(); ++e) EXPECT_EQ(F[e], row(all.F, e)[patch]) << e << ' ' << patch;
  }
  EXPECT_FALSE(point_column(ExactVisibility(rows.mesh, rows.soup), 0, F, F_error, [] { return true; }));
  EXPECT_EQ(rows.some(7, 7).F.rows(), 0u);
}

Vec3 turned(const Vec3& v, const Vec3& axis, double angle) {  // Rodrigues
  const Vec3 k = normalized(axis);
  return std::cos(angle) * v + std::sin(angle) * cross(k, v) + (1 - std::cos(angle)) * dot(k, v) * k;
}

/// Turned, patches' corners lie off the plane of their facet by a rounding, and surfaces in contact lie before or
/// behind each other by as much; faces are two triangles that are not quite in one plane.
/// No sample point lies on an edge of the contacts: from an ulp away what is seen is what the rounded numbers say.
TEST(PointRows, PatchesOfTurnedSurfacesInContactTileWhatIsSeen) {
  const Vec3 axes[] = {{1, 2, 3}, {-2, 1, 5}, {1, 0, 0}, {1, 1, 1}};
  int turn = 0;
  for (const Vec3& axis : axes) {
    for (const double far_off : {0.0, 1e4}) {
      Scene scene = empty_scene();
      add_room(scene, {0, 0, 0}, {3, 3, 3});
      add_box(scene, {1, 1, 0}, {2, 2, 1});
      add_box(scene, {1.3, 1.3, 1}, {1.8, 2, 1.5});
      add_box(scene, {0, 1, 0}, {1, 2, 0.5});
      for (Surface& surface : scene.surfaces) {
        for (Vec3& v : surface.polygon.outer) v = turned(v, axis, 0.6458 + turn) + Vec3{far_off, far_off, 0};
      }
      ++turn;
      for (const double size : {1.0, 0.6}) {
        const Rows rows(scene, {.patch_size = size});
        const PointRows all = rows.all();
        // An ulp of coordinates is a gap or an overlap of that much between patches and facets.
        EXPECT_LT(all.statistics.closure_max_defect, far_off > 0 ? 1e-10 : 1e-13) << turn << ' ' << size;
        for (std::size_t e = 0; e < rows.mesh.elements.size(); ++e) {
          const auto F = row(all.F, e);
          EXPECT_LT(std::accumulate(F.begin(), F.end(), 0.0), 1 + 1e-10) << turn << ' ' << size << ' ' << e;
        }
      }
    }
  }
}

/// Edges of boxes, a sheet on the floor and one that pierces it run through sample points of the floor and of each
/// other; turned, they miss them by a rounding.
TEST(PointRows, SamplePointsKeepAwayFromEdgesOfOtherSurfaces) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int turn = 0; turn < 6; ++turn) {
    Scene scene = empty_scene();
    add_room(scene, {0, 0, 0}, {4, 4, 4});
    add_box(scene, {0.5, 0.5, 0}, {1.5, 1.5, 1});
    add_box(scene, {0.5, 0.5, 1}, {1, 1, 1.5});
    add_box(scene, {1.5, 0, 0}, {2.5, 1, 0.5});
    add(scene, {{2.5, 2.5, 0}, {3.5, 2.5, 0}, {3.5, 2.5, 1}, {2.5, 2.5, 1}});
    add(scene, {{2.5, 2.5, 0}, {2.5, 2.5, 1}, {3.5, 2.5, 1}, {3.5, 2.5, 0}});
    add(scene, {{0.5, 2.5, -0.5}, {1.5, 3.5, -0.5}, {1.5, 3.5, 1}, {0.5, 2.5, 1}});
    add(scene, {{0.5, 2.5, -0.5}, {0.5, 2.5, 1}, {1.5, 3.5, 1}, {1.5, 3.5, -0.5}});
    const Vec3 axis{any(random), any(random), any(random)};
    const double angle = 3 * any(random), far_off = turn % 2 ? 1e3 : 0;
    for (Surface& surface : scene.surfaces) {
      for (Vec3& v : surface.polygon.outer) v = turned(v, axis, turn ? angle : 0) + Vec3{far_off, far_off, 0};
    }
    const Rows rows(scene, {.patch_size = 1});
    // A part of one sheet stands out of the room, where nothing closes what is seen.
    const auto is_inside = [&](const Element& e) {
      for (std::uint32_t wall = 0; wall < rows.soup.first_facet(6); ++wall) {
        const Plane& plane = rows.soup.facets()[wall].plane;
        if (dot(plane.normal, e.sample - plane.origin) < -1e-6) return false;
      }
      return true;
    };
    std::size_t outside = 0;
    for (std::size_t e = 0; e < rows.mesh.elements.size(); ++e) {
      const PointRows row = rows.some(e, e + 1);
      EXPECT_LT(row_sums(row.F)[0], 1 + 1e-10) << turn;
      if (is_inside(rows.mesh.elements[e])) {
        EXPECT_LT(row.statistics.closure_max_defect, far_off > 0 ? 1e-10 : 1e-12) << turn;
      } else {
        ++outside;
      }
    }
    EXPECT_GT(outside, 0u);
    EXPECT_LT(outside, 10u);
  }
}

TEST(PointRows, StatisticsOfSomeElementsAreThoseOfTheirRows) {
  const Rows rows(make_furnished_room(200, 5));
  const std::vector<std::size_t> elements = {31, 7, 198, 7};
  PointRowStatistics expected;
  for (const std::size_t e : elements) expected += rows.some(e, e + 1).statistics;
  const PointRowStatistics found = point_row_statistics(ExactVisibility(rows.mesh, rows.soup), elements);
  EXPECT_EQ(found.closure_max_defect, expected.closure_max_defect);
  EXPECT_EQ(found.covered_points, expected.covered_points);
  EXPECT_EQ(found.pairs.open, expected.pairs.open);
  EXPECT_EQ(found.pairs.partial, expected.pairs.partial);
  EXPECT_EQ(found.pairs.blocked, expected.pairs.blocked);
  EXPECT_EQ(point_row_statistics(ExactVisibility(rows.mesh, rows.soup), {}).covered_points, 0u);
}

TEST(PointRows, TheOrderOfPolygonsChangesNoMoreThanTheErrorBoundsSay) {
  const Scene scene = make_furnished_room(200, 6);
  Scene reversed = scene;
  std::ranges::reverse(reversed.surfaces);
  const Rows forth(scene), back(reversed);
  const PointRows a = forth.all(), b = back.all();
  const std::size_t n = scene.surfaces.size();
  ASSERT_EQ(a.F.rows(), n);
  ASSERT_EQ(b.F.rows(), n);
  for (std::size_t e = 0; e < n; ++e) {
    const auto p = dense(a.F, a.F.F, e), q = dense(b.F, b.F.F, n - 1 - e);
    const auto p_error = dense(a.F, a.F.F_error, e), q_error = dense(b.F, b.F.F_error, n - 1 - e);
    for (std::size_t j = 0; j < n; ++j) {
      // What does not exceed its error is left out of a row.
      EXPECT_NEAR(p[j], q[n - 1 - j], p_error[j] + q_error[n - 1 - j] + kPointTolerance) << e << ' ' << j;
    }
  }
}

}  // namespace
}  // namespace exitance
