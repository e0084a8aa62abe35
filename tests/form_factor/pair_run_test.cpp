#include "src/form_factor/pair_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <memory>

#include "src/form_factor/kept_rows.h"
#include "src/scene/reader.h"
#include "tests/output/scratch_folder.h"
#include "tests/places.h"

namespace exitance {
namespace {

class PairRunTest : public testing::Test {
 protected:
  static PairRunOptions stopped_after(int blocks) {
    const auto left = std::make_shared<std::atomic<int>>(blocks);
    return {.pairs = {.tolerance = 1e-6, .stop = [left] { return *left <= 0; }},
            .block_seconds = 0,
            .progress = [left](double, std::string_view) { --*left; }};
  }
  static PairRunOptions whole() { return {.pairs = {.tolerance = 1e-6}}; }

  void expect_same(const PairRun& a, const PairRun& b) const {
    const auto n = static_cast<std::uint32_t>(scene_.size());
    const FormFactorMatrix of_a = matrix_of(a.rows, n), of_b = matrix_of(b.rows, n);
    EXPECT_EQ(of_a.row_first, of_b.row_first);
    EXPECT_EQ(of_a.column, of_b.column);
    EXPECT_EQ(of_a.F, of_b.F);
    EXPECT_EQ(of_a.F_error, of_b.F_error);
    EXPECT_EQ(pairs_by_class(a.rows, n), pairs_by_class(b.rows, n));
  }

  const Scene given_ = read_scene(source_file("data/box_on_floor.toml"));
  const PolygonSoup soup_ = make_soup(given_);
  const PatchMesh mesh_ = make_patch_mesh(given_, soup_, {.patch_size = 1.5});
  const ExchangeScene scene_{soup_, mesh_};
  const ScratchFolder scratch_;
};

TEST_F(PairRunTest, GoesOnWhereItWasStoppedWithTheSameBits) {
  const PairRun whole_run = run_pairs(scene_, whole(), nullptr);
  EXPECT_TRUE(whole_run.complete);
  EXPECT_EQ(whole_run.finished, scene_.size());
  std::uint32_t finished = 0;
  for (int start = 0; start < 3; ++start) {
    Checkpoint checkpoint(scratch_ / "parts", "key");
    const PairRun part = run_pairs(scene_, stopped_after(2), &checkpoint);
    EXPECT_FALSE(part.complete);
    EXPECT_EQ(part.resumed, finished);
    EXPECT_GT(part.finished, finished);
    finished = part.finished;
  }
  Checkpoint checkpoint(scratch_ / "parts", "key");
  const PairRun resumed = run_pairs(scene_, whole(), &checkpoint);
  EXPECT_TRUE(resumed.complete);
  EXPECT_EQ(resumed.resumed, finished);
  EXPECT_EQ(resumed.finished, scene_.size());
  expect_same(resumed, whole_run);
}

/// However long a row takes, or a pair: what ends is its integral.
TEST_F(PairRunTest, EndsWithinARow) {
  for (const int asked : {1, 100, 1000}) {
    PairRunOptions options = whole();
    const auto left = std::make_shared<std::atomic<int>>(asked);
    options.pairs.stop = [left] { return --*left <= 0; };
    const PairRun run = run_pairs(scene_, options, nullptr);
    EXPECT_FALSE(run.complete);
    EXPECT_LT(run.finished, scene_.size());
    // No more is asked than what is there to end: once a pair, an integral, a row and a run.
    EXPECT_GT(*left, -200);
    for (const PairRows& part : run.rows) {
      EXPECT_EQ(part.row_first.size(), part.row.size() + 1);
      PairStatistics statistics;
      const PairRows again = pair_rows(scene_, part.row, whole().pairs, statistics);
      EXPECT_EQ(part.column, again.column);
      EXPECT_EQ(part.F, again.F);
    }
  }
}

TEST_F(PairRunTest, ComputesRowsAgainWhosePartIsGone) {
  {
    Checkpoint checkpoint(scratch_ / "parts", "key");
    run_pairs(scene_, stopped_after(6), &checkpoint);
  }
  std::vector<std::filesystem::path> parts;
  for (const auto& entry : std::filesystem::directory_iterator(scratch_ / "parts")) parts.push_back(entry.path());
  std::ranges::sort(parts);
  ASSERT_GE(parts.size(), 2u);
  std::filesystem::remove(parts.front());
  Checkpoint checkpoint(scratch_ / "parts", "key");
  expect_same(run_pairs(scene_, whole(), &checkpoint), run_pairs(scene_, whole(), nullptr));
}

TEST_F(PairRunTest, ReportsOnlyWhatIsSaved) {
  Checkpoint checkpoint(scratch_ / "parts", "key");
  double last = 0;
  PairRunOptions options = whole();
  options.block_seconds = 0;
  options.progress = [&](double fraction, std::string_view) {
    EXPECT_GT(fraction, last);
    last = fraction;
    double pairs = 0;
    const auto n = static_cast<double>(scene_.size());
    for (const PairRows& part : kept_pairs(checkpoint)) {
      for (const std::uint32_t row : part.row) pairs += n - row;
    }
    EXPECT_DOUBLE_EQ(fraction, pairs / (n * (n + 1) / 2));
  };
  run_pairs(scene_, options, &checkpoint);
  EXPECT_EQ(last, 1);
}

}  // namespace
}  // namespace exitance
