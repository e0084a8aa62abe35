#include "src/scene/cut_out.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "src/scene/placement.h"

namespace exitance {
namespace {

struct Turned {
  const char* name;
  Placement placement;
};

// Where and how the polygons of a case stand: as written, and where nothing is representable any more.
class CutOut : public testing::TestWithParam<Turned> {
 protected:
  static Polygon rectangle(double x0, double y0, double x1, double y1) {
    return {{at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)}, {}};
  }
  static Vec3 at(double x, double y) { return GetParam().placement({x, y, 0}); }
  static double area(const std::vector<Polygon>& polygons) {
    double sum = 0;
    for (const Polygon& p : polygons) {
      EXPECT_EQ(find_defect(p), PolygonDefect::none);
      EXPECT_GT(dot(area_vector(p), normal()), 0);
      sum += norm(area_vector(p));
    }
    return sum;
  }
  static Vec3 normal() { return area_vector(rectangle(0, 0, 1, 1)); }
  static std::optional<std::vector<Polygon>> cut(const std::vector<Polygon>& parts) {
    return cut_out(rectangle(0, 0, 4, 3), parts, 1e-6);
  }
};

TEST_P(CutOut, NothingTakenOutLeavesTheBase) {
  const auto left = cut({});
  ASSERT_TRUE(left && left->size() == 1);
  EXPECT_EQ((*left)[0].outer.size(), 4u);
  EXPECT_NEAR(area(*left), 12, 1e-12);
}

TEST_P(CutOut, WithinIsAHole) {
  const auto left = cut({rectangle(1, 1, 2, 2), rectangle(2.5, 0.5, 3, 2.25)});
  ASSERT_TRUE(left && left->size() == 1);
  EXPECT_EQ((*left)[0].holes.size(), 2u);
  EXPECT_NEAR(area(*left), 12 - 1 - 0.5 * 1.75, 1e-12);
}

TEST_P(CutOut, AlongAnEdgeIsANotch) {
  const Polygon door = rectangle(0.7, 0, 1.7, 2.1);
  const auto left = cut({door});
  ASSERT_TRUE(left && left->size() == 1);
  EXPECT_TRUE((*left)[0].holes.empty());
  EXPECT_EQ((*left)[0].outer.size(), 8u);
  EXPECT_NEAR(area(*left), 12 - 2.1, 1e-12);
  for (const Vec3& p : door.outer) EXPECT_NE(std::ranges::find((*left)[0].outer, p), (*left)[0].outer.end());
}

TEST_P(CutOut, InACornerSharesItsVertex) {
  const auto left = cut({rectangle(0, 0, 1.3, 0.7)});
  ASSERT_TRUE(left && left->size() == 1);
  EXPECT_EQ((*left)[0].outer.size(), 6u);
  EXPECT_NEAR(area(*left), 12 - 1.3 * 0.7, 1e-12);
}

TEST_P(CutOut, AcrossDividesInTwo) {
  const auto left = cut({rectangle(1.1, 0, 1.3, 3)});
  ASSERT_TRUE(left);
  EXPECT_EQ(left->size(), 2u);
  EXPECT_NEAR(area(*left), 12 - 0.6, 1e-12);
}

TEST_P(CutOut, PanesSideBySideAreOneHole) {
  // The second pane is lower than the first: a vertex of each lies on an edge of the other.
  const auto left = cut({rectangle(1, 1, 1.7, 2), rectangle(1.7, 0.9, 2.4, 1.6)});
  ASSERT_TRUE(left && left->size() == 1);
  EXPECT_EQ((*left)[0].holes.size(), 1u);
  EXPECT_NEAR(area(*left), 12 - 0.7 - 0.49, 1e-12);
}

TEST_P(CutOut, FourPanesAroundAVertexAreOneHole) {
  const auto left = cut({rectangle(1, 1, 1.7, 1.9), rectangle(1.7, 1, 2.2, 1.9), rectangle(1, 1.9, 1.7, 2.3),
                         rectangle(1.7, 1.9, 2.2, 2.3)});
  ASSERT_TRUE(left && left->size() == 1);
  EXPECT_EQ((*left)[0].holes.size(), 1u);
  EXPECT_NEAR(area(*left), 12 - 1.2 * 1.3, 1e-12);
}

TEST_P(CutOut, TiledCompletelyLeavesNothing) {
  const auto left = cut({rectangle(0, 0, 1.3, 3), rectangle(1.3, 0, 4, 1.1), rectangle(1.3, 1.1, 4, 3)});
  ASSERT_TRUE(left);
  EXPECT_TRUE(left->empty());
}

TEST_P(CutOut, AnIslandWithinAFrameOfPartsIsLeft) {
  const auto left =
      cut({rectangle(1, 1, 3, 1.3), rectangle(1, 1.7, 3, 2), rectangle(1, 1.3, 1.3, 1.7), rectangle(2.7, 1.3, 3, 1.7)});
  ASSERT_TRUE(left);
  EXPECT_EQ(left->size(), 2u);
  EXPECT_NEAR(area(*left), 12 - 2 * 0.6 - 2 * 0.12, 1e-12);
}

TEST_P(CutOut, WhatDoesNotLieWithinIsRefused) {
  EXPECT_FALSE(cut({rectangle(3, 1, 5, 2)}));                                  // across the boundary
  EXPECT_FALSE(cut({rectangle(3.5, 0, 4.5, 3)}));                              // likewise, along two edges
  EXPECT_FALSE(cut({rectangle(5, 1, 6, 2)}));                                  // outside
  EXPECT_FALSE(cut({rectangle(4, 0, 6, 3)}));                                  // outside, along an edge
  EXPECT_FALSE(cut({rectangle(-1, -1, 5, 4)}));                                // around
  EXPECT_FALSE(cut({rectangle(1, 1, 2, 2), rectangle(1, 1, 2, 2)}));           // twice the same
  EXPECT_FALSE(cut({rectangle(1, 1, 2, 2), rectangle(1.5, 1.5, 3, 2.5)}));     // overlapping
  EXPECT_FALSE(cut({rectangle(1, 1, 3, 2.5), rectangle(1.5, 1.5, 2, 2)}));     // within each other
  EXPECT_FALSE(cut({rectangle(1, 1, 2, 2), rectangle(2, 2, 3, 2.5)}));         // corner to corner
  EXPECT_FALSE(cut({Polygon{{at(2, 0), at(3, 1), at(2, 2), at(1, 1)}, {}}}));  // corner to edge
}

const Turned kTurns[] = {
    {"AsWritten", {}},
    {"Rotated", {.linear = product(rotation({1, 2, 3}, 37), rotation({0, 0, 1}, 11)), .translation = {0.1, -7, 1e3}}},
};

INSTANTIATE_TEST_SUITE_P(Turns, CutOut, testing::ValuesIn(kTurns),
                         [](const auto& turned) { return std::string(turned.param.name); });

}  // namespace
}  // namespace exitance
