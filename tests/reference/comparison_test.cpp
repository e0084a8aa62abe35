// Equation 7 on meshes small enough to be worked out by hand, also turned in space.

#include "src/reference/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "src/scene/input_error.h"

namespace exitance {
namespace {

/// A rotation without zeros, by which nothing may change.
Vec3 turned(const Vec3& p) {
  const double s = 1.0 / 7;
  return Vec3{0.1, 0.2, 0.3} + (p.x * s) * Vec3{2, 3, 6} + (p.y * s) * Vec3{-6, -2, 3} + (p.z * s) * Vec3{3, -6, 2};
}

/// The unit square cut at the places given along x, with a value for each strip, in one band.
SolutionRecord strips(const std::vector<double>& cuts, const std::vector<double>& values, bool is_turned = false) {
  SolutionRecord record{.source = "strips", .scene = "square", .scene_hash = "square", .unit = "W", .bands = 1};
  PatchMesh& mesh = record.mesh;
  double from = 0;
  for (std::uint32_t k = 0; k < values.size(); ++k) {
    const double to = k < cuts.size() ? cuts[k] : 1;
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (const Vec3& p : {Vec3{from, 0, 0}, Vec3{to, 0, 0}, Vec3{to, 1, 0}, Vec3{from, 1, 0}})
      mesh.points.push_back(is_turned ? turned(p) : p);
    mesh.pieces.push_back({0, first, 4, to - from});
    Patch patch{.piece_first = k, .piece_count = 1, .element_first = k, .element_count = 1};
    patch.area = to - from;
    mesh.patches.push_back(patch);
    Element element;
    element.patch = element.piece_first = k;
    element.piece_count = 1;
    element.area = to - from;
    element.normal = is_turned ? turned({0, 0, 1}) - turned({0, 0, 0}) : Vec3{0, 0, 1};
    mesh.elements.push_back(element);
    from = to;
  }
  record.B = values;
  return record;
}

std::string refusal(const SolutionRecord& a, const SolutionRecord& b) {
  try {
    compare(a, b);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ComparisonTest, OfOneMeshIsEquation7) {
  const Comparison c = compare(strips({0.25}, {2, 4}), strips({0.25}, {2, 5}));
  const double squares = 0.25 * 4 + 0.75 * 16;
  EXPECT_DOUBLE_EQ(c.error, std::sqrt(0.75 / squares));
  EXPECT_DOUBLE_EQ(c.pointwise_error, std::sqrt(0.75 / squares));
  EXPECT_DOUBLE_EQ(c.error_worst_1_percent, 1.0 / 4);
}

TEST(ComparisonTest, OfUnrelatedMeshesTakesTheReferencesMeansOverTheOthersElements) {
  for (const bool is_turned : {false, true}) {
    // Halves 1 and 3 against thirds: means over them are 1, 2 and 3.
    const Comparison c = compare(strips({0.5}, {1, 3}, is_turned), strips({1.0 / 3, 2.0 / 3}, {1, 2, 4}, is_turned));
    EXPECT_NEAR(c.error, std::sqrt((1.0 / 3) / (14.0 / 3)), 1e-14);
    // As functions they also differ by 1 in the middle third.
    EXPECT_NEAR(c.pointwise_error, std::sqrt((2.0 / 3) / 5), 1e-14);
    EXPECT_NEAR(c.error_worst_1_percent, 1.0 / 3, 1e-14);
    EXPECT_NEAR(c.Y_reference[1], 2, 1e-14);
  }
}

TEST(ComparisonTest, TheWorstPercentCountsTheLastElementInPart) {
  const Comparison c = compare(strips({0.004, 0.5}, {1, 1, 1}), strips({0.004, 0.5}, {4, 3, 1}));
  EXPECT_NEAR(c.error_worst_1_percent, std::sqrt((0.004 * 9 + 0.006 * 4) / 0.01), 1e-12);
}

TEST(ComparisonTest, OfSolutionsWithItselfIsZero) {
  const SolutionRecord one = strips({0.1, 0.7}, {1, 2, 3}, true);
  const Comparison c = compare(one, one);
  EXPECT_LT(c.error, 1e-15);
  EXPECT_EQ(c.pointwise_error, 0);
}

TEST(ComparisonTest, LuminanceWeighsThreeBands) {
  SolutionRecord reference = strips({}, {1}), current = strips({}, {1});
  reference.bands = current.bands = 3;
  reference.B = {1, 1, 1};
  current.B = {1, 1, 2};
  EXPECT_NEAR(compare(reference, current).error, 0.0722, 1e-15);
}

TEST(ComparisonTest, ToNothingIsNothingOrInfinite) {
  EXPECT_EQ(compare(strips({}, {0}), strips({0.5}, {0, 0})).error, 0);
  const Comparison c = compare(strips({}, {0}), strips({0.5}, {0, 1}));
  EXPECT_EQ(c.error, std::numeric_limits<double>::infinity());
  EXPECT_EQ(c.error_worst_1_percent, std::numeric_limits<double>::infinity());
}

TEST(ComparisonTest, WhatCannotBeComparedIsRefusedByName) {
  SolutionRecord other = strips({}, {1});
  other.source = "other";
  other.scene_hash = "another";
  EXPECT_THAT(refusal(strips({}, {1}), other), testing::HasSubstr("other: is a solution of another scene"));
  other = strips({}, {1});
  other.bands = 3;
  EXPECT_THAT(refusal(strips({}, {1}), other), testing::HasSubstr("has 3 bands"));
  EXPECT_THAT(refusal(other, other), testing::HasSubstr("does not have all bands of B"));
  other = strips({0.5}, {1, 1});
  const Element first = other.mesh.elements[0];
  other.mesh.elements = {};
  other.mesh.elements.push_back(first);
  other.B.pop_back();
  EXPECT_THAT(refusal(strips({}, {1}), other), testing::HasSubstr("does not cover the surfaces"));
  EXPECT_THAT(refusal(other, strips({}, {1})), testing::HasSubstr("does not cover the surfaces"));
}

TEST(ComparisonTest, ElementsWithoutAreaCountForNothing) {
  const Comparison c = compare(strips({}, {1}), strips({0.5, 0.5}, {1, 100, 2}));
  EXPECT_NEAR(c.error, std::sqrt(0.5), 1e-14);
}

}  // namespace
}  // namespace exitance
