#include "src/form_factor/outline.h"

#include <gtest/gtest.h>

#include <array>

namespace exitance {
namespace {

const Vec3 kA{0, 0, 1}, kB{1, 0, 1}, kC{0.3, 1, 1};

Vec3 towards(const Vec3& v) {
  return (1 / norm(v)) * v;
}

/// A stretch of the line from a to b, from one share of it to another, seen from the origin.
SeenEdge stretch(std::uint64_t id, const Vec3& a, const Vec3& b, double from = 0, double to = 1) {
  return {id, a, b, towards(a + from * (b - a)), towards(a + to * (b - a))};
}

TEST(Outline, EdgesInOneLineTakeTurns) {
  const Vec3 rounded = kA + Vec3{0.2, 0x1p-52, 0};
  const std::array here{stretch(1, kA, kB), stretch(2, kB, kC), stretch(3, kC, kA)},
      there{stretch(4, rounded, kB), stretch(2, kB, kC), stretch(3, kC, kA)},
      parallel{stretch(4, kA + Vec3{0, 1e-6, 0}, kB), stretch(2, kB, kC), stretch(3, kC, kA)};
  EXPECT_TRUE(same_lines(here, there));
  EXPECT_TRUE(same_lines(there, here));
  EXPECT_FALSE(same_lines(here, parallel));
}

TEST(Outline, AStretchThatContinuesInAnotherEdgeOfItsLineIsOne) {
  const std::array whole{stretch(1, kA, kB), stretch(2, kB, kC), stretch(3, kC, kA)};
  const std::array continued{stretch(1, kA, kB, 0, 0.7), stretch(4, kA, kB, 0.7, 1), stretch(2, kB, kC),
                             stretch(3, kC, kA)},
      with_gap{stretch(1, kA, kB, 0, 0.7), stretch(4, kA, kB, 0.7001, 1), stretch(2, kB, kC), stretch(3, kC, kA)},
      split{stretch(1, kA, kB, 0, 0.7), stretch(1, kA, kB, 0.7001, 1), stretch(2, kB, kC), stretch(3, kC, kA)};
  EXPECT_TRUE(same_lines(whole, continued));
  EXPECT_FALSE(same_lines(whole, with_gap));
  EXPECT_FALSE(same_lines(whole, split));
}

/// As seen from a point on an event: what is seen on either side of a vertex touches there.
TEST(Outline, StretchesBetweenPartsThatOnlyTouchAreNotOne) {
  const Vec3 vertex = kA + 0.7 * (kB - kA), beside{0.5, 0.1, 1};
  const std::array whole{stretch(1, kA, kB), stretch(2, kB, kC), stretch(3, kC, kA), stretch(5, vertex, beside),
                         stretch(6, beside, vertex)};
  for (const std::uint64_t other : {1, 4}) {
    const std::array parts{stretch(1, kA, kB, 0, 0.7),  stretch(5, vertex, beside), stretch(6, beside, vertex),
                           stretch(other, kA, kB, 0.7), stretch(2, kB, kC),         stretch(3, kC, kA)};
    EXPECT_FALSE(same_lines(whole, parts));
    EXPECT_FALSE(same_lines(parts, whole));
  }
}

TEST(Outline, AStretchWithoutLengthDoesNotCount) {
  const std::array whole{stretch(1, kA, kB), stretch(2, kB, kC), stretch(3, kC, kA)};
  const std::array with_a_point{stretch(1, kA, kB), stretch(1, kA, kB, 0.4, 0.4), stretch(2, kB, kC),
                                stretch(3, kC, kA)};
  EXPECT_TRUE(same_lines(whole, with_a_point));
}

TEST(Outline, NothingIsNotTheSameAsSomething) {
  const std::array some{stretch(1, kA, kB)};
  EXPECT_FALSE(same_lines(some, {}));
  EXPECT_FALSE(same_lines({}, {}));
}

}  // namespace
}  // namespace exitance
