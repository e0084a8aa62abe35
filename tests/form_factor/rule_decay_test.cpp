#include "src/form_factor/rule_decay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/form_factor/area_cell.h"
#include "src/form_factor/pole.h"

namespace exitance {
namespace {

const AreaCell kSquare{{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}}, 4};

/// A rule's integral of f over a cell, and what its coefficients tell.
struct Ruled {
  double integral = 0;
  Truncation own;
};
template <class F>
Ruled ruled(const AreaCell& cell, int order, const F& f) {
  std::vector<WeightedPoint> points;
  gauss_points(cell, order, points);
  std::vector<double> weighted;
  Ruled result;
  for (const WeightedPoint& p : points) {
    weighted.push_back(p.weight * f(p.point));
    result.integral += weighted.back();
  }
  result.own = truncation_of(weighted, order);
  return result;
}

/// Poles at any distance, alone and beside a smooth part that is much larger; in closed form.
TEST(RuleDecay, BoundsTheErrorWithinAFewOrdersOfMagnitude) {
  for (const std::vector<int>& orders :
       {std::vector{2, 4, 5, 6}, {2, 4, 8}, {2, 4, 8, 12}, {2, 5, 8}, {2, 6, 12}, {5, 6, 7}, {5, 8, 10}}) {
    for (const double d : {0.05, 0.2, 1.0}) {
      for (const double smooth : {0.0, 10.0}) {
        const auto f = [&](const Vec3& p) { return smooth + 1 / ((d + p.x) * (1.5 + p.y)); };
        const double truth = smooth + std::log((1 + d) / d) * std::log(2.5 / 1.5);
        const Ruled first = ruled(kSquare, orders[0], f);
        RuleDecay decay(orders[0], first.integral, orders[0] == 2 ? 0 : first.own.expected);
        for (std::size_t k = 1; k < orders.size(); ++k) {
          const Ruled next = ruled(kSquare, orders[k], f);
          decay.next(orders[k], next.integral, next.own);
          const double error = std::fabs(next.integral - truth), rounding = 1e-14 * truth;
          EXPECT_LE(error, decay.error() + rounding) << d << ' ' << smooth << ' ' << orders[k];
          if (k >= 2 && d >= 0.2) {  // of poles nearer than that, figures trust the fall less
            EXPECT_LE(decay.error(), 3e3 * (error + rounding)) << d << ' ' << smooth << ' ' << orders[k];
          }
        }
      }
    }
  }
}

/// Equal integrals of two rules leave nothing; of a kink the differences hardly fall, and the figure is of their size.
TEST(RuleDecay, OfConstantsAndOfKinks) {
  RuleDecay constant(2, 1, 0);
  constant.next(4, 1, {});
  EXPECT_EQ(constant.error(), 0);
  const auto kink = [](const Vec3& p) { return std::fabs(p.x - 0.3); };
  RuleDecay decay(4, ruled(kSquare, 4, kink).integral, 0);
  for (int order = 5; order <= kHighestOrder; ++order) {
    const Ruled next = ruled(kSquare, order, kink);
    decay.next(order, next.integral, next.own);
    EXPECT_LE(std::fabs(next.integral - 0.5 * (0.09 + 0.49)), 10 * decay.error()) << order;
  }
}

/// ∫ over a triangle of a function of the direction from its last corner, which the first side passes at a distance of
/// 0.15 of its length: differences of rules fall as fast as ray_fall() says. They swing, so the largest of three
/// counts.
TEST(RayFall, IsHowFastRulesConvergeBesideAContact) {
  const Vec3 apex{0.3, 0.15, 0};
  const AreaCell beside{{Vec3{0, 0, 0}, Vec3{1, 0, 0}, apex, Vec3{0, 0, 0}}, 3};
  const auto f = [&](const Vec3& p) {
    const Vec3 d = p - apex;
    return d.x * d.x / dot(d, d);
  };
  const std::vector<Vec3> contacts{apex};
  const double fall = ray_fall(contacts, beside);
  EXPECT_GT(fall, 0.6);
  EXPECT_LT(fall, 0.8);
  const auto largest_difference = [&](int from) {
    double largest = 0;
    for (int n = from; n < from + 3; ++n) {
      largest = std::max(largest, std::fabs(ruled(beside, n + 1, f).integral - ruled(beside, n, f).integral));
    }
    return largest;
  };
  EXPECT_NEAR(std::pow(largest_difference(13) / largest_difference(5), 1.0 / 16), fall, 0.05);
  EXPECT_EQ(ray_fall({}, beside), 0) << "nothing touches there";
  EXPECT_EQ(ray_fall(contacts, kSquare), 0);
}

}  // namespace
}  // namespace exitance
