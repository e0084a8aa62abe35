// The oracle itself, against closed forms, symmetry and rays.

#include "src/stress/visibility_oracle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "src/stress/placement.h"
#include "src/stress/stage.h"

namespace exitance {
namespace {

using Loop = std::vector<Vec3>;

constexpr long double kPi = std::numbers::pi_v<long double>;
constexpr Vec3 kPoint{0, 0, 0}, kUp{0, 0, 1};

/// Faces down.
Polygon ceiling(double z, double x0, double y0, double x1, double y1) {
  return {reversed(rectangle(z, x0, y0, x1, y1)), {}};
}

long double form_factor(const Polygon& source, const std::vector<Obstacle>& occluders = {}, const Vec3& normal = kUp) {
  return oracle_form_factor({kPoint, normal, source, occluders}).F;
}

bool agree(long double a, long double b) {
  return std::abs(a - b) < 1e-18L;
}

/// Point to a parallel rectangle a × b at distance c, one corner straight above the point.
long double parallel_rectangle(long double a, long double b, long double c) {
  const long double x = a / c, y = b / c, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * kPi);
}

/// Point to a perpendicular rectangle standing on the point's plane: distance c, height a, width b from straight ahead.
long double perpendicular_rectangle(long double a, long double b, long double c) {
  const long double x = a / b, y = c / b, r = std::sqrt(x * x + y * y);
  return (std::atan(1 / y) - y / r * std::atan(1 / r)) / (2 * kPi);
}

TEST(Oracle, KnowsClosedForms) {
  EXPECT_PRED2(agree, form_factor(ceiling(2, 0, 0, 3, 5)), parallel_rectangle(3, 5, 2));
  EXPECT_PRED2(agree, form_factor(ceiling(2, -1, -2, 3, 5)),
               parallel_rectangle(3, 5, 2) + parallel_rectangle(1, 5, 2) + parallel_rectangle(3, 2, 2) +
                   parallel_rectangle(1, 2, 2));
  const Polygon wall{{{2, 0, 0}, {2, 0, 5}, {2, 3, 5}, {2, 3, 0}}, {}};  // faces the point
  EXPECT_PRED2(agree, form_factor(wall), perpendicular_rectangle(5, 3, 2));
}

TEST(Oracle, ClipsAtTheHorizon) {
  const Polygon wall{{{2, 0, -7}, {2, 0, 5}, {2, 3, 5}, {2, 3, -7}}, {}};
  EXPECT_PRED2(agree, form_factor(wall), perpendicular_rectangle(5, 3, 2));
  EXPECT_EQ(form_factor(wall, {}, -kUp) > form_factor(wall), true) << "more of it lies below";
  EXPECT_EQ(form_factor(ceiling(2, 0, 0, 3, 5), {}, -kUp), 0);
}

TEST(Oracle, SourcesEmitOnTheirFrontOnly) {
  EXPECT_EQ(form_factor({rectangle(2, 0, 0, 3, 5), {}}), 0);
  EXPECT_EQ(form_factor(ceiling(0, 1, 1, 3, 5)), 0) << "edge-on";
  EXPECT_EQ(form_factor({{{1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, {}}), 0) << "no area";
}

TEST(Oracle, ScalesCancel) {
  const long double unit = form_factor(ceiling(2, -1, -2, 3, 5), {sheet(rectangle(1, 0, 0, 1, 1))});
  for (const double s : {0x1p-40, 0x1p40}) {
    const auto answer = oracle_form_factor(
        {kPoint, s * kUp, ceiling(2 * s, -s, -2 * s, 3 * s, 5 * s), {sheet(rectangle(s, 0, 0, s, s))}});
    EXPECT_EQ(answer.F, unit);
    EXPECT_EQ(answer.visible_area, 24 * static_cast<long double>(s) * s);
  }
}

TEST(Oracle, ShadowsAreTakenAwayOnce) {
  const Polygon source = ceiling(2, -1, -2, 3, 5);
  const long double shadow = parallel_rectangle(1, 2, 2);
  const Obstacle veil = sheet(rectangle(1, 0, 0, 0.5, 1));
  EXPECT_PRED2(agree, form_factor(source, {veil}), form_factor(source) - shadow);
  EXPECT_EQ(form_factor(source, {veil, veil}), form_factor(source, {veil}));
  EXPECT_EQ(form_factor(source, {sheet({{0, 1, 1}, {0.5, 1, 1}, {0.5, 0, 1}, {0, 0, 1}})}), form_factor(source, {veil}))
      << "from both sides";
  EXPECT_EQ(form_factor(source, {sheet(rectangle(1, 0, 0, 0.5, 0.5)), sheet(rectangle(1, 0, 0.5, 0.5, 1))}),
            form_factor(source, {veil}))
      << "abutting halves are the whole";
}

TEST(Oracle, HalfIsHalf) {
  const Polygon source = ceiling(2, -1, -2, 1, 2);
  EXPECT_PRED2(agree, form_factor(source, {sheet(rectangle(1, 0, -9, 9, 9))}), form_factor(source) / 2);
  EXPECT_EQ(form_factor(source, {sheet(rectangle(1, -0.5, -1, 0.5, 1))}), 0) << "exactly covered";
  EXPECT_EQ(form_factor(source, {sheet(rectangle(1, -9, -9, 0, 9)), sheet(rectangle(1, 0, -9, 9, 9))}), 0);
}

TEST(Oracle, HolesLetThrough) {
  const Polygon source = ceiling(2, -4, -4, 4, 4);
  const Polygon frame{rectangle(1, -2, -2, 2, 2), {rectangle(1, -0.5, -0.5, 0.5, 0.5)}};
  EXPECT_PRED2(agree, form_factor(source, {{{frame}, false}}), 4 * parallel_rectangle(1, 1, 2));
  Polygon ring = source;
  ring.holes.push_back(rectangle(2, -1, -1, 1, 1));
  EXPECT_PRED2(agree, form_factor(ring) + 4 * parallel_rectangle(1, 1, 2), form_factor(source));
  EXPECT_EQ(form_factor(ring, {{{frame}, false}}), 0);
}

TEST(Oracle, OccludesOnlyBetween) {
  const Polygon source = ceiling(2, -1, -2, 3, 5);
  const long double open = form_factor(source);
  EXPECT_EQ(form_factor(source, {sheet(rectangle(3, -9, -9, 9, 9))}), open) << "beyond";
  EXPECT_EQ(form_factor(source, {sheet(rectangle(-1, -9, -9, 9, 9))}), open) << "behind";
  EXPECT_EQ(form_factor(source, {sheet(rectangle(0, -9, -9, 9, 9))}), open) << "edge-on, around the point";
  EXPECT_EQ(form_factor(source, {sheet({{0, 0, 0}, {0, 1, 1}, {0, -1, 1}})}), open) << "edge-on, upright";
  // Pierces the source's plane: only its lower half, cut at y = 0, hides anything, from y = −1 on the source to y = 0.
  EXPECT_PRED2(agree, form_factor(source, {sheet({{0, -0.5, 1}, {0.5, -0.5, 1}, {1.5, 0.5, 3}, {-0.5, 0.5, 3}})}),
               form_factor(source, {sheet({{0, -0.5, 1}, {0.5, -0.5, 1}, {1, 0, 2}, {-0.25, 0, 2}})}));
}

TEST(Oracle, ContactsFollowTheRules) {
  const Polygon source = ceiling(2, -1, -2, 3, 5);
  const long double covered = form_factor(source) - parallel_rectangle(1, 1, 2);
  EXPECT_PRED2(agree, form_factor(source, {sheet(rectangle(2, 0, 0, 1, 1))}), covered);
  EXPECT_PRED2(agree, form_factor(source, {sheet({{0, 1, 2}, {1, 1, 2}, {1, 0, 2}, {0, 0, 2}})}), covered);
  const Polygon up{rectangle(2, 0, 0, 1, 1), {}}, down = ceiling(2, 0, 0, 1, 1);
  EXPECT_PRED2(agree, form_factor(source, {{{up}, true}}), covered) << "the top of a solid in front";
  EXPECT_EQ(form_factor(source, {{{down}, true}}), form_factor(source)) << "the bottom of a solid behind";
}

TEST(Oracle, NonPlanarSourcesAreTheirTriangles) {
  const Vec3 a{-3, 2, 2}, b{3, 2, 2.5}, c{3, -3, 2}, d{-3, -3, 2};
  const Obstacle veil = sheet({{-0.5, -0.5, 1}, {1, -0.25, 0.5}, {0.25, 1, 1.25}});
  EXPECT_PRED2(agree, form_factor({{a, b, c, d}, {}}, {veil}),
               form_factor({{a, c, d}, {}}, {veil}) + form_factor({{a, b, c}, {}}, {veil}));
}

/// Whether the open segment from the origin to p meets a triangle.
bool blocked(const Vec3& p, const Loop& triangle) {
  const Vec3 &a = triangle[0], &b = triangle[1], &c = triangle[2];
  const double total = dot(cross(b - a, c - a), p);
  const double u = dot(cross(a, b), p) / total, v = dot(cross(b, c), p) / total, w = dot(cross(c, a), p) / total;
  const double t = dot(cross(b - a, c - a), a) / total;
  return u >= 0 && v >= 0 && w >= 0 && t > 0 && t < 1;
}

TEST(Oracle, AgreesWithRays) {
  // Midpoints of a 600 × 600 grid on the source: errors come from the shadows' boundaries only.
  constexpr int n = 600;
  for (int scene = 0; scene < 6; ++scene) {
    Random random("rays" + std::to_string(scene));
    std::vector<Loop> triangles;
    std::vector<Obstacle> occluders;
    const auto corner = [&] { return Vec3{random.real(-2, 2), random.real(-2, 2), random.real(-1, 3)}; };
    for (int i = 0; i < 1 + 2 * scene; ++i) {
      triangles.push_back({corner(), corner(), corner()});
      occluders.push_back(sheet(triangles.back()));
    }
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const Vec3 p{-2 + 4 * (i + 0.5) / n, -2 + 4 * (j + 0.5) / n, 2};
        const double square = dot(p, p);
        bool seen = true;
        for (const Loop& t : triangles) seen = seen && !blocked(p, t);
        if (seen) sum += p.z * p.z / (square * square) * (16.0 / (n * n)) / std::numbers::pi;
      }
    }
    EXPECT_NEAR(static_cast<double>(form_factor(ceiling(2, -2, -2, 2, 2), occluders)), sum, 5e-4) << "scene " << scene;
  }
}

}  // namespace
}  // namespace exitance
