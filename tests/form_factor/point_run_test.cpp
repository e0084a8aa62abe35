#include "src/form_factor/point_run.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "src/form_factor/kept_rows.h"
#include "src/scene/reader.h"
#include "src/visibility/exact_visibility.h"
#include "tests/output/damage.h"
#include "tests/places.h"

namespace exitance {
namespace {

class PointRunTest : public testing::Test {
 protected:
  PointRun run(int blocks, Checkpoint* checkpoint) const {
    return run_points(visibility_,
                      {.block_seconds = 0,
                       .stop = [&] { return blocks <= 0; },
                       .progress = [&](double, std::string_view) { --blocks; }},
                      checkpoint);
  }

  static void expect_same(const PointRows& a, const PointRows& b) {
    EXPECT_EQ(a.F.row_first, b.F.row_first);
    EXPECT_EQ(a.F.column, b.F.column);
    EXPECT_EQ(a.F.F, b.F.F);
    EXPECT_EQ(a.F.F_error, b.F.F_error);
    EXPECT_EQ(a.F.columns, b.F.columns);
    EXPECT_EQ(a.statistics.pairs, b.statistics.pairs);
    EXPECT_EQ(a.statistics.covered_points, b.statistics.covered_points);
    EXPECT_EQ(a.statistics.closure_max_defect, b.statistics.closure_max_defect);
  }

  const Scene given_ = read_scene(source_file("data/box_on_floor.toml"));
  const PolygonSoup soup_ = make_soup(given_);
  const PatchMesh mesh_ = make_patch_mesh(given_, soup_, {.patch_size = 1, .elements_per_edge = 6});
  const ExactVisibility visibility_{mesh_, soup_};
  const ScratchFolder scratch_;
};

TEST_F(PointRunTest, GoesOnWhereItWasStoppedWithTheSameBits) {
  const std::size_t n = mesh_.elements.size();
  ASSERT_GT(n, 4 * 256u);
  const PointRows whole = point_rows(visibility_, 0, n);
  std::uint64_t finished = 0;
  for (int start = 0; start < 3; ++start) {
    Checkpoint checkpoint(scratch_ / "parts", "key");
    const PointRun part = run(1, &checkpoint);
    EXPECT_FALSE(part.complete);
    EXPECT_EQ(part.resumed, finished);
    EXPECT_GT(part.rows.F.rows(), finished);
    finished = part.rows.F.rows();
  }
  Checkpoint checkpoint(scratch_ / "parts", "key");
  const PointRun last = run(1000, &checkpoint);
  EXPECT_TRUE(last.complete);
  EXPECT_EQ(last.resumed, finished);
  expect_same(last.rows, whole);
  expect_same(run(1000, nullptr).rows, whole);
  EXPECT_EQ(run(1000, &checkpoint).resumed, n) << "all are kept";
}

TEST_F(PointRunTest, ComputesRowsAgainFromADamagedPartOn) {
  const std::size_t n = mesh_.elements.size();
  std::filesystem::path second;
  {
    Checkpoint checkpoint(scratch_ / "parts", "key", Checkpoint::OtherRun::forgotten);
    EXPECT_FALSE(run(3, &checkpoint).complete);
    ASSERT_EQ(checkpoint.parts().size(), 3u);
    second = checkpoint.parts()[1];
  }
  const std::string bytes = contents(second);
  put(second, flipped(bytes, bytes.size() / 2));
  Checkpoint checkpoint(scratch_ / "parts", "key", Checkpoint::OtherRun::forgotten);
  const PointRun run_again = run(1000, &checkpoint);
  EXPECT_EQ(run_again.resumed, 256u);
  expect_same(run_again.rows, point_rows(visibility_, 0, n));
  EXPECT_EQ(kept_points(checkpoint, run_again.rows.F.columns).F.rows(), n);
}

TEST_F(PointRunTest, SavesTheLastRowsOnlyWhereSomeWereSaved) {
  PointRunOptions seldom{.block_seconds = 1e9};
  Checkpoint checkpoint(scratch_ / "parts", "key");
  EXPECT_TRUE(run_points(visibility_, seldom, &checkpoint).complete);
  EXPECT_TRUE(checkpoint.parts().empty());
  EXPECT_FALSE(run(1, &checkpoint).complete);
  EXPECT_TRUE(run_points(visibility_, seldom, &checkpoint).complete);
  EXPECT_EQ(kept_points(checkpoint, 0).F.rows(), mesh_.elements.size());
}

}  // namespace
}  // namespace exitance
