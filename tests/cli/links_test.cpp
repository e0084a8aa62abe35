// Hierarchical links, as a user runs them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/cli/program.h"
#include "tests/cli/running.h"

namespace exitance {
namespace {

using testing::HasSubstr;

constexpr const char* kCoarse = " --patch-size 1.6 --eps 0.02 --min-area 0.1 ";

TEST(Links, SolveTheFurnaceBetterTheMoreThereAre) {
  const ScratchFolder scratch;
  double before = 1;
  for (const char* eps : {"0.5", "0.1", "0.05"}) {
    const Outcome outcome =
        run("solve " + data("furnace_cube.toml") + " --method hierarchical --min-area 0.004 --eps " + eps + " -o " +
            (scratch / "f").string());
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto result = json_in(scratch / "f" / "result.json");
    EXPECT_EQ(result["method"], "hierarchical");
    EXPECT_EQ(result["patches"], 6);
    EXPECT_LE(result["error_bound"], 1e-8);
    EXPECT_LE(result["closure_max_defect"], 1e-12);
    EXPECT_EQ(result["links"]["shadow"], 0);
    EXPECT_GT(result["links"]["active"], 0);
    const double worst = std::max(result["B_max"].get<double>() - 2, 2 - result["B_min"].get<double>());
    EXPECT_LT(worst, before);
    before = worst / 1.5;
    for (const char* name : {"solution.vtp", "solution.ply", "image.png"})
      EXPECT_TRUE(std::filesystem::exists(scratch / "f" / name));
  }
  EXPECT_LT(before * 1.5, 0.03);
}

TEST(Links, FollowTheEventsThatRedistributionFollows) {
  const ScratchFolder scratch;
  for (const char* method : {"rebuild", "direct", "hvt", "hvt-peu"}) {
    const bool draws = method == std::string("hvt");
    const Outcome outcome = run("dynamic " + data("cube.toml") + kCoarse + "--method " + method +
                                (draws ? " -o " : " --no-images -o ") + (scratch / method).string());
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto frames = json_in(scratch / method / "frames.json");
    ASSERT_EQ(frames.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(frames[k]["frame"], k);
      EXPECT_GT(frames[k]["seconds"], 0.0);
      EXPECT_GT(frames[k]["cpu_seconds"], 0.0);
      for (const char* of : {"form_factors", "visibility", "shafts"}) {
        EXPECT_GT(frames[k]["thread_seconds"][of], 0.0) << of;
        EXPECT_TRUE(std::isfinite(frames[k]["thread_seconds"][of].get<double>())) << of;
      }
      EXPECT_TRUE(std::isfinite(frames[k]["cpu_seconds"].get<double>()));
      EXPECT_GT(frames[k]["links_updated"], 0);
      EXPECT_GT(frames[k]["visibility_tests"], 0);
      EXPECT_LT(frames[k]["error"], method == std::string("hvt-peu") ? 1e-2 : 1e-5);
      EXPECT_LT(frames[k]["error_worst_1_percent"], method == std::string("hvt-peu") ? 0.1 : 1e-4);
      EXPECT_EQ(std::filesystem::exists(scratch / method / ("frame_00" + std::to_string(k) + ".png")), draws);
    }
    EXPECT_EQ(frames[1]["edits"][0], "add cube");
  }
  const auto direct = json_in(scratch / "direct" / "frames.json"), hvt = json_in(scratch / "hvt" / "frames.json");
  for (std::size_t k = 1; k < 4; ++k) {
    for (const char* count : {"E-E", "E-O", "O-O", "active", "shadow", "ghost"})
      EXPECT_EQ(hvt[k]["links"][count], direct[k]["links"][count]) << count;
    EXPECT_EQ(hvt[k]["error"], direct[k]["error"]);
    EXPECT_LT(hvt[k]["links_updated"], direct[k]["links_updated"]);
  }
}

TEST(Links, OfGroupsSpareThoseOfPatches) {
  const ScratchFolder scratch;
  const std::string room = (scratch / "room.obj").string();
  ASSERT_EQ(run("generate furnished-room --polygons 1001 --seed 1 -o " + room).code, 0);
  const Outcome outcome = run("solve " + room + " --method hierarchical --eps 0.02 -o " + (scratch / "r").string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto links = json_in(scratch / "r" / "result.json")["links"];
  EXPECT_EQ(links["clusters"], 2 * json_in(scratch / "r" / "result.json")["patches"].get<int>() - 1);
  EXPECT_GT(links["cluster_links"], 100);
  EXPECT_LT(links["cluster_links"].get<int>() + links["patch_pairs"].get<int>(), 30 * 1001);
}

TEST(Links, OfGroupsLeavePatchesAsTheyAreGiven) {
  const ScratchFolder scratch;
  const auto patches = [&](const std::string& options) {
    const Outcome outcome = run("solve " + data("furnace_cube.toml") + " --method hierarchical --eps 0.5 " + options +
                                " -o " + (scratch / "r").string());
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return json_in(scratch / "r" / "result.json")["patches"].get<int>();
  };
  EXPECT_EQ(patches("--clusters off"), 6);
  EXPECT_EQ(patches("--clusters on --patch-size 0"), 6);
  EXPECT_GT(patches("--clusters on --min-area 0.01"), 6);
}

// What is left as it was bounds how far off B is, but for reflection (rho is 0.8 at most), and is nothing without
// thresholds and interruptions.
TEST(Links, TellWhatTheyLeaveUndone) {
  const ScratchFolder scratch;
  const auto frames_of = [&](const std::string& how) {
    const Outcome outcome =
        run("dynamic " + data("cube.toml") + kCoarse + how + " --no-images -o " + (scratch / "d").string());
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const bool told = outcome.out.find("left undone") != std::string::npos;
    const auto frames = json_in(scratch / "d" / "frames.json");
    EXPECT_EQ(told, std::ranges::any_of(frames, [](const auto& f) { return f["left_undone"] > 0.0; })) << how;
    return frames;
  };
  for (const char* how : {"--method direct", "--method hvt", "--method hvt-peu --b-eps 0"}) {
    for (const auto& frame : frames_of(how)) {
      EXPECT_EQ(frame["left_undone"], 0.0) << how;
      EXPECT_EQ(frame["left_undone_worst_1_percent"], 0.0) << how;
    }
  }
  double before = 0;
  for (const char* b_eps : {"0.002", "0.02"}) {
    const auto frames = frames_of(std::string("--method hvt-peu --b-eps ") + b_eps);
    EXPECT_EQ(frames[0]["left_undone"], 0.0);
    for (std::size_t k = 1; k < 4; ++k) {
      EXPECT_GT(frames[k]["skipped"], 0);
      EXPECT_GT(frames[k]["left_undone"], 0.0);
      EXPECT_LT(frames[k]["error"], 5 * frames[k]["left_undone"].get<double>());
    }
    EXPECT_GT(frames[3]["left_undone"], before);
    before = frames[3]["left_undone"];
  }
  const auto frames = frames_of("--method hvt --budget-ms 0 --work-off");
  EXPECT_GT(frames[1]["left_undone"], 0.0);
  EXPECT_GT(frames[1]["left_undone_worst_1_percent"], 0.0);
  EXPECT_LT(frames[1]["error"], 5 * frames[1]["left_undone"].get<double>());
  EXPECT_EQ(frames[4]["left_undone"], 0.0);
}

TEST(Links, UpdatesAreInterruptedAndGoOn) {
  const ScratchFolder scratch;
  const std::string to = (scratch / "d").string();
  const Outcome outcome =
      run("dynamic " + data("cube.toml") + kCoarse + "--method hvt --no-images --budget-ms 0 --work-off -o " + to);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto frames = json_in(scratch / "d" / "frames.json");
  ASSERT_EQ(frames.size(), 5u);
  EXPECT_GT(frames[1]["pairs_left"], 0);
  EXPECT_GT(frames[1]["error"], 1e-4);
  EXPECT_GT(frames[3]["pairs_left"], 0);
  EXPECT_EQ(frames[4]["edits"][0], "work off");
  EXPECT_EQ(frames[4]["pairs_left"], 0);
  EXPECT_LT(frames[4]["error"], 1e-5);
}

TEST(Links, InterruptedBeforeTheFirstFrameIsDoneLeaveNothing) {
  const ScratchFolder scratch;
  const std::filesystem::path to = scratch / "d", messages = scratch / "messages";
  const std::string command =
      "dynamic " + data("cube.toml") + " --method hvt --eps 1e-4 --min-area 1e-3 -o " + to.string();
  EXPECT_EQ(Running(command, messages.string()).end_when([&] { return exists(to); }, SIGINT), 4);
  EXPECT_EQ(contents(messages), "exitance: stopped before the first frame was done; nothing was saved\n");
  EXPECT_FALSE(exists(to));
}

TEST(Links, WarnOfWhatPassesThroughWalls) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "wall.toml") << "[[material]]\nname = \"m\"\nrho = 0.5\nE = 1\n"
                                          "[[object]]\nname = \"room\"\nbox = {min = [0,0,0], max = [3,3,3]}\n"
                                          "material = \"m\"\nflip = true\n"
                                          "[[object]]\nname = \"cube\"\nbox = {min = [1,1,1], max = [2,2,2]}\n"
                                          "material = \"m\"\n"
                                          "[[event]]\ntime = 1\nobject = \"cube\"\noperation = \"move\"\n"
                                          "translate = [1.5, 0, 0]\n";
  const Outcome outcome = run("dynamic " + (scratch / "wall.toml").string() + " --method hvt --eps 0.5 --min-area 9 " +
                              "--no-images -o " + (scratch / "d").string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("wall.toml:14: object 'cube' passes through 'room'"));
}

TEST(Links, FramesThatAreNotFinishedSaySo) {
  const ScratchFolder scratch;
  const std::string to = std::string(kCoarse) + "--method hvt --no-images -o " + (scratch / "d").string();
  const auto finished = [&](const std::string& how, int code) {
    const Outcome outcome = run("dynamic " + data("cube.toml") + how + to);
    EXPECT_EQ(outcome.code, code) << outcome.err;
    return json_in(scratch / "d" / "frames.json").back()["finished"].get<bool>();
  };
  EXPECT_TRUE(finished("", 0));
  EXPECT_FALSE(finished(" --budget-ms 0", 0)) << "pairs are left";
  EXPECT_FALSE(finished(" --tolerance 1e-300", 0)) << "the exchange of energy does not get there";
  EXPECT_FALSE(finished(" --time-limit 1e-9", 4)) << "links are not refined to the end";
}

TEST(Links, OptionsThatMeanNothingAreRefused) {
  const ScratchFolder scratch;
  const Outcome solved = run("solve " + data("furnace_cube.toml") + " --eps 0.1");
  EXPECT_EQ(solved.code, 2);
  EXPECT_THAT(solved.err, HasSubstr("hierarchical"));
  const std::string to = " -o " + (scratch / "d").string();
  EXPECT_EQ(run("dynamic " + data("cube.toml") + " --method scratch --b-eps 0.1" + to).code, 2);
  EXPECT_EQ(run("dynamic " + data("cube.toml") + " --method hvt --eps 0.1 --eps1 0.2" + to).code, 2);
  EXPECT_EQ(run("solve " + data("furnace_cube.toml") + " --method hierarchical --receivers area").code, 2);
  for (const char* option : {"--solver jacobi", "--form-factor-tolerance 1e-3", "--elements 2", "--shots 3",
                             "--save-every 1", "--eps1 0.01"}) {
    const Outcome refused = run("solve " + data("furnace_cube.toml") + " --method hierarchical " + option);
    EXPECT_EQ(refused.code, 2) << option;
    EXPECT_THAT(refused.err, HasSubstr(std::string(option).substr(0, std::string(option).find(' '))));
  }
  EXPECT_EQ(run("dynamic " + data("cube.toml") + " --method hvt --clusters on" + to).code, 2);
  EXPECT_EQ(run("dynamic " + data("cube.toml") + " --method rebuild --budget-ms 1" + to).code, 2);
  EXPECT_EQ(run("dynamic " + data("cube.toml") + " --method rebuild --eps1 0.001" + to).code, 2);
  EXPECT_EQ(run("dynamic " + data("cube.toml") + " --method hvt --no-images --image-size 9" + to).code, 2);
  std::ofstream(scratch / "bad.toml") << "[links]\neps2 = -1\n[[material]]\nname = \"m\"\nrho = 0.5\n[[object]]\n"
                                         "box = {min = [0,0,0], max = [1,1,1]}\nmaterial = \"m\"\n";
  const Outcome bad = run("solve " + (scratch / "bad.toml").string());
  EXPECT_EQ(bad.code, 3);
  EXPECT_THAT(bad.err, HasSubstr("bad.toml:2: \"eps2\" must not be negative"));
}

}  // namespace
}  // namespace exitance
