#include "geometry/facets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace exitance {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

Vec3 total_area(const std::vector<Loop>& facets) {
  Vec3 sum;
  for (const Loop& f : facets) sum = sum + area_vector(f);
  return sum;
}

/// Facets by their corners, whichever of them comes first.
std::vector<Loop> from_smallest(std::vector<Loop> facets) {
  const auto before = [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  for (Loop& f : facets) std::rotate(f.begin(), std::min_element(f.begin(), f.end(), before), f.end());
  return facets;
}

TEST(CutIntoFacets, ConvexAndExactlyPlanarStaysWhole) {
  const Loop square{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  EXPECT_THAT(cut_into_facets({square, {}}), ::testing::ElementsAre(square));
  const Loop collinear{{0, 0, 1}, {2, 0, 1}, {4, 0, 1}, {4, 4, 1}, {0, 4, 1}};
  EXPECT_THAT(cut_into_facets({collinear, {}}), ::testing::ElementsAre(collinear));
  const Loop triangle{{0.1, 0.2, 0.3}, {0.7, 0.11, 0.13}, {1e-9, 1e6, 3}};
  EXPECT_THAT(cut_into_facets({triangle, {}}), ::testing::ElementsAre(triangle));
  const Loop tilted{{1e6, 0, 0}, {1e6 + 3, -1, 2}, {1e6 + 4, 3, 0}, {1e6 + 1, 4, -2}};
  EXPECT_THAT(cut_into_facets({tilted, {}}), ::testing::ElementsAre(tilted));
}

TEST(CutIntoFacets, RepeatsAreDropped) {
  const Loop square{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  EXPECT_THAT(cut_into_facets({{{0, 0, 0}, {0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}}, {}}),
              ::testing::ElementsAre(square));
}

TEST(CutIntoFacets, ZeroAreaHasNone) {
  EXPECT_THAT(cut_into_facets({{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {}}), IsEmpty());
  EXPECT_THAT(cut_into_facets({{{3, 3, 3}, {3, 3, 3}, {3, 3, 3}}, {}}), IsEmpty());
}

TEST(CutIntoFacets, NonPlanarQuadrilateralIsCutAlongItsShorterDiagonal) {
  // Diagonals: (0,0,0)–(5,4,1) and (4,0,0)–(0,4,0); the second is shorter.
  Loop quad{{0, 0, 0}, {4, 0, 0}, {5, 4, 1}, {0, 4, 0}};
  for (int first = 0; first < 4; ++first) {
    std::rotate(quad.begin(), quad.begin() + 1, quad.end());
    EXPECT_THAT(from_smallest(cut_into_facets({quad, {}})),
                UnorderedElementsAre(Loop{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, Loop{{0, 4, 0}, {4, 0, 0}, {5, 4, 1}}));
    EXPECT_THAT(from_smallest(cut_into_facets({Loop(quad.rbegin(), quad.rend()), {}})),
                UnorderedElementsAre(Loop{{0, 0, 0}, {0, 4, 0}, {4, 0, 0}}, Loop{{0, 4, 0}, {5, 4, 1}, {4, 0, 0}}));
  }
}

TEST(CutIntoFacets, OfEqualDiagonalsTheOneWithTheSmallestVertexIsTaken) {
  Loop quad{
      {0, 0, 1}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}};  // a saddle; the smallest vertex is (0, 0, 1)... against (0, 1, 0)
  for (int first = 0; first < 4; ++first) {
    std::rotate(quad.begin(), quad.begin() + 1, quad.end());
    EXPECT_THAT(from_smallest(cut_into_facets({quad, {}})),
                UnorderedElementsAre(Loop{{0, 0, 1}, {1, 0, 0}, {1, 1, 1}}, Loop{{0, 0, 1}, {1, 1, 1}, {0, 1, 0}}));
  }
}

TEST(CutIntoFacets, NonPlanarDartIsCutAtItsReflexVertex) {
  // The shorter diagonal runs outside.
  const Loop dart{{0, 0, 0}, {10, 1, 0}, {2, 0, 0.5}, {10, -1, 0}};
  const Loop front(dart.rbegin(), dart.rend());
  EXPECT_THAT(
      from_smallest(cut_into_facets({front, {}})),
      UnorderedElementsAre(Loop{{0, 0, 0}, {10, -1, 0}, {2, 0, 0.5}}, Loop{{0, 0, 0}, {2, 0, 0.5}, {10, 1, 0}}));
}

TEST(CutIntoFacets, OneBitOffThePlaneIsNotPlanar) {
  const double up = std::nextafter(1.0, 2);
  EXPECT_THAT(cut_into_facets({{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {}}), SizeIs(1));
  EXPECT_THAT(cut_into_facets({{{0, 0, 1}, {1, 0, 1}, {1, 1, up}, {0, 1, 1}}, {}}), SizeIs(2));
}

TEST(CutIntoFacets, CutsNonConvexPolygonsAndHoles) {
  const Loop ell{{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {1, 1, 0}, {1, 4, 0}, {0, 4, 0}};
  EXPECT_EQ(total_area(cut_into_facets({ell, {}})), (Vec3{0, 0, 7}));
  EXPECT_THAT(cut_into_facets({ell, {}}), SizeIs(4));
  EXPECT_EQ(total_area(cut_into_facets({{ell.rbegin(), ell.rend()}, {}})), (Vec3{0, 0, -7}));

  const Loop square{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}};
  const Loop hole{{1, 1, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, 0}};
  const Loop other{{7, 7, 0}, {5, 7, 0}, {5, 5, 0}, {7, 5, 0}};
  const auto facets = cut_into_facets({square, {hole, {other.rbegin(), other.rend()}}});
  EXPECT_EQ(total_area(facets), (Vec3{0, 0, 56}));
  EXPECT_THAT(facets, SizeIs(12 + 2 * 2 - 2)) << "a triangulation of n vertices with h holes has n + 2h − 2 triangles";
  for (const Loop& f : facets) EXPECT_GT(area_vector(f).z, 0);
}

TEST(CutIntoFacets, StandsUprightInEveryDirection) {
  const Loop ell{{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {1, 1, 0}, {1, 4, 0}, {0, 4, 0}};
  const Vec3 axes[]{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; ++i) {
    for (const double sign : {1.0, -1.0}) {
      const Vec3 u = axes[(i + 1) % 3], v = sign * axes[(i + 2) % 3];
      Loop loop;
      for (const Vec3& p : ell) loop.push_back(p.x * u + p.y * v);
      EXPECT_EQ(total_area(cut_into_facets({loop, {}})), 7 * cross(u, v));
    }
  }
}

TEST(CutIntoFacets, NonPlanarPolygonsKeepTheirBoundary) {
  // The boundary edges of the facets that are not shared are those of the polygon, once each: area vectors agree.
  std::mt19937_64 random(7);
  for (int round = 0; round < 50; ++round) {
    Loop star;
    for (int i = 0; i < 12; ++i) {
      const double radius = 1 + static_cast<double>(random() % 1000) / 300, angle = 0.5235987755982988 * i;
      star.push_back({radius * std::cos(angle), radius * std::sin(angle), static_cast<double>(random() % 1000) / 2000});
    }
    ASSERT_EQ(find_defect({star, {}}), PolygonDefect::none);
    const auto facets = cut_into_facets({star, {}});
    EXPECT_THAT(facets, SizeIs(10));
    EXPECT_LT(norm(total_area(facets) - area_vector(star)), 1e-13);
    for (const Loop& f : facets) EXPECT_GT(area_vector(f).z, 0);
  }
}

}  // namespace
}  // namespace exitance
