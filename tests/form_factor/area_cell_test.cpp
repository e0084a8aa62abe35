#include "src/form_factor/area_cell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/predicates.h"

namespace exitance {
namespace {

const AreaCell kTriangle{{Vec3{0, 0, 1}, Vec3{2, 0, 1}, Vec3{0, 1, 1}, Vec3{}}, 3};
const AreaCell kTrapezium{{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{2, 0, 1}, Vec3{0, 0, 1}}, 4};

double integral(const AreaCell& cell, int order, double (*f)(const Vec3&)) {
  std::vector<WeightedPoint> points;
  gauss_points(cell, order, points);
  double sum = 0;
  for (const WeightedPoint& p : points) sum += p.weight * f(p.point);
  return sum;
}

TEST(AreaCell, GaussRulesIntegratePolynomials) {
  for (const int order : {3, 4, 5, 6, 8, 12}) {
    EXPECT_NEAR(integral(kTriangle, order, [](const Vec3&) { return 1.0; }), 1, 1e-15) << order;
    EXPECT_NEAR(integral(kTrapezium, order, [](const Vec3&) { return 1.0; }), 3, 1e-14) << order;
    // ∫ x² y over 0 ≤ y ≤ 1, 0 ≤ x ≤ 2 (1 − y): 8/3 ∫ y (1 − y)³ dy = 8/60.
    EXPECT_NEAR(integral(kTriangle, order, [](const Vec3& p) { return p.x * p.x * p.y; }), 8.0 / 60, 1e-15) << order;
    // ∫ x over 0 ≤ z ≤ 1, 0 ≤ x ≤ 4 − 2 z: ½ ∫ (4 − 2 z)² dz = 14/3.
    EXPECT_NEAR(integral(kTrapezium, order, [](const Vec3& p) { return p.x; }), 14.0 / 3, 1e-14) << order;
  }
  EXPECT_THROW(integral(kTriangle, kHighestOrder + 1, [](const Vec3&) { return 1.0; }), std::invalid_argument);
}

TEST(AreaCell, PartsMakeTheWhole) {
  const CutPlane oblique{{1, 2, 3}, {1, 0.25, 0.5}};
  for (const AreaCell& cell : {kTriangle, kTrapezium}) {
    const auto [one, other] = bisect(cell);
    EXPECT_NEAR(one.area() + other.area(), cell.area(), 1e-15);
    EXPECT_GT(one.area(), 0.2 * cell.area());
    EXPECT_GT(other.area(), 0.2 * cell.area());
  }
  double area = 0;
  for (const AreaCell& part : cut(kTrapezium, oblique)) {
    area += part.area();
    EXPECT_FALSE(crosses(part.loop(), oblique));
    EXPECT_TRUE(cut(part, oblique).empty());
  }
  EXPECT_NEAR(area, 3, 1e-14);
}

double area_of(const AreaCell& cell) {
  return integral(cell, kHighestOrder, [](const Vec3&) { return 1.0; });
}

/// An event through a contact starts along the side next to it, so that no straight line between both keeps to one side
/// of it; seen in a plane turned against the axes.
TEST(AreaCell, HalvesOfACellWhoseBentSideStartsAlongTheNextOneDoNotFold) {
  const Vec3 u{2.0 / 7, 3.0 / 7, 6.0 / 7}, v{-6.0 / 7, -2.0 / 7, 3.0 / 7}, normal = cross(u, v);
  const auto at = [&](double x, double y) { return Vec3{4, 2, 2} + x * u + y * v; };
  const double h = 1.0 / 6;
  // From the contact a to b; its tangents at a and at b meet on the side from a to the apex.
  const AreaCell cell{{at(0, 0), at(1, -0.1), at(1, h), at(1, h)}, 3, {at(0.46, 0.46 * h), 1.003}};
  ASSERT_TRUE(is_regular(cell, normal));
  std::vector<AreaCell> parts{cell};
  double area = area_of(cell);
  for (int level = 0; level < 10; ++level) {
    std::vector<AreaCell> halves;
    for (const AreaCell& part : parts) {
      const auto [one, other] = bisect(part);
      EXPECT_TRUE(is_regular(one, normal)) << level;
      EXPECT_TRUE(is_regular(other, normal)) << level;
      EXPECT_NEAR(area_of(one) + area_of(other), area_of(part), 1e-14 * area) << level;
      halves.push_back(one);
      halves.push_back(other);
    }
    parts = std::move(halves);
  }
}

/// What a folded map sends outside of the cell is taken away again.
TEST(AreaCell, PointsOfAFoldCountBackwards) {
  const Vec3 normal{0, 0, 1};
  // The bent side, y = 2 x (1 - x), runs through the straight one, y = 0.4.
  const AreaCell cell{{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 0.4, 0}, Vec3{0, 0.4, 0}}, 4, {{0.5, 1, 0}, 1}};
  EXPECT_FALSE(is_regular(cell, normal));
  std::vector<WeightedPoint> points;
  gauss_points(cell, 8, points);
  double sum = 0, least = 0;
  for (const WeightedPoint& p : points) {
    sum += p.weight;
    least = std::min(least, p.weight);
  }
  EXPECT_LT(least, 0);
  EXPECT_NEAR(sum, 0.4 - 1.0 / 3, 1e-15);
  EXPECT_TRUE(is_regular(kTriangle, normal));
  EXPECT_FALSE(is_regular(kTriangle, {0, 0, -1}));
}

TEST(AreaCell, APlaneThroughACornerOrAnEdgeLeavesTheCellWhole) {
  EXPECT_TRUE(cut(kTriangle, {{0, 1, 0}, {0, 0, 0}}).empty());
  EXPECT_TRUE(cut(kTriangle, {{1, 0, 0}, {2, 0, 0}}).empty());
  EXPECT_TRUE(cut(kTriangle, {{1, 0, 0}, {3, 0, 0}}).empty());
  EXPECT_TRUE(cut(kTriangle, {{0, 0, 1}, {0, 0, 1}}).empty());
  EXPECT_FALSE(cut(kTriangle, {{1, 0, 0}, {1.9, 0, 0}}).empty());
}

/// The weighted values of an integrand, and what the rule and the truth say.
struct Ruled {
  double error, true_error;
};
Ruled ruled(int order, double (*f)(const Vec3&), double truth) {
  const AreaCell square{{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}}, 4};
  std::vector<WeightedPoint> points;
  gauss_points(square, order, points);
  std::vector<double> weighted;
  double sum = 0;
  for (const WeightedPoint& p : points) {
    weighted.push_back(p.weight * f(p.point));
    sum += weighted.back();
  }
  return {truncation_of(weighted, order).error, std::fabs(sum - truth)};
}

TEST(Truncation, BoundsTheErrorOfAnalyticIntegrands) {
  const double logs = std::log(2.2 / 1.2) * std::log(2.5 / 1.5);
  for (int order = 3; order <= kHighestOrder; ++order) {
    const Ruled pole = ruled(
        order, [](const Vec3& p) { return 1 / ((1.2 + p.x) * (1.5 + p.y)); }, logs);
    // Of the sum, as ObstructedExchange counts it.
    const double rounding = (16 + order * order) * kRoundoff;
    EXPECT_LE(pole.true_error, pole.error + rounding * logs) << order;
    // Even about the middle: every other coefficient is zero.
    const Ruled even = ruled(
        order, [](const Vec3& p) { return std::cosh(2 * p.x - 1); }, std::sinh(1.0));
    EXPECT_LE(even.true_error, even.error + rounding * std::sinh(1.0)) << order;
    if (order >= 8) {
      EXPECT_LE(even.error, 1e-7) << order;
    }
  }
}

/// One rule cannot know where a kink lies; it can tell that the integrand is not smooth.
TEST(Truncation, OfAKinkTheFigureIsOfTheErrorsSize) {
  for (int order = 3; order <= kHighestOrder; ++order) {
    const Ruled kink = ruled(
        order, [](const Vec3& p) { return std::fabs(p.x - 0.3); }, 0.5 * (0.09 + 0.49));
    EXPECT_LE(kink.true_error, 10 * kink.error) << order;
    const Ruled late = ruled(
        order, [](const Vec3& p) { return std::max(0.0, p.x + p.y - 1.4); }, 0.6 * 0.6 * 0.6 / 6);
    EXPECT_LE(late.true_error, 10 * late.error) << order;
  }
}

TEST(Truncation, OfNothingIsNothing) {
  EXPECT_EQ(truncation_of(std::vector<double>(16, 0.0), 4).error, 0);
}

}  // namespace
}  // namespace exitance
