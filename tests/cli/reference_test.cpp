// exitance reference and exitance diff.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "src/reference/solution_record.h"
#include "tests/cli/program.h"
#include "tests/cli/solution.h"

namespace exitance {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ReferenceTest : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (scratch_ / name).string(); }
  bool exists(const std::string& name) const { return std::filesystem::exists(scratch_ / name); }
  static nlohmann::json json_of(const Outcome& outcome) { return nlohmann::json::parse(outcome.out); }

  const ScratchFolder scratch_;
};

TEST_F(ReferenceTest, TheFurnaceIsConstantAndSavedWithItsManifest) {
  const std::string command = "reference " + data("furnace_cube.toml") + " --error 1e-6 -o " + path("ref.h5");
  const Outcome outcome = run(command + " --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(json_of(outcome).at("reached"));
  EXPECT_LE(json_of(outcome).at("error").at("total"), 1e-6);
  EXPECT_FALSE(exists("ref.h5.parts"));
  const SolutionRecord record = read_solution(scratch_ / "ref.h5");
  for (const double B : record.B) EXPECT_NEAR(B, 2, 1e-6);
  const auto manifest = nlohmann::json::parse(record.manifest);
  for (const char* key : {"version", "commit", "compiler", "libraries", "scene_hash", "options", "levels", "threads"})
    EXPECT_TRUE(manifest.contains(key)) << key;
  EXPECT_EQ(manifest.at("scene_hash"), record.scene_hash);

  const Outcome again = run(command + " --json");
  EXPECT_EQ(again.code, 0);
  EXPECT_TRUE(json_of(again).at("reused"));
  const Outcome stricter = run("reference " + data("furnace_cube.toml") + " --error 1e-13 --time-limit 0.001 -o " +
                               path("ref.h5"));  // not good enough: begun anew, and ended
  EXPECT_EQ(stricter.code, 4) << stricter.err;
}

TEST_F(ReferenceTest, GoesOnAfterBeingKilledWithTheSameBits) {
  const std::string command = "reference " + data("box_on_floor.toml") + " --error 1.5e-2 --save-every 0 --threads 2 -o ";
  ASSERT_EQ(run(command + path("whole.h5")).code, 0);
  run_and_kill(command + path("killed.h5"), 0.5);
  run_and_kill(command + path("killed.h5"), 1);
  ASSERT_EQ(run("reference " + data("box_on_floor.toml") + " --error 1.5e-2 --threads 1 -o " + path("killed.h5")).code,
            0);
  EXPECT_FALSE(exists("killed.h5.parts")) << "even if it was killed while it removed them";
  const SolutionRecord whole = read_solution(scratch_ / "whole.h5"), killed = read_solution(scratch_ / "killed.h5");
  EXPECT_EQ(whole.B, killed.B);
  EXPECT_EQ(whole.error.total, killed.error.total);
  EXPECT_TRUE(std::ranges::equal(whole.mesh.points, killed.mesh.points));
}

TEST_F(ReferenceTest, WhatAFinishedRunLeftIsRemovedWhatAnotherNeedsIsNot) {
  const std::string scene = "reference " + data("furnace_cube.toml");
  ASSERT_EQ(run(scene + " --error 1e-6 -o " + path("ref.h5")).code, 0);
  // The rows of a stricter run, first as if it went on, then as if it were the finished one's.
  std::filesystem::create_directories(scratch_ / "ref.h5.parts/level-00");
  EXPECT_EQ(run(scene + " --error 1e-6 -o " + path("ref.h5")).code, 0);
  EXPECT_TRUE(exists("ref.h5.parts/level-00"));
  std::ofstream(scratch_ / "ref.h5.parts/finished").flush();
  EXPECT_EQ(run(scene + " --error 1e-6 -o " + path("ref.h5")).code, 0);
  EXPECT_FALSE(exists("ref.h5.parts"));
}

TEST_F(ReferenceTest, LimitsKeepWhatThereIs) {
  const std::string command = "reference " + data("box_on_floor.toml") + " --error 1e-5 -o " + path("box.h5");
  const Outcome small = run(command + " --memory-limit 1e-6");
  EXPECT_EQ(small.code, 4);
  EXPECT_THAT(small.err, AllOf(HasSubstr("of memory"), HasSubstr("may be used")));
  EXPECT_FALSE(exists("box.h5"));
  const Outcome one_level =
      run("reference " + data("box_on_floor.toml") + " --error 1e-3 --memory-limit 0.006 -o " + path("box.h5"));
  EXPECT_EQ(one_level.code, 4);
  EXPECT_THAT(one_level.err, HasSubstr("has the error"));
  EXPECT_GT(read_solution(scratch_ / "box.h5").error.total, 1e-3);
  EXPECT_TRUE(exists("box.h5.parts"));
}

TEST_F(ReferenceTest, DiffComparesFilesWithFolders) {
  const std::string cube = data("furnace_cube.toml");
  ASSERT_EQ(run("reference " + cube + " --error 1e-6 -o " + path("ref.h5")).code, 0);
  ASSERT_EQ(run("solve " + cube + " --patch-size 0.4 -o " + path("solved")).code, 0);
  const Outcome same = run("diff " + path("ref.h5") + " " + path("ref.h5") + " --json");
  ASSERT_EQ(same.code, 0) << same.err;
  EXPECT_LT(json_of(same).at("error"), 1e-15);
  for (const char* other : {"solved", "solved/solution.vtp"}) {
    const Outcome outcome = run("diff " + path("ref.h5") + " " + path(other) + " --json -o " + path("d.vtp"));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const nlohmann::json json = json_of(outcome);
    EXPECT_LT(json.at("error"), 1e-10);
    EXPECT_LT(json.at("error_worst_1_percent"), 1e-10);
    EXPECT_LT(json.at("pointwise_error"), 1e-10);
    EXPECT_EQ(json.at("current").at("elements"), 54);
    EXPECT_EQ(json.at("current").at("error"), nullptr);  // nothing is known of it
    const std::vector<double> Y = vtp_array(scratch_ / "d.vtp", "Y_current");
    EXPECT_EQ(Y.size(), 54u);
    for (const double y : Y) EXPECT_NEAR(y, 2, 1e-10);
  }
  const Outcome words = run("diff " + path("solved") + " " + path("ref.h5"));
  EXPECT_EQ(words.code, 0);
  EXPECT_THAT(words.out, AllOf(HasSubstr("error"), HasSubstr("worst 1 %"), HasSubstr("pointwise")));
}

TEST_F(ReferenceTest, DiffOfMeshesAgreesWithWhatElementsMiss) {
  ASSERT_EQ(run("solve " + data("box_on_floor.toml") + " --patch-size 1.5 -o " + path("coarse")).code, 0);
  ASSERT_EQ(run("solve " + data("box_on_floor.toml") + " --patch-size 0.5 -o " + path("fine")).code, 0);
  const nlohmann::json json = json_of(run("diff " + path("fine") + " " + path("coarse") + " --json"));
  EXPECT_GT(json.at("error"), 1e-3);
  EXPECT_LT(json.at("error"), 0.2);
  EXPECT_GE(json.at("pointwise_error"), json.at("error"));
}

TEST_F(ReferenceTest, WhatCannotBeComparedIsRefusedInOneLine) {
  ASSERT_EQ(run("reference " + data("furnace_cube.toml") + " --error 1e-6 -o " + path("ref.h5")).code, 0);
  ASSERT_EQ(run("solve " + data("box_on_floor.toml") + " --patch-size 1.5 -o " + path("other")).code, 0);
  const Outcome other = run("diff " + path("ref.h5") + " " + path("other"));
  EXPECT_EQ(other.code, 3);
  EXPECT_TRUE(other.one_line_on_stderr());
  EXPECT_THAT(other.err, HasSubstr("another scene"));
  EXPECT_EQ(run("diff " + path("ref.h5") + " " + path("none.h5")).code, 3);
  EXPECT_EQ(run("diff " + path("ref.h5") + " " + path("")).code, 3);
  EXPECT_EQ(run("diff " + path("ref.h5")).code, 2);

  std::ofstream(scratch_ / "other" / "solution.vtp") << "<VTKFile>\n<broken";
  const Outcome broken = run("diff " + path("other") + " " + path("other"));
  EXPECT_EQ(broken.code, 3);
  EXPECT_TRUE(broken.one_line_on_stderr());
  EXPECT_THAT(broken.err, HasSubstr("solution.vtp:"));

  std::string bytes = contents(scratch_ / "ref.h5");
  for (std::size_t k = bytes.size() / 4; k < bytes.size() / 2; ++k) bytes[k] = static_cast<char>(bytes[k] ^ 0x55);
  std::ofstream(scratch_ / "ref.h5", std::ios::binary) << bytes;
  const Outcome damaged = run("diff " + path("ref.h5") + " " + path("ref.h5"));
  EXPECT_EQ(damaged.code, 3);
  EXPECT_THAT(damaged.err, HasSubstr("ref.h5"));
}

TEST_F(ReferenceTest, BadOptionsAreRefused) {
  EXPECT_EQ(run("reference " + data("furnace_cube.toml") + " --error 1e-6").code, 2);
  EXPECT_EQ(run("reference " + data("furnace_cube.toml") + " --error 0 -o " + path("a.h5")).code, 2);
  const Outcome text = run("reference " + data("furnace_cube.toml") + " -o " + path("a.txt"));
  EXPECT_EQ(text.code, 3);
  EXPECT_THAT(text.err, HasSubstr(".h5"));
  EXPECT_EQ(run("reference " + path("none.toml") + " -o " + path("a.h5")).code, 3);
}

}  // namespace
}  // namespace exitance
