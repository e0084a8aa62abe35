#include "src/form_factor/area_form_factors.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <random>

#include "tests/form_factor/closed_forms.h"

namespace exitance {
namespace {

std::vector<Vec3> rectangle(double z, double x0, double y0, double x1, double y1) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}
Polygon up(std::vector<Vec3> loop) {
  return {std::move(loop), {}};
}
Polygon down(std::vector<Vec3> loop) {
  std::reverse(loop.begin(), loop.end());
  return {std::move(loop), {}};
}
std::vector<Polygon> box(const Vec3& a, const Vec3& b, bool inside = false) {
  const auto corner = [&](int i) { return Vec3{i & 1 ? b.x : a.x, i & 2 ? b.y : a.y, i & 4 ? b.z : a.z}; };
  std::vector<Polygon> faces;
  for (const auto& f : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    std::vector<Vec3> loop{corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])};
    faces.push_back(inside ? down(loop) : up(loop));
  }
  return faces;
}

PairOptions options(double tolerance) {
  PairOptions o;
  o.tolerance = tolerance;
  o.both_ways = true;
  return o;
}
AreaFormFactors all(const std::vector<Polygon>& patches, double tolerance = 1e-12) {
  const PolygonSoup soup(patches);
  return area_form_factors(ExchangeScene(soup), options(tolerance));
}
PairFormFactor pair(const Polygon& a, const Polygon& b, const std::vector<Polygon>& occluders, double tolerance,
                    Role role = Role::sheet) {
  std::vector<Polygon> polygons{a, b};
  std::vector<Role> roles{Role::patch, Role::patch};
  for (const Polygon& p : occluders) {
    polygons.push_back(p);
    roles.push_back(role);
  }
  const PolygonSoup soup(polygons, roles);
  const ExchangeScene scene(soup);
  return PairIntegrator(scene).form_factor(0, 1, options(tolerance));
}

/// Turned by 50 degrees or so about no axis in particular; not even quadrilaterals stay exactly planar.
std::vector<Polygon> turned(std::vector<Polygon> polygons) {
  const double s = 1.0 / 7;
  const Vec3 u{2 * s, 3 * s, 6 * s}, v{-6 * s, -2 * s, 3 * s}, w{3 * s, -6 * s, 2 * s}, o{0.1, 0.2, 0.3};
  for (Polygon& p : polygons) {
    for (Vec3& c : p.outer) c = o + c.x * u + c.y * v + c.z * w;
  }
  return polygons;
}

const Polygon kFloor = up(rectangle(0, 0, 0, 1, 1)), kCeiling = down(rectangle(1, 0, 0, 1, 1));
const Polygon kWall{{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}, {}};
const Polygon kPlate = up(rectangle(0.75, 0.25, 0.25, 0.75, 0.75));

TEST(AreaFormFactors, ClosedForms) {
  for (const auto& move : {+[](std::vector<Polygon> p) { return p; }, +turned}) {
    const auto p = move({kFloor, kCeiling, kWall, kPlate});
    const PairFormFactor opposite = pair(p[0], p[1], {}, 1e-12), beside = pair(p[0], p[2], {}, 1e-12),
                         blocked = pair(p[0], p[1], {p[3]}, 1e-12);
    EXPECT_NEAR(opposite.F, opposite_rectangles(1, 1, 1), 1e-14);
    EXPECT_NEAR(beside.F, kPerpendicularSquares, 1e-13);
    EXPECT_NEAR(blocked.F, kShapiroBlocked, 1e-14);
    for (const PairFormFactor& f : {opposite, blocked}) {
      EXPECT_TRUE(f.reached);
      EXPECT_LE(f.F_error, 1e-12);
    }
    // Turned, points near the common edge need extended precision, and the budget may end first.
    EXPECT_LE(beside.F_error, 1e-10);
    for (const PairFormFactor& f : {opposite, beside, blocked}) {
      EXPECT_NEAR(f.F_reverse, f.F, 1e-15);
    }
  }
}

TEST(AreaFormFactors, BothDirectionsOfUnequalPolygons) {
  const Polygon large = down(rectangle(1, -3, -2, 4, 5)), small = up(rectangle(0, 0.5, 0.5, 0.5625, 0.625));
  const PairFormFactor f = pair(small, large, {}, 1e-12);
  const double A_small = 0.0625 * 0.125, A_large = 49;
  EXPECT_TRUE(f.reached);
  EXPECT_NEAR(f.F * A_small, f.F_reverse * A_large, 1e-14);
  // Seen from its middle; the mean differs in second order of its size.
  double middle = 0;
  for (const double a : {3.53125, 3.46875}) {
    for (const double b : {2.5625, 4.4375}) middle += point_below_corner(a, b, 1);
  }
  EXPECT_NEAR(f.F, middle, 1e-4);
}

TEST(AreaFormFactors, BacksExchangeNothing) {
  for (const auto& [a, b] : {std::pair{kFloor, up(rectangle(1, 0, 0, 1, 1))},
                             {down(kFloor.outer), kCeiling},
                             {kFloor, up(rectangle(0, 2, 0, 3, 1))},
                             {kFloor, down(kFloor.outer)}}) {
    const PairFormFactor f = pair(a, b, {}, 1e-12);
    EXPECT_EQ(f.F, 0);
    EXPECT_EQ(f.F_reverse, 0);
    EXPECT_EQ(f.F_error, 0);
  }
}

TEST(AreaFormFactors, RowsOfClosedRoomsSumToOne) {
  std::vector<Polygon> room = box({0, 0, 0}, {3, 3, 3}, true);
  const auto boxes = box({1, 1, 0}, {2, 2, 1});
  room.insert(room.end(), boxes.begin(), boxes.end());
  for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
    const AreaFormFactors f = all(room, tolerance);
    EXPECT_TRUE(f.reached);
    for (std::size_t i = 0; i < f.n; ++i) {
      double sum = 0, error = 0;
      for (std::size_t j = 0; j < f.n; ++j) {
        sum += f.F[i * f.n + j];
        error += f.F_error[i * f.n + j];
        EXPECT_NEAR(f.area[i] * f.F[i * f.n + j], f.area[j] * f.F[j * f.n + i], 1e-15);
      }
      // The box covers a ninth of the floor (face 0), which sees nothing; nor does the box's bottom (face 6).
      EXPECT_NEAR(sum, i == 0 ? 8.0 / 9 : i == 6 ? 0 : 1, error + 1e-15) << "row " << i;
      EXPECT_LE(error, 11 * tolerance);
    }
    EXPECT_NEAR(f.area[0], 9, 1e-15);
  }
}

TEST(AreaFormFactors, ARugHidesWhatItLiesOnAndTheLaterPatchIsOnTop) {
  const Polygon rug = up(rectangle(0, 0, 0, 0.5, 1));
  const double F = opposite_rectangles(1, 1, 1);
  const AreaFormFactors later = all({kFloor, kCeiling, rug}), earlier = all({rug, kCeiling, kFloor});
  EXPECT_NEAR(later.F[0 * 3 + 1], F / 2, 1e-12);
  EXPECT_NEAR(later.F[2 * 3 + 1], F, 1e-12);
  EXPECT_NEAR(later.F[1 * 3 + 0], F / 2, 1e-12);
  EXPECT_EQ(later.F[0 * 3 + 2], 0);
  EXPECT_NEAR(earlier.F[2 * 3 + 1], F, 1e-12);
  EXPECT_NEAR(earlier.F[0 * 3 + 1], 0, 1e-12);
  EXPECT_NEAR(earlier.F[1 * 3 + 0], 0, 1e-12);
}

TEST(AreaFormFactors, SheetsOfTwoSides) {
  const auto middle = rectangle(0.5, 0, 0, 1, 1);
  const AreaFormFactors f = all({kFloor, kCeiling, up(middle), down(middle)});
  const double half = opposite_rectangles(1, 1, 0.5);
  EXPECT_NEAR(f.F[0 * 4 + 3], half, 1e-13);
  EXPECT_NEAR(f.F[1 * 4 + 2], half, 1e-13);
  for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 3}, {2, 3}}) {
    EXPECT_LE(f.F[i * 4 + j], f.F_error[i * 4 + j]) << i << " " << j;
    EXPECT_LE(f.F_error[i * 4 + j], 1e-12) << i << " " << j;
  }
}

TEST(AreaFormFactors, PureOccludersInAPatchsPlane) {
  const double F = opposite_rectangles(1, 1, 1);
  const auto left = rectangle(0, 0, 0, 0.5, 1), left_above = rectangle(1, 0, 0, 0.5, 1);
  for (const auto& turn : {up, down}) {
    EXPECT_NEAR(pair(kFloor, kCeiling, {turn(left)}, 1e-12).F, F / 2, 1e-12);
    EXPECT_NEAR(pair(kFloor, kCeiling, {turn(left_above)}, 1e-12).F, F / 2, 1e-12);
  }
  // A closed box behind the floor, face to face with its back, hides nothing.
  EXPECT_NEAR(pair(kFloor, kCeiling, box({0, 0, -1}, {0.5, 1, 0}), 1e-12, Role::solid_face).F, F, 1e-12);
}

TEST(AreaFormFactors, ErrorsHoldWhereRandomTrianglesObstruct) {
  // The rule of thumb "so many equal cells, their middles" needs no knowledge of events; its own error here is below
  // 3e-5.
  std::mt19937_64 bits(7);
  const auto real = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
  };
  constexpr int kCells = 120;
  for (int trial = 0; trial < 12; ++trial) {
    std::vector<Polygon> triangles;
    for (int t = 0; t <= trial % 3; ++t) {
      Polygon triangle;
      for (int k = 0; k < 3; ++k) triangle.outer.push_back({real(-0.2, 1.2), real(-0.2, 1.2), real(0.2, 0.8)});
      triangles.push_back(triangle);
    }
    const Polygon& source = trial % 2 == 0 ? kCeiling : kWall;
    std::vector<Polygon> polygons{kFloor, source};
    std::vector<Role> roles{Role::patch, Role::patch};
    for (const Polygon& t : triangles) {
      polygons.push_back(t);
      roles.push_back(Role::sheet);
    }
    const PolygonSoup soup(polygons, roles);
    Viewpoint view(soup);
    double mean = 0;
    for (int i = 0; i < kCells * kCells; ++i) {
      view.look_from({{(i % kCells + 0.5) / kCells, (i / kCells + 0.5) / kCells, 0}, {0, 0, 1}, 0});
      mean += view.form_factor({1, {}}).F / (kCells * kCells);
    }
    PairFormFactor best;
    for (const double tolerance : {1e-6, 1e-4, 1e-2}) {
      const PairFormFactor f = pair(kFloor, source, triangles, tolerance);
      EXPECT_NEAR(f.F, mean, f.F_error + 3e-5) << trial << ", " << tolerance;
      EXPECT_TRUE(f.reached) << trial << ", " << tolerance;
      if (tolerance == 1e-6) best = f;
      EXPECT_NEAR(f.F, best.F, f.F_error + best.F_error) << trial << ", " << tolerance;
    }
  }
}

TEST(AreaFormFactors, OpenMeansOpen) {
  const auto room = box({0, 0, 0}, {1, 1, 1}, true);
  const PolygonSoup soup(room);
  const ExchangeScene scene(soup);
  PairIntegrator integrator(scene);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      const PairFormFactor f = integrator.form_factor(i, j, options(1e-9));
      EXPECT_EQ(f.kind, i == j ? PairClass::facing_away : PairClass::open) << i << " " << j;
      EXPECT_EQ(f.points, 0u);
    }
  }
  const Polygon touching = up(rectangle(0.5, 1, 0, 2, 1)), covering = up(rectangle(0.5, -1, -1, 2, 2));
  EXPECT_EQ(pair(kFloor, kCeiling, {touching}, 1e-9).kind, PairClass::open) << "it only touches the hull";
  EXPECT_EQ(pair(kFloor, kCeiling, {kPlate}, 1e-9).kind, PairClass::partial);
  const PairFormFactor none = pair(kFloor, kCeiling, {covering}, 1e-9);
  EXPECT_EQ(none.kind, PairClass::blocked);
  EXPECT_EQ(none.F, 0);
  EXPECT_EQ(none.points, 0u);
}

TEST(AreaFormFactors, ABudgetThatEndsIsSaidSo) {
  const PolygonSoup soup(std::vector{kFloor, kWall, kPlate}, std::vector{Role::patch, Role::patch, Role::sheet});
  const ExchangeScene scene(soup);
  PairOptions few = options(1e-16);
  few.points = 500;
  const PairFormFactor f = PairIntegrator(scene).form_factor(0, 1, few);
  EXPECT_FALSE(f.reached);
  EXPECT_GT(f.F_error, 1e-16);
  EXPECT_NEAR(f.F, pair(kFloor, kWall, {kPlate}, 1e-12).F, f.F_error);
}

TEST(AreaFormFactors, RelativeToleranceIsOfTheValue) {
  const Polygon far = down(rectangle(100, 0, 0, 1, 1)), plate = up(rectangle(50, 0.25, 0.25, 0.75, 0.75));
  const PolygonSoup soup(std::vector{kFloor, far, plate}, std::vector{Role::patch, Role::patch, Role::sheet});
  const ExchangeScene scene(soup);
  PairIntegrator integrator(scene);
  PairOptions loose = options(1e-15), tight = options(1e-15);
  loose.relative = 1e-4;
  const PairFormFactor a = integrator.form_factor(0, 1, loose), b = integrator.form_factor(0, 1, tight);
  EXPECT_TRUE(a.reached);
  EXPECT_LE(a.F_error, 1e-4 * a.F);
  EXPECT_LE(a.points, b.points);
  EXPECT_NEAR(a.F, b.F, a.F_error + b.F_error);
}

TEST(AreaFormFactors, SameBitsForAnyNumberOfThreads) {
  std::vector<Polygon> room = turned(box({0, 0, 0}, {3, 3, 3}, true));
  const auto boxes = turned(box({1, 1, 0.5}, {2, 2, 1}));
  room.insert(room.end(), boxes.begin(), boxes.end());
  std::vector<AreaFormFactors> results;
  for (const std::size_t threads : {1, 2, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(all(room, 1e-2));
  }
  for (const AreaFormFactors& r : results) {
    EXPECT_EQ(r.F, results[0].F);
    EXPECT_EQ(r.F_error, results[0].F_error);
  }
}

}  // namespace
}  // namespace exitance
