// Facets that lie in one plane but for rounding.

#include "geometry/level.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string_view>
#include <vector>

#include "geometry/polygon_soup.h"

namespace exitance {
namespace {

using Loop = std::vector<Vec3>;

Vec3 turned(const Vec3& v, const Vec3& axis, double angle) {  // Rodrigues
  const Vec3 k = normalized(axis);
  return std::cos(angle) * v + std::sin(angle) * cross(k, v) + (1 - std::cos(angle)) * dot(k, v) * k;
}

Loop rectangle(double x0, double y0, double x1, double y1, double z = 0) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}

Loop turned_over(Loop loop) {
  std::ranges::reverse(loop);
  return loop;
}

/// Turned ones are cut into triangles; the first is asked about, unless any is asked for.
PolygonSoup soup_of(const std::vector<Loop>& loops) {
  std::vector<Polygon> polygons;
  for (const Loop& loop : loops) polygons.push_back({loop, {}});
  return PolygonSoup(polygons);
}

/// Whether any facet of one polygon is level with any of the other, asked in both orders, which must agree.
bool level(const Loop& one, const Loop& other, double near) {
  const PolygonSoup soup = soup_of({one, other});
  bool any = false;
  for (std::uint32_t f = soup.first_facet(0); f < soup.first_facet(1); ++f) {
    for (std::uint32_t g = soup.first_facet(1); g < soup.first_facet(2); ++g) {
      const bool are = are_level(soup, f, g, near);
      EXPECT_EQ(are, are_level(soup, g, f, near));
      any = any || are;
    }
  }
  return any;
}

struct Case {
  const char* name;
  Loop one, other;
  bool level = false;
};

std::vector<Case> cases() {
  const Loop floor = rectangle(-2, -2, 2, 2);
  const double ulp = 0x1p-52;
  Loop tilted = rectangle(-1, -1, 1, 1);
  tilted[0].z = tilted[3].z = 1e-9;
  return {
      {"the same", floor, floor, true},
      {"turned over", floor, turned_over(floor), true},
      {"within", floor, rectangle(-1, -1, 1, 1), true},
      {"overhangs", floor, rectangle(1, 1, 3, 3), true},
      {"an ulp over", floor, rectangle(-1, -1, 1, 1, ulp), true},
      {"an ulp under", floor, rectangle(-1, -1, 1, 1, -ulp), true},
      {"as near as may be", floor, rectangle(-1, -1, 1, 1, 0x1p-46), true},
      {"farther", floor, rectangle(-1, -1, 1, 1, 0x1.8p-46), false},
      {"farther below", floor, rectangle(-1, -1, 1, 1, -0x1.8p-46), false},
      {"crosses it at a flat angle", floor, tilted, false},
      {"beside, along an edge", floor, rectangle(2, -2, 4, 2), false},
      {"beside, at a corner", floor, rectangle(2, 2, 4, 4), false},
      {"beside, at a T-junction", floor, rectangle(2, -1, 3, 1), false},
      {"overlaps by rounding", floor, rectangle(2 - 4 * ulp, -2, 4, 2), false},
      {"a hair within", floor, rectangle(-1, 0, 1, 1e-9), true},
      {"apart", floor, rectangle(3, 3, 4, 4), false},
      {"upright on it", floor, {{-1, 0, 0}, {1, 0, 0}, {1, 0, 1}, {-1, 0, 1}}, false},
      {"upright and low", floor, {{-1, 0, 0}, {1, 0, 0}, {1, 0, ulp}, {-1, 0, ulp}}, false},
  };
}

constexpr double kNear = 0x1p-46;  // of scenes of 2 m

TEST(Level, IsWhatOverlapsInOnePlaneButForRounding) {
  for (const Case& c : cases()) {
    EXPECT_EQ(level(c.one, c.other, kNear), c.level) << c.name;
    EXPECT_EQ(level(turned_over(c.one), c.other, kNear), c.level) << c.name;
  }
}

TEST(Level, IsTheSameWhenAllIsTurned) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int turn = 0; turn < 50; ++turn) {
    const Vec3 axis{any(random), any(random), any(random)};
    const double angle = 3 * any(random);
    for (Case& c : cases()) {
      const bool at_the_limit = std::string_view(c.name).find("far") != std::string_view::npos ||
                                std::string_view(c.name).find("near") != std::string_view::npos ||
                                std::string_view(c.name).find("low") != std::string_view::npos;
      if (at_the_limit) continue;
      for (Loop* loop : {&c.one, &c.other}) {
        for (Vec3& v : *loop) v = turned(v, axis, angle);
      }
      EXPECT_EQ(level(c.one, c.other, kNear), c.level) << c.name << ' ' << turn;
    }
  }
}

// The corners of either lie far off the plane of the other, which a hair's breadth does not tell well.
TEST(Level, OfHairsThatCross) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int turn = 0; turn < 50; ++turn) {
    Loop one = rectangle(-1, 0, 1, 1e-6), other = rectangle(0, -1, 1e-6, 1);
    const Vec3 axis{any(random), any(random), any(random)};
    const double angle = 3 * any(random);
    for (Loop* loop : {&one, &other}) {
      for (Vec3& v : *loop) v = turned(v, axis, angle);
    }
    EXPECT_TRUE(level(one, other, kNear)) << turn;
  }
}

TEST(Level, DoesNotDependOnSize) {
  for (const double scale : {0x1p-160, 0x1p-20, 0x1p20, 0x1p160}) {
    for (Case& c : cases()) {
      for (Loop* loop : {&c.one, &c.other}) {
        for (Vec3& v : *loop) v = scale * v;
      }
      EXPECT_EQ(level(c.one, c.other, scale * kNear), c.level) << c.name << ' ' << scale;
    }
  }
}

/// Triangles at an angle of which the fine one shares half of the coarse one's edge, as maps have them far from the
/// origin. Rounding lets them overlap by some ulps there.
TEST(Level, IsNotWhatMeetsAtATJunctionFarFromTheOrigin) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const double offset : {0.0, 1e3, 1e6, 1e7}) {
    for (const double degrees : {1.0, 5.0, 30.0, 50.0}) {
      for (int turn = 0; turn < 50; ++turn) {
        const double size = offset > 1e6 ? 1 : 0.05, rise = std::tan(degrees * std::numbers::pi / 180);
        Loop coarse = {{0, -size, 0}, {0, size, 0}, {-size, 0, 0}};
        Loop fine = {{0, size * any(random) / 2, 0}, {size, size / 2, size * rise}, {0, size, 0}};
        const Vec3 axis{any(random), any(random), any(random)};
        const double angle = 3 * any(random);
        const Vec3 at{offset * any(random), offset * any(random), offset * any(random)};
        double extent = 0;
        for (Loop* loop : {&coarse, &fine}) {
          for (Vec3& v : *loop) {
            v = turned(v, axis, angle) + at;
            extent = std::max({extent, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
          }
        }
        EXPECT_FALSE(level(coarse, fine, 0x1p-47 * extent)) << offset << ' ' << degrees << ' ' << turn;
      }
    }
  }
}

TEST(Level, OfAnyPairOfASoup) {
  const Loop floor = rectangle(-2, -2, 2, 2), wall = {{2, -2, 0}, {2, 2, 0}, {2, 2, 3}, {2, -2, 3}};
  EXPECT_FALSE(any_are_level(soup_of({floor, wall}), kNear));
  EXPECT_TRUE(any_are_level(soup_of({floor, wall, rectangle(-1, -1, 1, 1, 0x1p-52)}), kNear));
  EXPECT_FALSE(any_are_level(soup_of({}), kNear));
}

}  // namespace
}  // namespace exitance
