#include "src/scene/boundary_rings.h"

#include <gtest/gtest.h>

#include "tests/geometry/solids.h"

namespace exitance {
namespace {

std::vector<BoundaryRing> rings_of(const Faces& faces) {
  return find_boundary_rings(faces, std::vector<std::uint32_t>(faces.size(), 0));
}

TEST(BoundaryRings, ClosedSolidsHaveNone) {
  EXPECT_TRUE(rings_of(prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0, 1)).empty());
  EXPECT_TRUE(rings_of(ring(1, 2, 0, 1)).empty()) << "nor has one with a hole through it";
}

TEST(BoundaryRings, AMissingFaceLeavesOne) {
  Faces faces = prism({{0, 0}, {3, 0}, {3, 2}, {0, 2}}, 0, 1);
  faces.erase(faces.begin());
  const auto rings = rings_of(faces);
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_EQ(rings[0].edges, 4u);
  EXPECT_DOUBLE_EQ(rings[0].length, 10);
  faces.erase(faces.begin());  // the top, too: a tube
  EXPECT_EQ(rings_of(faces).size(), 2u);
}

TEST(BoundaryRings, ObjectsAreApart) {
  const Faces faces = prism({{0, 0}, {3, 0}, {3, 2}, {0, 2}}, 0, 1);
  std::vector<std::uint32_t> object(faces.size(), 0);
  object[1] = 1;  // the top by itself
  const auto rings = find_boundary_rings(faces, object);
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_EQ(rings[1].polygon, 1u);
}

TEST(BoundaryRings, NothingIsSaidOfWhatIsNoManifold) {
  const std::vector<Vec3> page{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_TRUE(rings_of({{page, {}}, {page, {}}}).empty()) << "twice the same face";
  EXPECT_TRUE(rings_of({{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}},
                        {{{1, 0, 0}, {0, 0, 0}, {0, -1, 0}}, {}},
                        {{{1, 0, 0}, {0, 0, 0}, {0, 0, 1}}, {}}})
                  .empty())
      << "three pages at one edge";
  Polygon frame{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{{1, 1, 0}, {1, 2, 0}, {2, 1, 0}}}};
  EXPECT_TRUE(rings_of({frame}).empty());
}

}  // namespace
}  // namespace exitance
