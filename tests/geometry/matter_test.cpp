#include "geometry/matter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>

#include "tests/geometry/solids.h"

namespace exitance {
namespace {

Faces block(std::array<int, 3> low, std::array<int, 3> high) {
  return prism({{low[0], low[1]}, {high[0], low[1]}, {high[0], high[1]}, {low[0], high[1]}}, low[2], high[2]);
}

/// Looks in; any corner may be the first.
Faces turned_over(Faces faces) {
  for (Polygon& face : faces) {
    std::ranges::reverse(face.outer);
    std::ranges::rotate(face.outer, face.outer.begin() + 1);
  }
  return faces;
}

/// How many polygons have what behind them, of solids, surroundings and other rooms.
std::array<std::ptrdiff_t, 3> counts(std::initializer_list<Faces> parts, bool turn = false) {
  Faces all;
  for (const Faces& part : parts) all.insert(all.end(), part.begin(), part.end());
  for (Polygon& face : all) {
    // By 3, 4, 5 without rounding: what lies in one plane does so still.
    for (Vec3& p : face.outer) p = turn ? Vec3{3 * p.x - 4 * p.y, 4 * p.x + 3 * p.y, 5 * p.z} : p;
  }
  const std::vector<Behind> behind = find_matter(all);
  return {std::ranges::count(behind, Behind::solid), std::ranges::count(behind, Behind::surroundings),
          std::ranges::count(behind, Behind::other_room)};
}

using Counts = std::array<std::ptrdiff_t, 3>;

TEST(Matter, IsInSolidsAndAroundRooms) {
  for (const bool turn : {false, true}) {
    EXPECT_EQ(counts({block({0, 0, 0}, {1, 1, 1})}, turn), (Counts{6, 0, 0}));
    EXPECT_EQ(counts({turned_over(block({0, 0, 0}, {9, 9, 9}))}, turn), (Counts{0, 6, 0}));
    EXPECT_EQ(counts({turned_over(block({0, 0, 0}, {9, 9, 9})), block({0, 4, 0}, {3, 9, 2})}, turn), (Counts{6, 6, 0}))
        << "a cupboard in a corner of a room";
    EXPECT_EQ(counts({block({0, 0, 0}, {1, 1, 1}), block({0, 0, 1}, {1, 1, 2})}, turn), (Counts{12, 0, 0}))
        << "a stack of equal boxes";
  }
}

TEST(Matter, IsNotBetweenRoomsThatShareAWall) {
  const Faces left = turned_over(block({0, 0, 0}, {2, 2, 2}));
  for (const bool turn : {false, true}) {
    EXPECT_EQ(counts({left, turned_over(block({2, 0, 0}, {4, 2, 2}))}, turn), (Counts{0, 10, 0})) << "sides of a sheet";
    EXPECT_EQ(counts({left, turned_over(block({2, 1, 0}, {4, 3, 1}))}, turn), (Counts{0, 10, 2})) << "a part of it";
    EXPECT_EQ(counts({left, turned_over(block({2, 2, 0}, {4, 3, 1}))}, turn), (Counts{0, 12, 0})) << "an edge";
    EXPECT_EQ(counts({left, turned_over(block({3, 0, 0}, {4, 2, 2}))}, turn), (Counts{0, 12, 0})) << "apart";
  }
}

TEST(Matter, IsNotInClosedSheets) {
  const Faces outside = block({1, 1, 1}, {2, 2, 2}), room = turned_over(block({0, 0, 0}, {4, 4, 4}));
  for (const bool turn : {false, true}) {
    EXPECT_EQ(counts({outside, turned_over(outside)}, turn), (Counts{0, 0, 0}));
    EXPECT_EQ(counts({room, outside, turned_over(outside), block({3, 3, 0}, {4, 4, 1})}, turn), (Counts{6, 6, 0}));
    EXPECT_EQ(counts({outside, turned_over(block({1, 1, 1}, {2, 2, 3}))}, turn), (Counts{6, 6, 0}))
        << "not the same box: a room with a solid on its floor";
  }
}

}  // namespace
}  // namespace exitance
