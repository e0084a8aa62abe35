#include "src/form_factor/pair_sample.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>

#include "src/scene/reader.h"
#include "tests/places.h"

namespace exitance {
namespace {

class PairSampleTest : public testing::Test {
 protected:
  PairRows rows(std::uint32_t first, std::uint32_t last) {
    std::vector<std::uint32_t> numbers(last - first);
    std::iota(numbers.begin(), numbers.end(), first);
    PairStatistics statistics;
    return pair_rows(scene_, numbers, options_, statistics);
  }
  std::uint32_t patches() const { return static_cast<std::uint32_t>(scene_.size()); }
  PairSample sample(std::span<const PairRows> of, std::uint64_t seed = 1) const {
    return sample_pairs(scene_, of, options_, 16, seed);
  }

  const Scene given_ = read_scene(source_file("data/box_on_floor.toml"));
  const PolygonSoup soup_ = make_soup(given_);
  const PatchMesh mesh_ = make_patch_mesh(given_, soup_, {.patch_size = 1});
  const ExchangeScene scene_{soup_, mesh_};
  const PairOptions options_{.tolerance = 1e-9};
};

TEST_F(PairSampleTest, HoldsForTrueRowsAndNoOthers) {
  const std::vector<PairRows> all{rows(0, patches())};
  const PairSample good = sample(all);
  ASSERT_GT(good.reciprocity.size(), 12u);
  ASSERT_EQ(good.reciprocity.size(), good.beyond_unobstructed.size());
  bool any_difference = false;
  for (std::size_t k = 0; k < good.reciprocity.size(); ++k) {
    EXPECT_LT(good.reciprocity[k].i, good.reciprocity[k].j);
    EXPECT_TRUE(good.reciprocity[k].holds());
    EXPECT_LT(good.reciprocity[k].allowed, 5e-9);
    EXPECT_TRUE(good.beyond_unobstructed[k].holds());
    EXPECT_LT(good.beyond_unobstructed[k].amount, 0);
    any_difference = any_difference || good.reciprocity[k].amount > 0;
  }
  EXPECT_TRUE(any_difference);

  std::vector<PairRows> wrong = all;
  for (double& F : wrong[0].F) F += 1e-7;
  for (const PairDefect& defect : sample(wrong).reciprocity) EXPECT_FALSE(defect.holds());
  for (double& F : wrong[0].F) F = 1;
  for (const PairDefect& defect : sample(wrong).beyond_unobstructed) EXPECT_FALSE(defect.holds());
}

TEST_F(PairSampleTest, IsTheSameHoweverTheRowsAreDivided) {
  const std::vector<PairRows> all{rows(0, patches())}, parts{rows(9, patches()), rows(0, 4), rows(4, 9)};
  const PairSample one = sample(all), other = sample(parts);
  ASSERT_EQ(one.reciprocity.size(), other.reciprocity.size());
  bool another = false;
  const PairSample reseeded = sample(all, 2);
  for (std::size_t k = 0; k < one.reciprocity.size(); ++k) {
    EXPECT_EQ(one.reciprocity[k].i, other.reciprocity[k].i);
    EXPECT_EQ(one.reciprocity[k].j, other.reciprocity[k].j);
    EXPECT_EQ(one.reciprocity[k].amount, other.reciprocity[k].amount);
    EXPECT_EQ(one.reciprocity[k].allowed, other.reciprocity[k].allowed);
    another = another || k >= reseeded.reciprocity.size() || one.reciprocity[k].j != reseeded.reciprocity[k].j;
  }
  EXPECT_TRUE(another);
}

TEST_F(PairSampleTest, EndsWhenAsked) {
  const std::vector<PairRows> all{rows(0, patches())};
  PairOptions options = options_;
  options.stop = [] { return true; };
  const PairSample stopped = sample_pairs(scene_, all, options, 16, 1);
  EXPECT_FALSE(stopped.complete);
  EXPECT_TRUE(stopped.reciprocity.empty());
}

TEST_F(PairSampleTest, RowsMayBeAppendedAndAreCountedByClass) {
  const PairRows all = rows(0, patches());
  PairRows joined = rows(0, 20);
  append(joined, rows(20, patches()));
  EXPECT_EQ(joined.row, all.row);
  EXPECT_EQ(joined.row_first, all.row_first);
  EXPECT_EQ(joined.column, all.column);
  EXPECT_EQ(joined.F, all.F);
  EXPECT_EQ(joined.F_error, all.F_error);
  EXPECT_EQ(joined.F_reverse, all.F_reverse);
  EXPECT_EQ(joined.F_reverse_error, all.F_reverse_error);
  EXPECT_EQ(joined.mark, all.mark);

  PairStatistics statistics;
  std::vector<std::uint32_t> numbers(patches());
  std::iota(numbers.begin(), numbers.end(), 0u);
  const std::vector<PairRows> one{pair_rows(scene_, numbers, options_, statistics)};
  EXPECT_EQ(pairs_by_class(one, patches()), statistics.pairs);
  // Of all ordered pairs; those in one row are half of them and the diagonal, on which patches face away.
  const double kept = static_cast<double>(all.column.size());
  EXPECT_NEAR(expected_pair_density(scene_), 2 * kept / (patches() * patches()), 1e-12);
  EXPECT_GE(pair_rows_bytes(patches(), 1), pair_rows_bytes(patches(), 0.5));
  EXPECT_EQ(pair_rows_bytes(std::uint64_t{1} << 40, 1), std::uint64_t{1} << 63);
}

}  // namespace
}  // namespace exitance
