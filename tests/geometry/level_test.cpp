// Facets that lie in one plane but for rounding, and what a soup makes of them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string_view>
#include <vector>

#include "geometry/contact.h"
#include "geometry/level_facets.h"
#include "geometry/polygon_soup.h"
#include "geometry/shaft.h"

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
PolygonSoup soup_of(const std::vector<Loop>& loops, Planes planes = Planes::as_written) {
  std::vector<Polygon> polygons;
  for (const Loop& loop : loops) polygons.push_back({loop, {}});
  return PolygonSoup(polygons, {}, {}, 0, planes);
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

// It overlaps the floor by a hair, within which it rises by nothing, and beyond the floor by much more than that.
TEST(Level, IsNoRampThatBeginsOnTheFloor) {
  const Loop floor = rectangle(-2, -2, 2, 2);
  for (const double slope : {1e-8, -1e-8, 1e-10}) {
    const double from = 2 - 1e-7, to = 4, rise = slope * (to - from);
    EXPECT_FALSE(level(floor, {{from, -2, 0}, {to, -2, rise}, {to, 2, rise}, {from, 2, 0}}, kNear)) << slope;
  }
  EXPECT_TRUE(level(floor, rectangle(2 - 1e-7, -2, 4, 2, 0x1p-52), kNear));
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

TEST(Level, OfAnyPairOfPolygons) {
  const auto any_overlap = [](const std::vector<Loop>& loops, double extent) {
    std::vector<Polygon> polygons;
    for (const Loop& loop : loops) polygons.push_back({loop, {}});
    return !coplanar_overlaps(polygons, kLevel * extent).empty();
  };
  const Loop floor = rectangle(-2, -2, 2, 2), wall = {{2, -2, 0}, {2, 2, 0}, {2, 2, 3}, {2, -2, 3}};
  EXPECT_FALSE(any_overlap({floor, wall}, 3));
  EXPECT_TRUE(any_overlap({floor, wall, rectangle(-1, -1, 1, 1, 0x1p-52)}, 3));
  EXPECT_TRUE(any_overlap({floor, rectangle(-1, -1, 1, 1)}, 2));
  EXPECT_FALSE(any_overlap({rectangle(-2, -2, 0, 2), rectangle(0, -2, 2, 2)}, 2));
  EXPECT_FALSE(any_overlap({}, 0));
}

/// Whether polygon 1 counts as in the plane of polygon 0, and that of 0 in that of 1.
bool in_one_plane(const PolygonSoup& soup) {
  const bool there = std::ranges::binary_search(soup.coplanar(0), soup.first_facet(1));
  EXPECT_EQ(std::ranges::binary_search(soup.coplanar(soup.first_facet(1)), 0u), there);
  return there;
}

TEST(Level, CountsAsInOnePlaneWhereASoupSaysSo) {
  const Loop floor = rectangle(-2, -2, 2, 2), rug = rectangle(-1, -1, 1, 1, 0x1p-52);
  EXPECT_FALSE(in_one_plane(soup_of({floor, rug})));
  EXPECT_TRUE(in_one_plane(soup_of({floor, rug}, Planes::rounded)));
  EXPECT_TRUE(in_one_plane(soup_of({floor, turned_over(rug)}, Planes::rounded)));
  EXPECT_FALSE(in_one_plane(soup_of({floor, rectangle(-1, -1, 1, 1, 0x1p-45)}, Planes::rounded)));
  const PolygonSoup soup = soup_of({floor, rug}, Planes::rounded);
  EXPECT_TRUE(soup.covers(1, 0));
  EXPECT_FALSE(soup.covers(0, 1));
}

/// A convex wedge on the floor whose toe, a hair, is level with it; behind that it rises before the floor.
TEST(Level, OfAHairTellsNothingOfTheSolidBehindIt) {
  const std::vector<Vec3> section = {{0, 0, 0}, {5e-14, 0, 1.2e-14}, {1, 0, 0.2}, {1, 0, 0}};
  const auto at = [&](std::size_t k, double y) { return section[k % 4] + Vec3{0, y, 0}; };
  std::vector<Loop> loops{rectangle(-2, -2, 2, 2)};
  for (std::size_t k = 0; k < 4; ++k) loops.push_back({at(k, -1), at(k + 1, -1), at(k + 1, 1), at(k, 1)});
  loops.push_back({at(3, -1), at(2, -1), at(1, -1), at(0, -1)});
  loops.push_back({at(0, 1), at(1, 1), at(2, 1), at(3, 1)});
  const PolygonSoup soup = soup_of(loops, Planes::rounded);
  ASSERT_EQ(soup.shells().size(), 1u);
  ASSERT_TRUE(soup.shells()[0].convex);
  const std::uint32_t toe = soup.first_facet(1);
  ASSERT_TRUE(are_level(soup, toe, 0, soup.level()));
  EXPECT_FALSE(backs(soup, soup.shells()[0], toe, 0, 1));
}

/// Its top is the second face.
std::vector<Loop> box(double size, double low, double high) {
  const double s = size;
  return {
      {{0, 0, low}, {0, s, low}, {s, s, low}, {s, 0, low}},   {{0, 0, high}, {s, 0, high}, {s, s, high}, {0, s, high}},
      {{0, 0, low}, {s, 0, low}, {s, 0, high}, {0, 0, high}}, {{0, s, low}, {0, s, high}, {s, s, high}, {s, s, low}},
      {{0, 0, low}, {0, 0, high}, {0, s, high}, {0, s, low}}, {{s, 0, low}, {s, s, low}, {s, s, high}, {s, 0, high}}};
}

TEST(Level, OfABoxUnderAFloorTellsThatItIsBehind) {
  const std::vector<Loop> under = box(1, -1, 0x1p-52);
  for (const int side : {1, -1}) {
    const Loop floor = rectangle(-2, -2, 2, 2);
    std::vector<Loop> loops{side > 0 ? floor : turned_over(floor)};
    loops.insert(loops.end(), under.begin(), under.end());
    const PolygonSoup soup = soup_of(loops, Planes::rounded);
    ASSERT_EQ(soup.shells().size(), 1u);
    const std::uint32_t top = soup.first_facet(2);
    EXPECT_TRUE(are_level(soup, top, 0, soup.level()));
    EXPECT_TRUE(backs(soup, soup.shells()[0], top, 0, side));
  }
}

/// A patch is level with a box's top and with a later one below, which are not level with each other: that one covers
/// the top, and the box hides none of it.
TEST(Level, OfABoxInAPileTellsThatItIsBehind) {
  const double level = 3 * kLevel;
  std::vector<Loop> loops{turned_over(rectangle(0, 0, 3, 3, 3)), rectangle(0, 0, 2, 2, 1 - 0.8 * level)};
  const std::vector<Loop> solid = box(1.5, 0, 1);
  loops.insert(loops.end(), solid.begin(), solid.end());
  loops.push_back(rectangle(0.5, 0.5, 1, 1, 1 - 1.6 * level));
  const PolygonSoup soup = soup_of(loops, Planes::rounded);
  ASSERT_EQ(soup.shells().size(), 1u);
  const std::uint32_t top = soup.first_facet(3), patch = soup.first_facet(8);
  ASSERT_FALSE(are_level(soup, top, patch, soup.level()));
  ASSERT_TRUE(std::ranges::binary_search(soup.coplanar(top), patch));
  ASSERT_TRUE(soup.covers(patch, top));
  EXPECT_TRUE(backs(soup, soup.shells()[0], top, patch, 1));
  Shaft shaft(soup, {0, {}}, {patch, {}});
  std::vector<std::uint32_t> items;
  EXPECT_EQ(shaft.find_occluders(items), Shaft::Overlap::outside);
}

/// What hides nothing joins no chain and is in none.
TEST(Level, OfUnoccludingFacetsMakesNoChains) {
  const double level = 2 * kLevel;
  std::vector<Polygon> polygons;
  for (const double k : {0.0, 0.8, 1.6}) polygons.push_back({rectangle(-2, -2, 2, 2, k * level), {}});
  for (std::size_t unoccluding = 0; unoccluding < 3; ++unoccluding) {
    std::vector<Role> roles(3, Role::patch);
    roles[unoccluding] = Role::unoccluding;
    const PolygonSoup soup(polygons, roles, {}, 0, Planes::rounded);
    for (std::uint32_t f = 0; f < 3; ++f) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t t = 0; t < 3; ++t) {
        if (t != unoccluding && (t + 1 == f || f + 1 == t)) expected.push_back(t);
      }
      EXPECT_EQ(std::vector(soup.coplanar(f).begin(), soup.coplanar(f).end()), expected) << unoccluding << ' ' << f;
    }
  }
}

}  // namespace
}  // namespace exitance
