// Pairs that are told apart before they are integrated, and what is known of those that are.

#include "src/form_factor/pair_form_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/form_factor/closed_forms.h"
#include "tests/geometry/solids.h"

namespace exitance {
namespace {

PairFormFactor form_factor_of(const std::vector<Polygon>& polygons, const PairOptions& options = {}) {
  std::vector<Role> roles(polygons.size(), Role::sheet);
  roles[0] = roles[1] = Role::patch;
  const PolygonSoup soup(polygons, roles);
  const ExchangeScene scene(soup);
  return PairIntegrator(scene).form_factor(0, 1, options);
}

const Polygon kSquare{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {}};

/// Side by side, facing each other over a gap that is no more than rounding.
TEST(PairFormFactor, WhatAGapOfRoundingLetsThroughIsWithinItsError) {
  constexpr double h = 0x1p-49;
  const PairFormFactor f = form_factor_of({kSquare, {{{1, 0, h}, {1, 1, h}, {2, 1, h}, {2, 0, h}}, {}}});
  // What plates of twice the width exchange is twice what the halves do with those opposite and with those beside.
  const double beside = opposite_rectangles(2, 1, h) - opposite_rectangles(1, 1, h);
  EXPECT_GT(beside, 0);
  EXPECT_EQ(f.F, 0);
  EXPECT_EQ(f.kind, PairClass::blocked);
  EXPECT_GE(f.F_error, beside);
  EXPECT_LE(f.F_error, 1000 * beside);
}

/// Facing the same way, turned towards each other by no more than rounding.
TEST(PairFormFactor, ATurnOfRoundingLetsNextToNothingThrough) {
  constexpr double h = 0x1p-49;
  const PairFormFactor f = form_factor_of({kSquare, {{{1, 0, 0}, {2, 0, h}, {2, 1, h}, {1, 1, 0}}, {}}});
  EXPECT_EQ(f.F, 0);
  EXPECT_GE(f.F_error, h * h);
  EXPECT_LE(f.F_error, 1e-27);
}

TEST(PairFormFactor, IsNeverMoreThanTheUnobstructedOneHoweverFewPointsThereAre) {
  const Polygon ceiling{{{0, 1, 1}, {1, 1, 1}, {1, 0, 1}, {0, 0, 1}}, {}},
      plate{{{.25, .25, .75}, {.75, .25, .75}, {.75, .75, .75}, {.25, .75, .75}}, {}};
  const auto open = static_cast<double>(opposite_rectangles(1, 1, 1));
  for (const std::uint64_t points : {1, 10, 30}) {
    PairOptions options;
    options.points = points;
    const PairFormFactor f = form_factor_of({kSquare, ceiling, plate}, options);
    EXPECT_FALSE(f.reached);
    EXPECT_GE(f.F, 0);
    EXPECT_LE(f.F, open * (1 + 1e-14));
    EXPECT_LE(f.F_error, open * (1 + 1e-14));
    EXPECT_LE(std::fabs(f.F - static_cast<double>(kShapiroBlocked)), f.F_error);
  }
}

/// DESIGN.md 3 found 288 points for 9e-15.
TEST(PairFormFactor, OneConvexBlockerTakesThreeHundredPoints) {
  const Polygon ceiling{{{0, 1, 1}, {1, 1, 1}, {1, 0, 1}, {0, 0, 1}}, {}},
      plate{{{.25, .25, .75}, {.75, .25, .75}, {.75, .75, .75}, {.25, .75, .75}}, {}};
  const PairFormFactor f = form_factor_of({kSquare, ceiling, plate});
  EXPECT_TRUE(f.reached);
  EXPECT_LE(f.F_error, 1e-12);
  EXPECT_LE(f.points, 320u);
  EXPECT_NEAR(f.F, static_cast<double>(kShapiroBlocked), 1e-15);
}

/// A box in a corner of a room, turned by 30 degrees about the vertical so that two of its edges touch walls. Where all
/// is turned, gaps of rounding open beside these edges, in which slivers of the floor are seen.
TEST(PairFormFactor, EdgesInContactCostNotMuchMoreWhereRoundingPartsThem) {
  const double c = std::sqrt(0.75), s = 0.5;
  const auto prism_over = [](const std::array<Vec3, 4>& base, double height, bool outwards) {
    const auto top = [&](std::size_t k) { return base[k % 4] + Vec3{0, 0, height}; };
    std::vector<Polygon> faces{{{base[3], base[2], base[1], base[0]}, {}}, {{top(0), top(1), top(2), top(3)}, {}}};
    for (std::size_t k = 0; k < 4; ++k) faces.push_back({{base[k], base[(k + 1) % 4], top(k + 1), top(k)}, {}});
    if (!outwards) {
      for (Polygon& face : faces) std::ranges::reverse(face.outer);
    }
    return faces;
  };
  std::vector<Polygon> upright = prism_over({{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}}}, 3, false);
  for (const Polygon& face : prism_over({{{s, 0, 0}, {s + c, s, 0}, {c, s + c, 0}, {0, c, 0}}}, 1, true)) {
    upright.push_back(face);
  }
  std::vector<Polygon> rounded = upright;
  for (Polygon& face : rounded) std::ranges::transform(face.outer, face.outer.begin(), turned);
  const auto floor_to_wall = [](const std::vector<Polygon>& polygons) {
    const PolygonSoup soup(polygons);
    const ExchangeScene scene(soup);
    return PairIntegrator(scene).form_factor(0, 5, {});
  };
  const PairFormFactor a = floor_to_wall(upright), b = floor_to_wall(rounded);
  EXPECT_TRUE(a.reached);
  EXPECT_TRUE(b.reached);
  EXPECT_NEAR(a.F, b.F, a.F_error + b.F_error + 1e-15);
  EXPECT_LE(b.points, 2 * a.points);
}

/// A thousand edges may hide events between a cell's points: looking for those counts as work, too.
TEST(PairFormFactor, AmongHundredsOfOccludersEndsWithItsPointsAndWhenItIsStopped) {
  std::vector<Polygon> polygons{kSquare, {{{0, 1, 1}, {1, 1, 1}, {1, 0, 1}, {0, 0, 1}}, {}}};
  constexpr int kRow = 20;
  for (int i = 0; i < kRow; ++i) {
    for (int j = 0; j < kRow; ++j) {
      const Vec3 at{(i + 0.3) / kRow, (j + 0.2) / kRow, 0.3 + 0.001 * ((7 * i + 13 * j) % 400)};
      const double size = 0.5 / kRow, tilt = 0.2 / kRow;
      polygons.push_back({{at, at + Vec3{size, 0, tilt}, at + Vec3{0, size, -tilt}}, {}});
    }
  }
  std::vector<Role> roles(polygons.size(), Role::sheet);
  roles[0] = roles[1] = Role::patch;
  const PolygonSoup soup(polygons, roles);
  const ExchangeScene scene(soup);
  const auto open = static_cast<double>(opposite_rectangles(1, 1, 1));
  PairOptions options;
  options.points = 1000;
  const PairFormFactor few = PairIntegrator(scene).form_factor(0, 1, options);
  EXPECT_FALSE(few.reached);
  // Both ways, and of each no more than what one cell takes beyond its points.
  EXPECT_LE(few.points, 2 * (options.points + 600));
  EXPECT_LE(few.F, open);
  int asked = 0;
  options.points = 100'000;
  options.stop = [&] { return ++asked > 40; };
  const PairFormFactor stopped = PairIntegrator(scene).form_factor(0, 1, options);
  EXPECT_FALSE(stopped.reached);
  EXPECT_LE(stopped.points, 41 * 600u) << "one cell at most for each time it asked and was told to go on";
  EXPECT_GE(stopped.F_error, 0.1 * open);
}

}  // namespace
}  // namespace exitance
