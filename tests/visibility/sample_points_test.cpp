#include "src/visibility/sample_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace exitance {
namespace {

constexpr std::array kSamplers = {Sampler::random, Sampler::stratified, Sampler::sobol, Sampler::owen};

template <std::size_t D>
std::vector<std::array<double, D>> all_points(Sampler sampler, std::uint32_t count, std::uint64_t seed) {
  std::vector<std::array<double, D>> points(count);
  SamplePoints<D>(sampler, count).take(seed, 0, points);
  return points;
}

/// How many points the fullest box of a grid over two coordinates holds.
template <class Points>
int fullest_box(const Points& points, std::size_t axis, std::uint32_t columns, std::uint32_t rows) {
  std::vector<int> count(columns * rows);
  for (const auto& p : points) {
    const auto column = static_cast<std::uint32_t>(p[axis] * columns),
               row = static_cast<std::uint32_t>(p[axis + 1] * rows);
    ++count.at(row * columns + column);
  }
  return std::ranges::max(count);
}

TEST(SamplePoints, StrataHoldOnePointEach) {
  EXPECT_EQ(fullest_box(all_points<2>(Sampler::stratified, 256, 1), 0, 16, 16), 1);
  EXPECT_EQ(fullest_box(all_points<2>(Sampler::stratified, 128, 1), 0, 8, 16), 1);
  EXPECT_EQ(fullest_box(all_points<2>(Sampler::stratified, 7, 1), 0, 1, 7), 1);
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const auto points = all_points<4>(Sampler::stratified, 144, seed);
    EXPECT_EQ(fullest_box(points, 0, 12, 12), 1);
    EXPECT_EQ(fullest_box(points, 2, 12, 12), 1);
  }
}

TEST(SamplePoints, SobolPointsAreANetHoweverScrambled) {
  for (const Sampler sampler : {Sampler::sobol, Sampler::owen})
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      const auto points = all_points<2>(sampler, 256, seed);
      for (std::uint32_t columns = 1; columns <= 256; columns *= 2) {
        EXPECT_EQ(fullest_box(points, 0, columns, 256 / columns), 1) << to_string(sampler) << " " << columns;
      }
    }
}

TEST(SamplePoints, PartsAreThoseOfTheWhole) {
  for (const Sampler sampler : kSamplers) {
    const auto whole = all_points<4>(sampler, 100, 5);
    std::vector<std::array<double, 4>> part(30);
    SamplePoints<4>(sampler, 100).take(5, 64, part);
    EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin() + 64)) << to_string(sampler);
  }
}

TEST(SamplePoints, EachIsUniformOverTheSeeds) {
  constexpr int kSeeds = 4000;
  for (const Sampler sampler : kSamplers) {
    const SamplePoints<4> samples(sampler, 16);
    std::array<double, 4> sum{}, square{};
    double product = 0;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      std::array<std::array<double, 4>, 16> points;
      samples.take(seed, 0, points);
      for (std::size_t axis = 0; axis < 4; ++axis) {
        ASSERT_TRUE(points[3][axis] > 0 && points[3][axis] < 1);
        sum[axis] += points[3][axis];
        square[axis] += points[3][axis] * points[3][axis];
      }
      product += (points[3][0] - 0.5) * (points[3][3] - 0.5);
    }
    // A stratified point stays in its cell of the first two coordinates.
    for (std::size_t axis = sampler == Sampler::stratified ? 2 : 0; axis < 4; ++axis) {
      EXPECT_NEAR(sum[axis] / kSeeds, 0.5, 4 / std::sqrt(12.0 * kSeeds)) << to_string(sampler) << axis;
      EXPECT_NEAR(square[axis] / kSeeds, 1.0 / 3, 4 * std::sqrt(4.0 / 45 / kSeeds)) << to_string(sampler) << axis;
    }
    EXPECT_NEAR(product / kSeeds, 0, 4.0 / 12 / std::sqrt(kSeeds)) << to_string(sampler);
  }
}

TEST(SamplePoints, SeedsThatAreNeighboursHaveNothingInCommon) {
  for (const Sampler sampler : kSamplers) {
    const auto a = all_points<2>(sampler, 64, 8), b = all_points<2>(sampler, 64, 9);
    for (const auto& point : a) EXPECT_EQ(std::ranges::count(b, point), 0) << to_string(sampler);
  }
}

}  // namespace
}  // namespace exitance
