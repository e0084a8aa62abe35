#include "geometry/contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace exitance {
namespace {

Polygon square(Vec3 corner, Vec3 u, Vec3 v) {
  return {{corner, corner + u, corner + u + v, corner + v}, {}};
}

Polygon reversed(Polygon p) {
  std::reverse(p.outer.begin(), p.outer.end());
  return p;
}

TEST(Contact, BoxBottomOnAFloor) {
  const std::vector<Polygon> scene{square({0, 0, 0}, {3, 0, 0}, {0, 3, 0}),
                                   reversed(square({1, 1, 0}, {1, 0, 0}, {0, 1, 0})),
                                   square({2.5, 2.5, 0}, {1, 0, 0}, {0, 1, 0})};
  const auto overlaps = coplanar_overlaps(scene);
  ASSERT_EQ(overlaps.size(), 2u);
  EXPECT_EQ(overlaps[0].a, 0u);
  EXPECT_EQ(overlaps[0].b, 1u);
  EXPECT_EQ(overlaps[0].area, 1);
  EXPECT_FALSE(overlaps[0].same_facing);
  EXPECT_EQ(overlaps[1].b, 2u);
  EXPECT_EQ(overlaps[1].area, 0.25);
  EXPECT_TRUE(overlaps[1].same_facing);
}

TEST(Contact, TouchingIsNoOverlapNorIsAGapOfOneUlp) {
  const std::vector<Polygon> scene{square({0, 0, 1}, {1, 0, 0}, {0, 1, 0}),
                                   square({1, 0, 1}, {1, 0, 0}, {0, 1, 0}),
                                   square({1, 1, 1}, {1, 0, 0}, {0, 1, 0}),
                                   square({0, 0, std::nextafter(1, 2)}, {1, 0, 0}, {0, 1, 0}),
                                   {{{0, 0, 1}, {0.5, 0.5, 1}, {1, 1, 1}}, {}}};
  EXPECT_TRUE(coplanar_overlaps(scene).empty());
}

TEST(Contact, OverlapOfOneUlp) {
  const double less = std::nextafter(1, 0);
  const std::vector<Polygon> scene{square({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                                   {{{less, 0, 0}, {2, 0, 0}, {2, 1, 0}, {less, 1, 0}}, {}}};
  const auto overlaps = coplanar_overlaps(scene);
  ASSERT_EQ(overlaps.size(), 1u);
  EXPECT_EQ(overlaps[0].area, 1 - less);
}

// In the plane x + y + z = 0 with integer coordinates, so planes are exact though no axis is perpendicular to them.
TEST(Contact, TiltedPlanes) {
  const Vec3 u{3, -3, 0}, v{0, 3, -3};
  const std::vector<Polygon> scene{square({0, 0, 0}, u, v),
                                   reversed(square((1. / 3) * (u + v), (1. / 3) * u, (1. / 3) * v)),
                                   square({0, 0, 0}, -u, v)};
  const auto overlaps = coplanar_overlaps(scene);
  ASSERT_EQ(overlaps.size(), 1u);
  EXPECT_EQ(overlaps[0].b, 1u);
  EXPECT_NEAR(overlaps[0].area, norm(cross(u, v)) / 9, 1e-14);
}

// Rounded coordinates of a turned object: faces that share all their vertices are still exactly coplanar.
TEST(Contact, TurnedTriangleOnItself) {
  const Vec3 a{0.1, 0.7, 0.3}, b{1.3, 0.2, 0.9}, c{0.4, 1.1, 1.7};
  const auto overlaps = coplanar_overlaps(std::vector<Polygon>{{{a, b, c}, {}}, {{c, b, a}, {}}});
  ASSERT_EQ(overlaps.size(), 1u);
  EXPECT_FALSE(overlaps[0].same_facing);
  EXPECT_NEAR(overlaps[0].area, norm(cross(b - a, c - a)) / 2, 1e-15);
}

TEST(Contact, PolygonsThatAreNotPlanarMeetAsTheirTriangles) {
  const Polygon bent{{{0, 0, 0}, {2, 0, 0}, {2, 2, 1e-3}, {0, 2, 0}}, {}};
  EXPECT_TRUE(coplanar_overlaps(std::vector<Polygon>{bent, square({1.9, 1.9, 0}, {1, 0, 0}, {0, 1, 0})}).empty());
  const auto overlaps = coplanar_overlaps(std::vector<Polygon>{bent, reversed(bent)});
  ASSERT_EQ(overlaps.size(), 1u);
  EXPECT_NEAR(overlaps[0].area, 4, 1e-5);
}

TEST(Contact, HolesAndConcavePolygonsCountOnlyTheirArea) {
  Polygon frame = square({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  frame.holes.push_back(square({1, 1, 0}, {2, 0, 0}, {0, 2, 0}).outer);
  const auto overlaps = coplanar_overlaps(
      std::vector<Polygon>{frame, square({1, 1, 0}, {2, 0, 0}, {0, 2, 0}), square({0, 0, 0}, {2, 0, 0}, {0, 2, 0})});
  ASSERT_EQ(overlaps.size(), 2u);
  EXPECT_EQ(overlaps[0].b, 2u);
  EXPECT_DOUBLE_EQ(overlaps[0].area, 3);
  EXPECT_EQ(overlaps[1].a, 1u);
  EXPECT_DOUBLE_EQ(overlaps[1].area, 1);
}

TEST(Contact, WithinRoundingWhereAskedFor) {
  constexpr double kNear = 0x1p-47 * 3;
  const double c = std::cos(0.7), s = std::sin(0.7);
  const auto turned = [&](Polygon p) {
    for (Vec3& v : p.outer) {
      const Vec3 q{c * v.x - s * v.y, s * v.x + c * v.y, v.z};
      v = {q.x, c * q.y - s * q.z, s * q.y + c * q.z};
    }
    return p;
  };
  const Polygon floor = square({0, 0, 1}, {3, 0, 0}, {0, 3, 0}),
                bottom = reversed(square({1, 1, 1}, {1, 0, 0}, {0, 1, 0})),
                rug = square({2, 2, 1}, {2, 0, 0}, {0, 0.5, 0}),
                above = square({0, 0, 1 + 1e-12}, {1, 0, 0}, {0, 1, 0}),
                beside = square({3, 0, 1}, {1, 0, 0}, {0, 3, 0});
  std::vector<Polygon> scene;
  for (const Polygon& p : {floor, bottom, rug, above, beside}) scene.push_back(turned(p));
  EXPECT_LT(coplanar_overlaps(scene).size(), 2u) << "where planes must be one exactly";
  const auto overlaps = coplanar_overlaps(scene, kNear);
  ASSERT_EQ(overlaps.size(), 3u);
  EXPECT_EQ(overlaps[0].b, 1u);
  EXPECT_NEAR(overlaps[0].area, 1, 1e-12);
  EXPECT_FALSE(overlaps[0].same_facing);
  EXPECT_EQ(overlaps[1].b, 2u);
  EXPECT_NEAR(overlaps[1].area, 0.5, 1e-12);
  EXPECT_TRUE(overlaps[1].same_facing);
  EXPECT_EQ(overlaps[2].a, 2u);
  EXPECT_EQ(overlaps[2].b, 4u);
  EXPECT_NEAR(overlaps[2].area, 0.5, 1e-12);
}

/// The rounded normals of needles have no digit left. Area in units of the last place: these are halves of triangles of
/// which two corners lie on a line through the origin and the third an ulp beside it.
TEST(Contact, NeedlesHaveAreas) {
  const double ulp = 0x1p-52;
  const Vec3 directions[] = {{1, 0.75, 0.5}, {0.1, 0.7, 0.3}, {1. / 3, 1. / 7, 1. / 11}};
  for (const Vec3& d : directions) {
    const Vec3 end = 2.0 * d, aside = d + Vec3{0, 0, ulp};
    const std::vector<Polygon> scene{{{{0, 0, 0}, end, aside}, {}}, {{{0, 0, 0}, aside, end}, {}}};
    const auto overlaps = coplanar_overlaps(scene);
    ASSERT_EQ(overlaps.size(), 1u);
    EXPECT_FALSE(overlaps[0].same_facing);
    // Half of |end × (aside − d)|, as (aside − d) is exactly what was added, rounded.
    const double height = aside.z - d.z;
    const double area = height * std::hypot(d.x, d.y);
    ASSERT_GT(height, 0);
    EXPECT_NEAR(overlaps[0].area, area, 1e-14 * area);
  }
}

}  // namespace
}  // namespace exitance
