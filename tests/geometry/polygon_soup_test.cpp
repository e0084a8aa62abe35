#include "geometry/polygon_soup.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "tests/geometry/solids.h"

namespace exitance {
namespace {

PolygonSoup soup_of(std::vector<Faces> solids, bool turn) {
  std::vector<Polygon> polygons;
  for (Faces& faces : solids) {
    for (Polygon& face : faces) {
      if (turn) std::ranges::transform(face.outer, face.outer.begin(), turned);
      polygons.push_back(face);
    }
  }
  return PolygonSoup(polygons);
}

/// A box whose first corner is given, of edges of length 2.
Faces cube_at(int x, int y, int z) {
  return prism({{x, y}, {x + 2, y}, {x + 2, y + 2}, {x, y + 2}}, z, z + 2);
}

class Touching : public testing::TestWithParam<bool> {};

void expect_apart(const PolygonSoup& soup, std::uint32_t faces_of_each) {
  ASSERT_EQ(soup.shells().size(), 2u);
  for (std::uint32_t s = 0; s < 2; ++s) {
    for (const std::uint32_t f : soup.shells()[s].facets) {
      EXPECT_EQ(soup.facets()[f].polygon / faces_of_each,
                soup.facets()[soup.shells()[s].facets[0]].polygon / faces_of_each);
      for (const Corner& c : soup.corners(soup.facets()[f])) EXPECT_EQ(soup.facets()[c.neighbour].shell, s);
    }
  }
}

TEST_P(Touching, SolidsAlongAnEdgeAreTwo) {
  expect_apart(soup_of({cube_at(0, 0, 0), cube_at(2, 2, 0)}, GetParam()), 6);
}

TEST_P(Touching, SolidsOverHalfAFaceAreTwo) {
  expect_apart(soup_of({cube_at(0, 0, 0), prism({{0, 0}, {1, 0}, {1, 2}, {0, 2}}, 2, 3)}, GetParam()), 6);
}

TEST_P(Touching, SolidsOverAWholeFaceAreTwo) {
  expect_apart(soup_of({cube_at(0, 0, 0), cube_at(0, 0, 2)}, GetParam()), 6);
}

TEST_P(Touching, ASolidThatIsThereTwiceIsTwo) {
  const PolygonSoup soup = soup_of({cube_at(0, 0, 0), cube_at(0, 0, 0)}, GetParam());
  ASSERT_EQ(soup.shells().size(), 2u);
  EXPECT_EQ(soup.shells()[0].facets.size(), soup.shells()[1].facets.size());
}

/// The room's surface looks in and bounds no solid.
TEST_P(Touching, ASolidInTheCornerOfARoomIsOne) {
  Faces room = prism({{0, 0}, {8, 0}, {8, 8}, {0, 8}}, 0, 8);
  for (Polygon& face : room) std::ranges::reverse(face.outer);
  Faces post = prism({{0, 0}, {2, 0}, {2, 2}, {0, 2}}, 0, 8);
  const PolygonSoup soup = soup_of({room, post}, GetParam());
  ASSERT_EQ(soup.shells().size(), 1u);
  for (const std::uint32_t f : soup.shells()[0].facets) EXPECT_GE(soup.facets()[f].polygon, room.size());
}

INSTANTIATE_TEST_SUITE_P(Placed, Touching, testing::Bool(),
                         [](const auto& place) { return place.param ? "turned" : "exact"; });

TEST(PolygonSoup, WantsARoleAndARankOfEachPolygonOrNone) {
  const Faces cube = cube_at(0, 0, 0);
  const std::vector<Role> roles(cube.size() - 1, Role::patch);
  const std::vector<PolygonSoup::Rank> ranks(cube.size() + 1);
  EXPECT_THROW(PolygonSoup(cube, roles), std::invalid_argument);
  EXPECT_THROW(PolygonSoup(cube, {}, ranks), std::invalid_argument);
}

}  // namespace
}  // namespace exitance
