// Inputs aimed at each stage of each predicate: that stage decides, and decides as rational arithmetic does; what
// values come with it are within their bounds.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "geometry/open_region.h"
#include "geometry/predicates.h"
#include "src/stress/placement.h"
#include "tests/geometry/rational_points.h"

namespace exitance {
namespace {

Q orientation_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& v) {
  return determinant(exact(b) - exact(a), exact(c) - exact(a), exact(v) - exact(a));
}

/// How a point is aimed at a plane.
enum class Aim {
  clear,    ///< far off it
  rounded,  ///< in it but for the rounding of its coordinates
  hair,     ///< off it by 2^-70 to 2^-200 of its size
  on        ///< in it
};

struct Aimed {
  Vec3 a, b, c, v;
};

/// A plane and a point, at about 1 or on small whole numbers.
Aimed aimed(Aim aim, Random& random) {
  const auto real = [&] { return Vec3{random.real(-1, 1), random.real(-1, 1), random.real(-1, 1)}; };
  if (aim == Aim::clear) return {real(), real(), real(), real()};
  if (aim == Aim::rounded) {
    Aimed q{real(), real(), real(), {}};
    q.v = q.a + random.real(-1, 1) * (q.b - q.a) + random.real(-1, 1) * (q.c - q.a);
    return q;
  }
  const auto whole = [&] { return 1.0 * random.whole(-99, 99); };
  Vec3 b, c, n;
  do {
    b = {whole(), whole(), whole()};
    c = {whole(), whole(), whole()};
    n = cross(b, c);
  } while (n.x == 0 || n.y == 0 || n.z == 0);
  Vec3 v{n.y, -n.x, 0};
  if (aim == Aim::hair) v.z = std::ldexp(random.whole(0, 1) == 0 ? 1 : -1, -random.whole(70, 200));
  return {{}, b, c, v};
}

struct Stages {
  std::uint64_t filter, interval, exact;
};

Stages since(const StageCounts& before, const StageCounts& now) {
  return {now.filter - before.filter, now.interval - before.interval, now.exact - before.exact};
}

constexpr int kTimes = 3000;

class Ladder : public testing::TestWithParam<Aim> {};

TEST_P(Ladder, OrientationIsDecidedOnTheRungAimedAt) {
  Random random("orientation");
  StageCounts counts;
  for (int k = 0; k < kTimes; ++k) {
    const auto [a, b, c, v] = aimed(GetParam(), random);
    const int truth = sign(orientation_of(a, b, c, v));
    ASSERT_EQ(orientation(a, b, c, v, counts), truth);
    ASSERT_EQ(orientation(b, a, c, v, counts), -truth);
    ASSERT_EQ(orientation_exact(a, b, c, v), truth);
    for (const auto stage : {orientation_filter, orientation_interval}) {
      if (const auto s = stage(a, b, c, v)) {
        ASSERT_EQ(*s, truth);
      }
    }
  }
  const Stages stages = since({}, counts);
  EXPECT_EQ(stages.filter + stages.interval + stages.exact, 2u * kTimes);
  switch (GetParam()) {
    case Aim::clear:
      EXPECT_GT(stages.filter, 1.9 * kTimes);
      break;
    case Aim::rounded:
      EXPECT_GT(stages.interval, 1.5 * kTimes);
      break;
    default:
      EXPECT_EQ(stages.exact, 2u * kTimes);
  }
}

TEST_P(Ladder, HorizonIsDecidedOnTheRungAimedAt) {
  Random random("horizon");
  StageCounts counts;
  for (int k = 0; k < kTimes; ++k) {
    const auto [a, b, c, v] = aimed(GetParam(), random);
    const Vec3 n = cross(b - a, c - a);  // as it is rounded
    const Point w = exact(v) - exact(a);
    ASSERT_EQ(horizon_side(a, n, v, counts), sign(Q(n.x) * w[0] + Q(n.y) * w[1] + Q(n.z) * w[2]));
  }
  if (GetParam() == Aim::clear) {
    EXPECT_GT(counts.filter, 0.95 * kTimes);
  } else if (GetParam() == Aim::rounded) {
    EXPECT_GT(counts.interval, 0.7 * kTimes);
  } else {
    EXPECT_EQ(counts.exact, std::uint64_t{kTimes});
  }
}

TEST_P(Ladder, SidesOfFacetsAndRegionsAreThoseOfOrientations) {
  Random random("sides");
  StageCounts counts;
  for (int k = 0; k < kTimes / 10; ++k) {
    const auto [a, b, c, v] = aimed(GetParam(), random);
    const int truth = sign(orientation_of(a, b, c, v));
    const std::vector<Polygon> triangle{{{a, b, c}, {}}};
    const PolygonSoup soup(triangle);
    if (soup.facets().empty()) continue;
    const Plane& plane = soup.facets()[0].plane;
    ASSERT_EQ(side_of(plane, v, counts), truth);
    OpenRegion region;
    region.clear(a, 1e6);
    region.add(plane, -1);
    region.add(a, b, c);
    ASSERT_EQ(region.side(0, v, counts), -truth);
    ASSERT_EQ(region.side(1, v, counts), truth);
    if (const int s = region.certain_side(1, v, counts); s != 0) {
      ASSERT_EQ(s, truth);
    }
    ASSERT_EQ(region.exact_side(1, v, counts), truth);
  }
  if (GetParam() == Aim::clear) {
    EXPECT_GT(counts.filter, counts.exact);
  } else {
    EXPECT_GT(counts.interval + counts.exact, 0u);
  }
}

/// What is asked of planes through a point, all in rational arithmetic: the edge cd, the horizon and a cut of S and T,
/// at v and where the edge from v to `other` crosses the horizon and S.
class PlanesThroughAPoint {
 public:
  Vec3 x, normal, c, d, v, other;
  std::array<Vec3, 3> s, t;

  /// Returns how many values are 0.
  int check(StageCounts& counts) const {
    const PlanePoints S{&s[0], &s[1], &s[2]}, T{&t[0], &t[1], &t[2]};
    const ViewFrame frame{x, normal, S};
    int zeros = 0;
    const auto expect = [&](const ViewPlane& plane, const ViewPoint& point, const Q& truth) {
      for (const double accuracy : {0.5, 0x1p-44}) {
        const ExactValue value = exact_value_at(frame, plane, point, counts, accuracy);
        EXPECT_EQ(value.sign, sign(truth));
        EXPECT_LE(CGAL::abs(Q(value.value) - truth), Q(value.error));
      }
      zeros += sign(truth) == 0;
    };
    for (const ViewPlane& plane :
         {ViewPlane{ViewPlane::Kind::edge, 1, &c, &d, nullptr}, ViewPlane{ViewPlane::Kind::horizon},
          ViewPlane{ViewPlane::Kind::cut, -1, nullptr, nullptr, &T}}) {
      expect(plane, {ViewPoint::Kind::vertex, false, 0, &v, nullptr}, functional(plane, v));
      for (const auto kind : {ViewPoint::Kind::at_horizon, ViewPoint::Kind::at_source_plane}) {
        const bool at_horizon = kind == ViewPoint::Kind::at_horizon;
        if (at_horizon && plane.kind == ViewPlane::Kind::horizon) continue;
        const Q w_v = at_horizon ? of_horizon(v) : of_S(v), w_other = at_horizon ? of_horizon(other) : of_S(other);
        if (sign(w_v) * sign(w_other) >= 0) continue;
        expect(plane, {kind, false, sign(w_v), &v, &other},
               (w_v * functional(plane, other) - w_other * functional(plane, v)) / (w_v - w_other));
      }
    }
    const ExactValue plane_value = exact_plane_value(T, x);
    EXPECT_EQ(plane_value.sign, sign(of_T(x)));
    EXPECT_LE(CGAL::abs(Q(plane_value.value) - of_T(x)), Q(plane_value.error));
    return zeros;
  }

 private:
  Q of_S(const Vec3& p) const { return orientation_of(s[0], s[1], s[2], p); }
  Q of_T(const Vec3& p) const { return orientation_of(t[0], t[1], t[2], p); }
  Q of_horizon(const Vec3& p) const {
    const Point w = exact(p) - exact(x);
    return Q(normal.x) * w[0] + Q(normal.y) * w[1] + Q(normal.z) * w[2];
  }
  Q functional(const ViewPlane& plane, const Vec3& p) const {
    switch (plane.kind) {
      case ViewPlane::Kind::edge:
        return orientation_of(x, c, d, p);
      case ViewPlane::Kind::horizon:
        return of_horizon(p);
      default:
        return Q(-(of_S(x) * of_T(p) - of_T(x) * of_S(p)));
    }
  }
};

TEST_P(Ladder, ValuesThroughAPointAreWithinTheirBounds) {
  Random random("planes through a point");
  StageCounts counts;
  int zeros = 0;
  for (int k = 0; k < kTimes && !HasFailure(); ++k) {
    // The edge cd and the point v in a plane with x, as aimed; S and T two planes.
    PlanesThroughAPoint q;
    const auto [x, c, d, v] = aimed(GetParam(), random);
    q.x = x;
    q.c = c;
    q.d = d;
    q.v = v;
    q.normal = cross(c - x, d - x);
    const auto corner = [&] { return Vec3{random.real(-9, 9), random.real(-9, 9), random.real(-9, 9)}; };
    q.s = {corner(), corner(), corner()};
    q.t = {corner(), corner(), v};
    const bool is_coarse = random.whole(0, 2) == 0;  // ends on lattice points give zeros of cuts, too
    for (auto* points : {&q.s, &q.t}) {
      for (Vec3& p : *points) {
        if (is_coarse && !(p == v)) p = {std::round(p.x), std::round(p.y), std::round(p.z)};
      }
    }
    q.other = random.whole(0, 1) == 0 ? corner() : v + (c - v) + (v - x);
    zeros += q.check(counts);
    const Vec3 m = exact_cross(x, c, d);
    const Point p = exact(c) - exact(x), r = exact(d) - exact(x);
    const Q truth = p[1] * r[2] - p[2] * r[1];
    ASSERT_LE(CGAL::abs(Q(m.x) - truth), Q(0x1p-50) * CGAL::abs(truth));
  }
  EXPECT_GT(counts.interval, 0u);
  EXPECT_GT(counts.exact, GetParam() == Aim::clear ? 0u : std::uint64_t{kTimes} / 4);
  if (GetParam() == Aim::on) {
    EXPECT_GT(zeros, kTimes);
  }
}

/// Points that lie in planes across the axes and on lines along them: nearly all zeros are seen without arithmetic, and
/// what has an end there is no zero by itself.
TEST(ExactValue, OfPointsInPlanesAcrossTheAxesIsTrue) {
  Random random("planes across the axes");
  StageCounts counts;
  int zeros = 0;
  for (int k = 0; k < kTimes && !testing::Test::HasFailure(); ++k) {
    const auto whole = [&] { return 1.0 * random.whole(-1, 1); };
    const auto point = [&] { return Vec3{whole(), whole(), whole()}; };
    const PlanesThroughAPoint q{.x = point(),
                                .normal = point(),
                                .c = point(),
                                .d = point(),
                                .v = point(),
                                .other = point(),
                                .s = {point(), point(), point()},
                                .t = {point(), point(), point()}};
    zeros += q.check(counts);
  }
  EXPECT_GT(zeros, kTimes);
  EXPECT_GT(counts.filter, 0u);
}

std::string name_of(const testing::TestParamInfo<Aim>& one) {
  static const std::array<std::string, 4> kNames = {"clear", "rounded", "hair", "on"};
  return kNames[static_cast<std::size_t>(one.param)];
}

INSTANTIATE_TEST_SUITE_P(Predicates, Ladder, testing::Values(Aim::clear, Aim::rounded, Aim::hair, Aim::on), name_of);

/// A tie goes the way of the first component of the gradient that is not 0.
TEST(GradientSign, TiesGoTheWayOfTheGradient) {
  Random random("gradients");
  for (int k = 0; k < 300; ++k) {
    const auto whole = [&] { return 1.0 * random.whole(-2, 2); };
    const auto point = [&] { return Vec3{whole(), whole(), whole()}; };
    const Vec3 x = point(), c = point(), d = point();
    std::array<Vec3, 3> s{point(), point(), point()};
    const ViewFrame frame{x, {0, 0, 1}, {&s[0], &s[1], &s[2]}};
    const ViewPlane plane{ViewPlane::Kind::edge, random.whole(0, 1) == 0 ? 1 : -1, &c, &d, nullptr};
    const Vec3 m = double(plane.sign) * cross(c - x, d - x);  // exact: small whole numbers
    const double first = m.x != 0 ? m.x : m.y != 0 ? m.y : m.z;
    EXPECT_EQ(gradient_sign(frame, plane), first > 0 ? 1 : first < 0 ? -1 : 0);

    std::array<Vec3, 3> t{point(), point(), point()};
    const PlanePoints T{&t[0], &t[1], &t[2]};
    const Vec3 of_S = cross(s[1] - s[0], s[2] - s[0]), of_T = cross(t[1] - t[0], t[2] - t[0]);
    const Vec3 cut = plane.sign * (dot(of_S, x - s[0]) * of_T - dot(of_T, x - t[0]) * of_S);
    const double first_of_cut = cut.x != 0 ? cut.x : cut.y != 0 ? cut.y : cut.z;
    EXPECT_EQ(gradient_sign(frame, {ViewPlane::Kind::cut, plane.sign, nullptr, nullptr, &T}), first_of_cut > 0   ? 1
                                                                                              : first_of_cut < 0 ? -1
                                                                                                                 : 0);
  }
  const ViewFrame frame{{}, {0, 0, 1}, {}};
  EXPECT_EQ(gradient_sign(frame, {ViewPlane::Kind::horizon}), 1);
}

}  // namespace
}  // namespace exitance
