#include "src/form_factor/area_cell.h"

#include <gtest/gtest.h>

#include <cmath>

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
  for (const int order : {3, 4, 6, 8}) {
    EXPECT_NEAR(integral(kTriangle, order, [](const Vec3&) { return 1.0; }), 1, 1e-15) << order;
    EXPECT_NEAR(integral(kTrapezium, order, [](const Vec3&) { return 1.0; }), 3, 1e-14) << order;
    // ∫ x² y over 0 ≤ y ≤ 1, 0 ≤ x ≤ 2 (1 − y): 8/3 ∫ y (1 − y)³ dy = 8/60.
    EXPECT_NEAR(integral(kTriangle, order, [](const Vec3& p) { return p.x * p.x * p.y; }), 8.0 / 60, 1e-15) << order;
    // ∫ x over 0 ≤ z ≤ 1, 0 ≤ x ≤ 4 − 2 z: ½ ∫ (4 − 2 z)² dz = 14/3.
    EXPECT_NEAR(integral(kTrapezium, order, [](const Vec3& p) { return p.x; }), 14.0 / 3, 1e-14) << order;
  }
  EXPECT_THROW(integral(kTriangle, 5, [](const Vec3&) { return 1.0; }), std::invalid_argument);
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
    EXPECT_FALSE(crosses(part, oblique));
    EXPECT_TRUE(cut(part, oblique).empty());
  }
  EXPECT_NEAR(area, 3, 1e-14);
}

TEST(AreaCell, APlaneThroughACornerOrAnEdgeLeavesTheCellWhole) {
  EXPECT_TRUE(cut(kTriangle, {{0, 1, 0}, {0, 0, 0}}).empty());
  EXPECT_TRUE(cut(kTriangle, {{1, 0, 0}, {2, 0, 0}}).empty());
  EXPECT_TRUE(cut(kTriangle, {{1, 0, 0}, {3, 0, 0}}).empty());
  EXPECT_TRUE(cut(kTriangle, {{0, 0, 1}, {0, 0, 1}}).empty());
  EXPECT_FALSE(cut(kTriangle, {{1, 0, 0}, {1.9, 0, 0}}).empty());
}

}  // namespace
}  // namespace exitance
