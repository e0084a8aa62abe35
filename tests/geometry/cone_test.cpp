#include "geometry/cone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "geometry/extended.h"
#include "src/stress/placement.h"
#include "tests/geometry/rational_points.h"

namespace exitance {
namespace {

/// Exactly.
template <class Real>
Q rational(Real value) {
  Q sum(0);
  for (; value != 0; value -= Real(static_cast<double>(value))) sum += Q(static_cast<double>(value));
  return sum;
}

template <class Real>
Point rational(const Vec<Real>& v) {
  return {rational(v.x), rational(v.y), rational(v.z)};
}

Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Q square(const Point& v) {
  return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

template <class Real>
class ConeOf : public testing::Test {};
using Numbers = testing::Types<double, long double, Extended>;
TYPED_TEST_SUITE(ConeOf, Numbers);

Vec3 drawn(Random& random, double size) {
  return {random.real(-size, size), random.real(-size, size), random.real(-size, size)};
}

/// Sides err by no more than they say, and the angle along an edge grows as fast as they say and no faster.
TYPED_TEST(ConeOf, CornersHasSidesWithinTheirBounds) {
  Random random("cones");
  for (int k = 0; k < 300; ++k) {
    const Vec3 x = drawn(random, 1);
    const std::array<Vec3, 3> corners{drawn(random, 1), drawn(random, 9), drawn(random, 1)};
    const std::array<const Vec3*, 3> loop{&corners[0], &corners[1], &corners[2]};
    const int turn = random.whole(0, 1) == 0 ? 1 : -1;
    Cone<TypeParam> cone;
    set_cone<TypeParam>(cone, x, loop, turn);
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 &from = corners[c], &to = corners[(c + 1) % 3];
      Point m = cross(exact(from) - exact(x), exact(to) - exact(x));
      for (Q& component : m) component *= turn;
      const ConeSide<TypeParam>& side = cone.sides[c];
      const Q error = rational(side.error);
      ASSERT_LE(square(rational(side.m) - m), error * error);
      const Vec3 w = from - x, e = to - from;
      const double t = std::clamp(-dot(w, e) / dot(e, e), 0.0, 1.0);
      const double fastest = norm(exitance::cross(w, e)) / dot(w + t * e, w + t * e);
      ASSERT_NEAR(static_cast<double>(side.sweep), fastest, 1e-9 * fastest) << t;
    }
  }
}

/// The same of points that stand for where they drop onto a plane, along each axis.
TYPED_TEST(ConeOf, DroppedCornersHasSidesWithinTheirBounds) {
  Random random("dropped cones");
  for (int k = 0; k < 300; ++k) {
    const Vec3 x = drawn(random, 1);
    std::array<Vec3, 3> s{drawn(random, 1), drawn(random, 1), drawn(random, 1)};
    ViewFrame frame{x, {0, 0, 1}, {&s[0], &s[1], &s[2]}};
    const Vec3 n = exitance::cross(s[1] - s[0], s[2] - s[0]);
    while (std::fabs(n[frame.axis]) < std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)})) ++frame.axis;
    frame.axis_sign = n[frame.axis] > 0 ? 1 : -1;
    const auto S = [&](const Point& p) {
      return determinant(exact(s[1]) - exact(s[0]), exact(s[2]) - exact(s[0]), p - exact(s[0]));
    };
    const auto axis = static_cast<std::size_t>(frame.axis);
    std::array<Vec3, 3> corners;
    std::array<Point, 3> dropped;
    std::array<double, 3> heights{};
    for (std::size_t c = 0; c < 3; ++c) {
      corners[c] = s[0] + random.real(0, 1) * (s[1] - s[0]) + random.real(0, 1) * (s[2] - s[0]);
      corners[c][frame.axis] += random.real(-1e-3, 1e-3);
      Point above = exact(corners[c]);
      above[axis] += 1;
      const Q by = S(exact(corners[c])) / (S(above) - S(exact(corners[c])));
      dropped[c] = exact(corners[c]);
      dropped[c][axis] -= by;
      heights[c] = 1.0001 * std::fabs(CGAL::to_double(by));
    }
    const Drop drop{frame, heights};
    const std::array<const Vec3*, 3> loop{&corners[0], &corners[1], &corners[2]};
    Cone<TypeParam> cone;
    set_cone<TypeParam>(cone, x, loop, 1, &drop);
    for (std::size_t c = 0; c < 3; ++c) {
      const Point w = dropped[c] - exact(x), m = cross(w, dropped[(c + 1) % 3] - exact(x));
      const Q error = rational(cone.sides[c].error), length = rational(cone.corners.length(c)),
              corner_error = rational(cone.corners.error(c)) + rational(TypeParam(2 * roundoff<TypeParam>())) * length;
      ASSERT_LE(square(rational(cone.sides[c].m) - m), error * error) << k;
      ASSERT_LE(square(rational(cone.corners.w(c)) - w), corner_error * corner_error) << k;
      // In more digits little is left of what was dropped.
      if (!std::is_same_v<TypeParam, double>) {
        ASSERT_LE(error * error, Q(1e-24) * square(m) + Q(1e-24)) << k;
      }
    }
  }
}

/// A corner in the very point of view lies in every plane through it, whatever the bounds say.
TYPED_TEST(ConeOf, ACornerAtThePointOfView) {
  const Vec3 x{1, 2, 3}, p{2, 2, 4}, q{1, 5, 4};
  const std::array<const Vec3*, 3> loop{&x, &p, &q};
  Cone<TypeParam> cone;
  set_cone<TypeParam>(cone, x, loop, 1);
  const ViewFrame frame{x, {0, 0, 1}, {}};
  StageCounts counts;
  const ConeSide<TypeParam>& far_side = cone.sides[1];
  EXPECT_EQ(value_at(far_side, cone.corners, 0, frame, counts).sign, 0);
  Row<TypeParam> row;
  row.fill(far_side, cone.corners, frame, counts);
  EXPECT_EQ(row.sign(0), 0);
  EXPECT_FALSE(row.any_positive());
  EXPECT_FALSE(row.any_negative());
  SideBlocks<TypeParam> sides;
  sides.set(std::span(&far_side, 1));
  Columns<TypeParam> columns;
  int asked = 0;
  columns.each(sides, cone.corners, cone.sides[0], frame, counts, [&](const auto&, const auto& from, const auto& to) {
    EXPECT_EQ(from.sign, 0);
    EXPECT_EQ(to.sign, 0);
    ++asked;
    return true;
  });
  EXPECT_EQ(asked, 1);
}

/// Of lattice points, many of which lie in the planes of sides, coincide, or lie in the point of view.
TYPED_TEST(ConeOf, RowsAndColumnsTellTheSignOfEveryCorner) {
  Random random("rows");
  const auto cone_of = [&](std::vector<Vec3>& corners, Cone<TypeParam>& cone) {
    std::vector<const Vec3*> loop;
    for (Vec3& v : corners) {
      for (const int axis : {0, 1, 2}) v[axis] = random.whole(-2, 2);
      loop.push_back(&v);
    }
    set_cone<TypeParam>(cone, {}, loop, 1);
  };
  const ViewFrame frame{{}, {0, 0, 1}, {}};
  StageCounts counts;
  for (std::size_t n = 1; n <= 10; ++n) {
    for (int k = 0; k < 20; ++k) {
      std::vector<Vec3> seen(n), of_sides(11 - n);
      Cone<TypeParam> cone, other;
      cone_of(seen, cone);
      cone_of(of_sides, other);
      const auto value = [&](std::size_t side, std::size_t corner) {  // exactly
        return dot(exitance::cross(of_sides[side], of_sides[(side + 1) % of_sides.size()]), seen[corner]);
      };
      const auto sign_of = [](double v) { return v > 0 ? 1 : v < 0 ? -1 : 0; };
      cone.corners.set_kept(0, false);
      for (std::size_t s = 0; s < of_sides.size(); ++s) {
        Row<TypeParam> row;
        StageCounts of_row;
        row.fill(other.sides[s], cone.corners, frame, of_row);
        std::uint64_t certain = 0;
        bool any_positive = false, any_negative = false, all_positive = true;
        for (std::size_t c = 0; c < n; ++c) {
          const double truth = value(s, c);
          ASSERT_EQ(row.sign(c), sign_of(truth)) << n << ", side " << s << ", corner " << c;
          ASSERT_EQ(row.at(c).sign, sign_of(truth));
          ASSERT_LE(std::fabs(static_cast<double>(row.at(c).value) - truth), static_cast<double>(row.at(c).error));
          ASSERT_EQ(value_at(other.sides[s], cone.corners, c, frame, counts).sign, sign_of(truth));
          certain += truth != 0;
          any_positive = any_positive || (c > 0 && truth > 0);
          any_negative = any_negative || (c > 0 && truth < 0);
          all_positive = all_positive && truth > 0;
        }
        ASSERT_EQ(row.any_positive(), any_positive) << n << ", side " << s;
        ASSERT_EQ(row.any_negative(), any_negative) << n << ", side " << s;
        ASSERT_EQ(row.all_positive(), all_positive) << n << ", side " << s;
        ASSERT_GE(of_row.filter, certain) << n << ", side " << s;
      }
      SideBlocks<TypeParam> sides;
      sides.set(other.sides);
      Columns<TypeParam> columns;
      for (const ConeSide<TypeParam>& edge : cone.sides) {
        std::vector<std::array<int, 3>> expected, told;
        bool outside = false;
        for (std::size_t s = 0; s < of_sides.size(); ++s) {
          const int from = sign_of(value(s, edge.from)), to = sign_of(value(s, edge.to));
          outside = outside || (from < 0 && to < 0);
          if (from + to <= 0) expected.push_back({static_cast<int>(s), from, to});
        }
        const bool meets = columns.each(
            sides, cone.corners, edge, frame, counts, [&](const auto& side, const auto& from, const auto& to) {
              told.push_back({static_cast<int>(&side - other.sides.data()), from.sign, to.sign});
              return true;
            });
        ASSERT_EQ(meets, !outside) << n;
        if (meets) {
          ASSERT_EQ(told, expected) << n;
        }
      }
    }
  }
}

TYPED_TEST(ConeOf, AValueThatUnderflowsKeepsItsSign) {
  const Vec3 x, p{1e-200, 0, 0}, q{0, 1e-200, 0}, above{0, 0, 1e-200}, beside{1e-200, 1e-200, 0};
  const std::array<const Vec3*, 2> loop{&p, &q};
  Cone<TypeParam> cone;
  set_cone<TypeParam>(cone, x, loop, 1);
  const ViewFrame frame{x, {0, 0, 1}, {}};
  StageCounts counts;
  const auto value_of = [&](const Vec3& v) {
    return refined_value_at(cone.sides[0], {ViewPoint::Kind::vertex, false, 0, &v, nullptr}, frame, counts);
  };
  EXPECT_EQ(value_of(above).sign, 1);
  EXPECT_GT(value_of(above).value, 0);
  EXPECT_EQ(value_of(above).error, 1);
  EXPECT_EQ(value_of(beside).sign, 0);
  EXPECT_EQ(value_of(beside).value, 0);
  EXPECT_EQ(value_of(beside).error, 0);
}

TYPED_TEST(ConeOf, APointThatDropsIsNoEndOfAnEdgeThatDoesNot) {
  const Vec3 x, p{1, 0, 0}, q{0, 1, 0}, v{0, 0, 1};
  const std::array<const Vec3*, 2> loop{&p, &q};
  Cone<TypeParam> cone;
  set_cone<TypeParam>(cone, x, loop, 1);
  const auto is_end = [&](const Vec3& at, bool dropped) {
    return is_end_of({ViewPoint::Kind::vertex, dropped, 0, &at, nullptr}, cone.sides[0]);
  };
  EXPECT_TRUE(is_end(p, false));
  EXPECT_TRUE(is_end(q, false));
  EXPECT_FALSE(is_end(v, false));
  EXPECT_FALSE(is_end(p, true));
  EXPECT_FALSE(is_end_of({ViewPoint::Kind::at_horizon, false, 1, &p, &v}, cone.sides[0]));
}

/// The corners of a triangle and what the functional of a plane through x that cuts it says of them.
struct Cut {
  std::array<Vec3, 3> corners;
  std::array<Q, 3> truth;
};
Cut cut_by_a_plane(Random& random, const Vec3& x) {
  for (;;) {
    Cut cut{{drawn(random, 1), drawn(random, 1), drawn(random, 1)}, {}};
    const Point n = exact(drawn(random, 1));
    int above = 0, clear = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Point w = exact(cut.corners[c]) - exact(x);
      cut.truth[c] = n[0] * w[0] + n[1] * w[1] + n[2] * w[2];
      above += cut.truth[c] > 0;
      clear += CGAL::abs(cut.truth[c]) > Q(0.01);
    }
    if (clear == 3 && (above == 1 || above == 2)) return cut;
  }
}

/// New corners err by no more than they say where the values that they are cut at do not.
TYPED_TEST(ConeOf, CutsHasCornersWithinTheirBounds) {
  Random random("cuts");
  for (int k = 0; k < 300; ++k) {
    constexpr double kError = 1e-5;
    const Vec3 x = drawn(random, 1);
    const Cut cut = cut_by_a_plane(random, x);
    const std::array<const Vec3*, 3> loop{&cut.corners[0], &cut.corners[1], &cut.corners[2]};
    Cone<TypeParam> cone;
    set_cone<TypeParam>(cone, x, loop, 1);
    std::vector<Signed<TypeParam>> weight;
    for (const Q& truth : cut.truth) {
      const double off = CGAL::to_double(truth) + random.real(-kError, kError);
      weight.push_back({TypeParam(off), TypeParam(1.01 * kError), truth > 0 ? 1 : -1});
    }
    clip(cone, weight, ViewPoint::Kind::at_horizon, ConeSide<TypeParam>{});
    ASSERT_EQ(cone.corners.size(), 5u);
    for (std::size_t c = 3; c < 5; ++c) {
      const ViewPoint& at = cone.corners.exact(c);
      const auto a = static_cast<std::size_t>(at.a - cut.corners.data()),
                 b = static_cast<std::size_t>(at.b - cut.corners.data());
      const Point from = exact(*at.a) - exact(x), to = exact(*at.b) - exact(x);
      const Q t = cut.truth[a] / (cut.truth[a] - cut.truth[b]);
      Point w = to - from;
      for (std::size_t i = 0; i < 3; ++i) w[i] = from[i] + t * w[i];
      const Q error = rational(cone.corners.error(c));
      ASSERT_LE(square(rational(cone.corners.w(c)) - w), error * error) << k;
      ASSERT_EQ(at.sign_at_a, weight[a].sign) << k;
      ASSERT_LE(error, Q(1e-2)) << k;
    }
  }
}

/// A square is cut by planes through x and points of a lattice, many of which go through its corners or touch it.
TYPED_TEST(ConeOf, CutsLeavesWhatIsPositive) {
  const Vec3 x;
  const std::array<Vec3, 4> corners{Vec3{-1, -1, 1}, Vec3{1, -1, 1}, Vec3{1, 1, 1}, Vec3{-1, 1, 1}};
  const std::array<const Vec3*, 4> loop{&corners[0], &corners[1], &corners[2], &corners[3]};
  std::array<int, 3> cut{};  // by how many corners lie in the plane
  for (int n = 0; n < 125; ++n) {
    const Vec3 normal{double(n % 5 - 2), double(n / 5 % 5 - 2), double(n / 25 - 2)};
    std::array<double, 4> height{};
    std::vector<Signed<TypeParam>> weight;
    for (std::size_t c = 0; c < 4; ++c) {
      height[c] = dot(normal, corners[c]);
      weight.push_back({TypeParam(height[c]), TypeParam(0), height[c] > 0 ? 1 : height[c] < 0 ? -1 : 0});
    }
    if (std::ranges::none_of(height, [](double h) { return h > 0; })) continue;
    Cone<TypeParam> cone;
    set_cone<TypeParam>(cone, x, loop, 1);
    ConeSide<TypeParam> closing;
    closing.exact = {ViewPlane::Kind::horizon};
    clip(cone, weight, ViewPoint::Kind::at_horizon, closing);
    std::size_t edges = 0, crossed = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      const double a = height[c], b = height[(c + 1) % 4];
      const auto edge = std::ranges::find_if(cone.sides, [&](const auto& side) {
        return side.exact.kind == ViewPlane::Kind::edge && side.from == c && side.to == (c + 1) % 4;
      });
      ASSERT_EQ(edge != cone.sides.end(), a > 0 || b > 0 || (a == 0 && b == 0)) << n << ", edge " << c;
      ASSERT_EQ(cone.corners.is_kept(c), a >= 0) << n << ", corner " << c;
      crossed += a * b < 0;
      if (edge == cone.sides.end()) continue;
      ++edges;
      ASSERT_NEAR(static_cast<double>(edge->stretch.lo), a < 0 ? a / (a - b) : 0, 1e-15) << n << ", edge " << c;
      ASSERT_NEAR(static_cast<double>(edge->stretch.hi), b < 0 ? a / (a - b) : 1, 1e-15) << n << ", edge " << c;
    }
    ASSERT_EQ(cone.corners.size(), 4 + crossed) << n;
    const bool is_cut = std::ranges::any_of(height, [](double h) { return h < 0; });
    ASSERT_EQ(cone.sides.size(), edges + (is_cut ? 1 : 0)) << n;
    if (!is_cut) continue;
    ++cut[static_cast<std::size_t>(std::ranges::count(height, 0.0))];
    const auto closed =
        std::ranges::find(cone.sides, ViewPlane::Kind::horizon, [](const auto& s) { return s.exact.kind; });
    const auto w = [&](std::uint32_t k) {
      const auto at = cone.corners.w(k);
      return Vec3{static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
    };
    const Vec3 from = w(closed->from), to = w(closed->to);
    ASSERT_LE(std::max(std::fabs(dot(normal, from)), std::fabs(dot(normal, to))), 1e-14) << n;
    for (std::size_t c = 0; c < 4; ++c) {
      const double inside = dot(exitance::cross(from, to), corners[c]);
      ASSERT_TRUE(height[c] <= 0 || inside > 1e-3) << n << ": it runs as the others do";
    }
  }
  for (const int times : cut) EXPECT_GT(times, 3);
}

Signed<double> signed_value(double value, double error = 0) {
  return {value, error, value > 0 ? 1 : value < 0 ? -1 : 0};
}

/// What is left of a stretch where the function from a to b is positive, when nothing has to be known better.
Stretch<double> narrowed(Signed<double> a, Signed<double> b, Stretch<double> stretch = {}) {
  narrow(stretch, a, b, 0.0, [](auto&, auto&, double) { FAIL() << "it is known well enough"; });
  return stretch;
}

TEST(Narrow, LeavesWhatIsPositive) {
  for (const double a : {-1.0, 0.0, 3.0}) {
    for (const double b : {-1.0, 0.0, 1.0}) {
      const Stretch<double> s = narrowed(signed_value(a), signed_value(b));
      EXPECT_EQ(s.empty, a <= 0 && b <= 0) << a << " " << b;
      EXPECT_EQ(s.narrow, a * b < 0) << a << " " << b;
      EXPECT_NEAR(s.lo, a < 0 && b > 0 ? 0.5 : 0, s.lo_error) << a << " " << b;
      EXPECT_NEAR(s.hi, a > 0 && b < 0 ? 0.75 : 1, s.hi_error) << a << " " << b;
      EXPECT_LE(std::max(s.lo_error, s.hi_error), 1e-15);
    }
  }
}

TEST(Narrow, KnowsTheCrossingAsWellAsItsEnds) {
  Random random("narrow");
  for (int k = 0; k < 1000; ++k) {
    const double a = random.real(0.1, 1), b = -random.real(0.1, 1), error = random.real(0, 1e-3);
    const Stretch<double> falling = narrowed(signed_value(a, error), signed_value(b, error)),
                          rising = narrowed(signed_value(b, error), signed_value(a, error));
    for (const double off_a : {-error, error}) {
      for (const double off_b : {-error, error}) {
        const double t = (a + off_a) / (a + off_a - b - off_b);
        EXPECT_LE(std::fabs(falling.hi - t), falling.hi_error);
        EXPECT_LE(std::fabs(rising.lo - (1 - t)), rising.lo_error);
      }
    }
    EXPECT_LE(falling.hi_error, 1.1 * error / (a - b) + 1e-15) << "and no worse";
  }
  EXPECT_GE(narrowed(signed_value(1e-3, 1e-3), signed_value(-1e-3, 1e-3)).hi_error, 1) << "all is open";
}

TEST(Narrow, KeepsTheTighterEndAndTheLargerErrorOfWhatMayBeTheEnd) {
  const Stretch<double> half{0.25, 0.5, 1e-4, 1e-4, false, false};
  const auto at = [&](double t, double error, bool falls) {
    const Signed<double> a = signed_value(falls ? t : -t, error), b = signed_value(falls ? t - 1 : 1 - t, error);
    return narrowed(a, b, half);
  };
  EXPECT_FALSE(at(0.75, 1e-9, true).narrow);
  EXPECT_EQ(at(0.75, 1e-9, true).hi, 0.5);
  EXPECT_EQ(at(0.75, 1e-9, true).hi_error, 1e-4);
  EXPECT_FALSE(at(0.125, 1e-9, false).narrow);
  EXPECT_EQ(at(0.125, 1e-9, false).lo, 0.25);
  EXPECT_NEAR(at(0.375, 1e-9, true).hi, 0.375, 1e-8);
  EXPECT_EQ(at(0.375, 1e-9, true).hi_error, 1e-4);
  EXPECT_NEAR(at(0.375, 1e-9, false).lo, 0.375, 1e-8);
  EXPECT_EQ(at(0.375, 1e-9, false).lo_error, 1e-4);
  // It may be either: both ends' errors count.
  EXPECT_TRUE(at(0.501, 1e-3, true).narrow);
  EXPECT_EQ(at(0.501, 1e-3, true).hi, 0.5);
  EXPECT_GT(at(0.501, 1e-3, true).hi_error, 9e-4);
  EXPECT_TRUE(at(0.249, 1e-3, false).narrow);
  EXPECT_EQ(at(0.249, 1e-3, false).lo, 0.25);
  EXPECT_GT(at(0.249, 1e-3, false).lo_error, 9e-4);
}

TEST(Narrow, AsksForWhatItNeedsAndNoMore) {
  const auto asked = [](double weight, double after_first) {
    std::vector<double> accuracies;
    Stretch<double> stretch;
    narrow(stretch, signed_value(1, 1e-3), signed_value(-1, 1e-3), weight,
           [&](Signed<double>& a, Signed<double>& b, double accuracy) {
             accuracies.push_back(accuracy);
             a.error = b.error = after_first;
           });
    return accuracies;
  };
  EXPECT_TRUE(asked(1, 0).empty());
  EXPECT_EQ(asked(1e4, 1e-9), std::vector<double>{0.5});
  EXPECT_EQ(asked(1e4, 1e-3), (std::vector<double>{0.5, 0x1p-44}));
}

}  // namespace
}  // namespace exitance
