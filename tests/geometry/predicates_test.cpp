// The stages of the predicates agree, and their bounds hold, where the questions are nearly or exactly degenerate.

#include "geometry/predicates.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "geometry/bounded.h"
#include "src/stress/placement.h"
#include "tests/geometry/rational_points.h"

namespace exitance {
namespace {

struct Question {
  Vec3 x;
  std::array<Vec3, 3> S;  // a plane
  Vec3 c, d, v;           // an edge, and a point off it
};

/// Points nearly in one plane with x: v lies on the edge's line up to a rounding, or up to 2^-k.
Question near_question(Random& random) {
  const auto point = [&] { return Vec3{random.real(-1, 1), random.real(-1, 1), random.real(-1, 1)}; };
  Question q{point(), {point(), point(), point()}, point(), point(), {}};
  const double t = random.real(-1, 2), s = random.real(0.5, 2);
  q.v = q.x + s * (q.c + t * (q.d - q.c) - q.x);
  const double off = std::ldexp(random.real(-1, 1), -random.whole(20, 80));
  q.v = q.v + off * point();
  return q;
}

TEST(Predicates, BoundsHoldAndSignsAreThoseOfExactArithmetic) {
  Random random("predicates");
  StageCounts counts;
  for (int k = 0; k < 20000; ++k) {
    const Question q = near_question(random);
    const ViewFrame frame{q.x, {0, 0, 1}, {&q.S[0], &q.S[1], &q.S[2]}};
    const ViewPlane plane{ViewPlane::Kind::edge, 1, &q.c, &q.d, nullptr};
    const ViewPoint point{ViewPoint::Kind::vertex, false, 0, &q.v, nullptr};
    const Q truth = determinant(exact(q.c) - exact(q.x), exact(q.d) - exact(q.x), exact(q.v) - exact(q.x));
    for (const double accuracy : {0.5, 0x1p-44}) {
      const ExactValue value = exact_value_at(frame, plane, point, counts, accuracy);
      ASSERT_EQ(value.sign, sign(truth)) << k;
      ASSERT_LE(CGAL::abs(Q(value.value) - truth), Q(value.error)) << k;
      ASSERT_LE(value.error, 1.01 * std::max(accuracy, 0x1p-44) * std::fabs(value.value) / (1 - accuracy)) << k;
    }
    const int orientation_sign =
        sign(determinant(exact(q.c) - exact(q.x), exact(q.d) - exact(q.x), exact(q.v) - exact(q.x)));
    EXPECT_EQ(orientation_exact(q.x, q.c, q.d, q.v), orientation_sign);
    if (const auto s = orientation_interval(q.x, q.c, q.d, q.v)) {
      EXPECT_EQ(*s, orientation_sign);
    }
    if (const auto s = orientation_filter(q.x, q.c, q.d, q.v)) {
      EXPECT_EQ(*s, orientation_sign);
    }
  }
  EXPECT_GT(counts.interval, 10000u) << "the stage is reached";
  EXPECT_GT(counts.exact, 1000u) << "the stage is reached";
}

/// A rounded point and a rounded edge of a plane, which stand for where they drop onto it: everything is as of the
/// exact points v − S(v) / N e, and what lies in the plane by identity lies in it exactly.
TEST(Predicates, DroppedPointsLieInThePlane) {
  Random random("dropped points");
  StageCounts counts;
  for (int k = 0; k < 3000; ++k) {
    const Question q = near_question(random);
    ViewFrame frame{q.x, {0.25, -0.5, 1}, {&q.S[0], &q.S[1], &q.S[2]}};
    const Vec3 n = cross(q.S[1] - q.S[0], q.S[2] - q.S[0]);
    while (std::fabs(n[frame.axis]) < std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)})) ++frame.axis;
    frame.axis_sign = n[frame.axis] > 0 ? 1 : -1;
    const auto in_plane = [&] {
      return q.S[0] + random.real(0, 1) * (q.S[1] - q.S[0]) + random.real(0, 1) * (q.S[2] - q.S[0]);
    };
    const Vec3 c = in_plane(), d = in_plane(), v = in_plane();
    const auto S = [&](const Point& p) {
      return determinant(exact(q.S[1]) - exact(q.S[0]), exact(q.S[2]) - exact(q.S[0]), p - exact(q.S[0]));
    };
    const auto dropped = [&](const Vec3& p) {
      Point at = exact(p), above = at;
      const auto axis = static_cast<std::size_t>(frame.axis);
      above[axis] += 1;
      at[axis] -= S(exact(p)) / (S(above) - S(exact(p)));
      return at;
    };
    ASSERT_EQ(sign(S(dropped(v))), 0);
    const Point x = exact(q.x);
    const ViewPoint point{ViewPoint::Kind::vertex, true, 0, &v, nullptr},
        free{ViewPoint::Kind::vertex, false, 0, &q.v, nullptr};
    const ViewPlane edge{ViewPlane::Kind::edge, 1, &c, &d, nullptr, true}, horizon{ViewPlane::Kind::horizon};
    const PlanePoints T{&q.c, &q.d, &q.v};
    const ViewPlane cut{ViewPlane::Kind::cut, 1, nullptr, nullptr, &T};
    const auto check = [&](const ExactValue& value, const Q& truth) {
      EXPECT_EQ(value.sign, sign(truth)) << k;
      EXPECT_LE(CGAL::abs(Q(value.value) - truth), Q(value.error)) << k;
    };
    check(exact_value_at(frame, edge, point, counts), determinant(dropped(c) - x, dropped(d) - x, dropped(v) - x));
    check(exact_value_at(frame, edge, free, counts), determinant(dropped(c) - x, dropped(d) - x, exact(q.v) - x));
    const Point w = dropped(v) - x;
    check(exact_value_at(frame, horizon, point, counts), Q(0.25) * w[0] - Q(0.5) * w[1] + w[2]);
    const Q at_T = determinant(exact(q.d) - exact(q.c), exact(q.v) - exact(q.c), dropped(v) - exact(q.c));
    check(exact_value_at(frame, cut, point, counts), S(x) * at_T);
    const Vec3 m = exact_cross(frame, edge);
    const Point p = dropped(c) - x, r = dropped(d) - x;
    const Q truth = p[1] * r[2] - p[2] * r[1];
    EXPECT_LE(CGAL::abs(Q(m.x) - truth), Q(0x1p-50) * CGAL::abs(truth));
  }
}

TEST(Bounded, HoldsTheTrueValue) {
  Random random("bounded");
  for (int k = 0; k < 2000; ++k) {
    Bounded a(random.real(-1, 1));
    Q truth(static_cast<double>(a.value()));
    for (int step = 0; step < 12; ++step) {
      const double b = random.real(-1, 1);
      switch (random.whole(0, 2)) {
        case 0:
          a = a + Bounded(b);
          truth = truth + Q(b);
          break;
        case 1:
          a = a - Bounded(b);
          truth = truth - Q(b);
          break;
        default:
          a = a * (Bounded(b) + a);
          truth = truth * (Q(b) + truth);
      }
    }
    const auto high = static_cast<double>(a.value()), low = static_cast<double>(a.value() - high);
    EXPECT_LE(CGAL::abs(Q(high) + Q(low) - truth), Q(static_cast<double>(a.certain_error()) * (1 + 0x1p-50))) << k;
  }
  EXPECT_EQ(certain_sign(Bounded(0.1) * Bounded(0)), 0) << "zero without rounding is zero";
  EXPECT_EQ(certain_sign(Bounded(1) - Bounded(1)), 0);
  const Bounded tenth(0.1), three(3);
  EXPECT_EQ(certain_sign(tenth * three - three * tenth), std::nullopt) << "equal as far as can be told";
  EXPECT_EQ(certain_sign(Bounded(1e300) * Bounded(1e300) - Bounded(1)), 1);
}

}  // namespace
}  // namespace exitance
