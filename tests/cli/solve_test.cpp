// exitance solve: right numbers, and the same ones by every route.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/cli/program.h"
#include "tests/cli/solution.h"

namespace exitance {
namespace {

class SolveTest : public testing::Test {
 protected:
  /// Solves into scratch/name, expects the exit code and returns result.json.
  nlohmann::json solve(const std::string& scene, const std::string& options, const std::string& name, int code = 0) {
    const Outcome outcome = run("solve " + scene + " " + options + " -o " + (scratch / name).string());
    EXPECT_EQ(outcome.code, code) << outcome.err;
    return json_in(scratch / name / "result.json");
  }
  std::filesystem::path file(const std::string& name, const std::string& what) const { return scratch / name / what; }

  /// Largest difference of B of two solutions, relative to max B.
  double difference(const std::string& a, const std::string& b) const {
    const std::vector<double> B_a = vtp_array(file(a, "solution.vtp"), "B"),
                              B_b = vtp_array(file(b, "solution.vtp"), "B");
    EXPECT_EQ(B_a.size(), B_b.size());
    double worst = 0, largest = 0;
    for (std::size_t i = 0; i < B_a.size(); ++i) {
      worst = std::max(worst, std::fabs(B_a[i] - B_b[i]));
      largest = std::max(largest, std::fabs(B_a[i]));
    }
    return worst / largest;
  }

  const ScratchFolder scratch;
};

TEST_F(SolveTest, FurnaceIsTwoOnEveryElement) {
  const auto result = solve(data("furnace_cube.toml"), "--patch-size 0.25 --elements 2", "furnace");
  EXPECT_EQ(result.at("patches"), 96);
  EXPECT_EQ(result.at("elements"), 384);
  const std::vector<double> B = vtp_array(file("furnace", "solution.vtp"), "B");
  EXPECT_EQ(B.size(), 384u);
  EXPECT_THAT(B, testing::Each(testing::DoubleNear(2, 1e-12)));
  EXPECT_LT(result.at("closure_max_defect"), 1e-14);
  EXPECT_LT(result.at("energy_balance_defect"), 1e-12);
  // Sixteen squares of each wall see all others and none of their own wall.
  EXPECT_EQ(result.at("pairs").at("open"), 384 * 80);
  EXPECT_EQ(result.at("pairs").at("facing_away"), 384 * 16);
}

/// What is still to be spread, spread evenly, is in a furnace what is missing on average.
TEST_F(SolveTest, EndedEarlyShootingShowsTheAmbientEstimate) {
  const std::string cube = data("furnace_cube.toml"), options = "--patch-size 0.5 --method shoot";
  const auto early = solve(cube, options + " --shots 5", "early", 4);
  const std::vector<double> B = vtp_array(file("early", "solution.vtp"), "B");
  ASSERT_EQ(B.size(), 24u);
  const double mean = std::accumulate(B.begin(), B.end(), 0.0) / 24, ambient = early.at("ambient").at(0);
  EXPECT_LT(mean, 1.9);
  EXPECT_NEAR(mean + 0.5 * ambient, 2, 1e-12);
  EXPECT_TRUE(solve(cube, options, "whole").at("ambient").empty());
}

TEST_F(SolveTest, ClosedCornellBoxIsClosed) {
  const auto result = solve(data("cornell_box_closed.toml"), "--patch-size 0.15", "box");
  EXPECT_LT(result.at("closure_max_defect"), 1e-12);
  EXPECT_TRUE(result.at("converged"));
  EXPECT_LT(result.at("error_bound"), 1e-11);
  EXPECT_GT(result.at("covered_points"), 0);  // beneath the blocks
  EXPECT_EQ(result.at("measured_points"), result.at("elements"));
  EXPECT_EQ(result.at("warnings").size(), 0u);
}

TEST_F(SolveTest, OpenCornellBoxLetsLightEscape) {
  const auto open = solve(data("cornell_box.toml"), "--patch-size 0.2", "open");
  const auto closed = solve(data("cornell_box_closed.toml"), "--patch-size 0.2", "closed");
  EXPECT_TRUE(open.at("closure_max_defect").is_null());
  EXPECT_LT(open.at("B_max"), closed.at("B_max"));
  // Escaped energy is computed by itself; with sample points the balance shows their quadrature, not more.
  EXPECT_LT(open.at("energy_balance_defect"), 0.05);
  EXPECT_LT(closed.at("energy_balance_defect"), 0.05);
}

TEST_F(SolveTest, EveryMethodReachesTheSameAnswer) {
  const std::string scene = data("box_on_floor.toml"), size = "--patch-size 0.6 ";
  const double bound = solve(scene, size, "gather").at("solver_error_bound");
  EXPECT_LE(bound, 1e-12);
  for (const char* method : {"--solver jacobi", "--solver krylov", "--solver direct", "--method shoot",
                             "--method shoot --memory-limit 3e-4"}) {
    const double other = solve(scene, size + method, "other").at("solver_error_bound");
    EXPECT_LE(other, 1e-12) << method;
    EXPECT_LE(difference("gather", "other"), bound + other) << method;
  }
}

TEST_F(SolveTest, ReceiversMayBeWholeElements) {
  const auto furnace = solve(data("furnace_cube.toml"), "--receivers area --elements 2", "furnace");
  EXPECT_EQ(furnace.at("receivers"), "area");
  EXPECT_THAT(vtp_array(file("furnace", "solution.vtp"), "B"), testing::Each(testing::DoubleNear(2, 1e-12)));
  EXPECT_LT(furnace.at("closure_max_defect"), 1e-13);
  EXPECT_LT(furnace.at("energy_balance_defect"), 1e-12);

  const std::string scene = data("box_on_floor.toml"), size = "--patch-size 1 --receivers area ";
  const auto gathered = solve(scene, size, "gather");
  EXPECT_GT(gathered.at("pairs").at("partial"), 0);
  EXPECT_LT(gathered.at("closure_max_defect"), 1e-7);
  EXPECT_LT(gathered.at("reciprocity_max_defect"), 1e-8);
  EXPECT_LT(gathered.at("energy_balance_defect"), 1e-7);
  solve(scene, size + "--method shoot", "shoot");
  EXPECT_LE(difference("gather", "shoot"), 2e-12);
  // Averages and sample points are different discretisations of one problem.
  solve(scene, "--patch-size 1", "points");
  EXPECT_GT(difference("gather", "points"), 1e-4);
  EXPECT_LT(difference("gather", "points"), 0.1);
}

TEST_F(SolveTest, AnyNumberOfThreadsGivesTheSameBits) {
  for (const char* method :
       {"gather", "gather --receivers area --form-factor-tolerance 1e-4", "shoot", "shoot --memory-limit 1e-4",
        "gather --visibility rays --rays 16", "gather --visibility rays --rays 64 --estimator hemisphere"}) {
    const std::string options = std::string("--patch-size 0.2 --method ") + method + " --threads ";
    auto one = solve(data("cornell_box_closed.toml"), options + "1", "one");
    auto two = solve(data("cornell_box_closed.toml"), options + "2", "two");
    for (const char* varies : {"seconds", "peak_memory_bytes", "manifest"}) {
      one.erase(varies);
      two.erase(varies);
    }
    EXPECT_EQ(one, two) << method;
    for (const char* name : {"solution.vtp", "solution.ply", "image.png"}) {
      EXPECT_EQ(contents(file("one", name)), contents(file("two", name))) << method << " " << name;
    }
  }
}

TEST_F(SolveTest, RaysComeNearAndSayWhatTheyAre) {
  const std::string scene = data("cornell_box_closed.toml"), size = "--patch-size 0.3 ";
  const auto exact = solve(scene, size, "exact");
  EXPECT_TRUE(exact.at("rays").is_null());
  double previous = 0.1;
  for (const int n : {4, 1024}) {
    const auto rays = solve(scene, size + "--visibility rays --seed 5 --rays " + std::to_string(n), "rays");
    EXPECT_EQ(rays.at("visibility"), "rays");
    const auto& of = rays.at("rays");
    EXPECT_EQ(of.at("sampler"), "sobol");
    EXPECT_EQ(of.at("estimator"), "kernel");
    EXPECT_EQ(of.at("rays"), n);
    EXPECT_EQ(of.at("seed"), 5);
    EXPECT_GT(of.at("cast"), 100 * n);
    EXPECT_GT(of.at("mean_standard_error"), 0);
    const double apart = difference("exact", "rays");
    EXPECT_LT(apart, previous);
    EXPECT_GT(apart, 0);
    previous = apart / 4;
  }
  const auto hemisphere =
      solve(scene, size + "--visibility rays --rays 16384 --estimator hemisphere --sampler owen", "hemisphere");
  EXPECT_EQ(hemisphere.at("closure_max_defect"), 0) << "no ray leaked";
  EXPECT_LT(difference("exact", "hemisphere"), 0.01);
  const auto centre = solve(scene, size + "--visibility rays --estimator centre", "centre");
  EXPECT_TRUE(centre.at("rays").at("mean_standard_error").is_null());
  EXPECT_GT(difference("exact", "centre"), difference("exact", "rays"));
  solve(scene, size + "--visibility rays --rays 64 --receivers area", "area");
  solve(scene, size + "--visibility rays --rays 64 --method shoot --memory-limit 5e-5", "shot");
  solve(scene, size + "--visibility rays --rays 64", "gathered");
  EXPECT_LT(difference("gathered", "shot"), 2e-12) << "the same rays";
}

TEST_F(SolveTest, OptionsOfRaysNeedRays) {
  const Outcome outcome = run("solve " + data("furnace_cube.toml") + " --rays 64");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_TRUE(outcome.one_line_on_stderr()) << outcome.err;
  EXPECT_THAT(outcome.err, testing::HasSubstr("--visibility rays"));
}

TEST_F(SolveTest, RefusesAMatrixThatDoesNotFit) {
  const Outcome outcome = run("solve " + data("furnace_cube.toml") + " --patch-size 0.1 --memory-limit 0.001 -o " +
                              (scratch / "big").string());
  EXPECT_EQ(outcome.code, 4);
  EXPECT_TRUE(outcome.one_line_on_stderr()) << outcome.err;
  EXPECT_THAT(outcome.err, testing::AllOf(testing::HasSubstr("600 elements"), testing::HasSubstr("0.001 GiB"),
                                          testing::HasSubstr("--method shoot")));
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(scratch.files(), 0u);
}

TEST_F(SolveTest, SavesWhatALimitOfShotsLeaves) {
  const auto result = solve(data("cornell_box_closed.toml"), "--patch-size 0.3 --method shoot --shots 3", "part", 4);
  EXPECT_FALSE(result.at("converged"));
  EXPECT_EQ(result.at("iterations"), 3);
  EXPECT_TRUE(result.at("energy_balance_defect").is_null());
  EXPECT_LT(result.at("closure_max_defect"), 1e-12);
  for (const char* name : {"solution.vtp", "solution.ply", "image.png"}) EXPECT_TRUE(exists(file("part", name)));
  // The bound is honest: the whole solution lies within it.
  solve(data("cornell_box_closed.toml"), "--patch-size 0.3", "whole");
  EXPECT_LE(difference("part", "whole"), result.at("error_bound"));
}

TEST_F(SolveTest, SavesWhatIsThereWhenTimeIsUpOrInterrupted) {
  const auto timed = solve(data("furnace_cube.toml"), "--method shoot --time-limit 1e-6", "timed", 4);
  EXPECT_EQ(timed.at("iterations"), 0);
  const std::string room = (scratch / "room.obj").string();
  ASSERT_EQ(run("generate furnished-room --polygons 4000 -o " + room).code, 0);
  const std::string solve_room =
      "solve " + room + " --method shoot --memory-limit 0.1 -o " + (scratch / "room").string();
  const Outcome interrupted =
      run(solve_room, "timeout --foreground --preserve-status -s INT 8");  // well into its shots
  EXPECT_EQ(interrupted.code, 4) << interrupted.err;
  EXPECT_FALSE(json_in(file("room", "result.json")).at("converged"));
}

TEST_F(SolveTest, PrintsNothingButResults) {
  const Outcome json = run("solve " + data("furnace_cube.toml") + " --json");
  EXPECT_EQ(json.code, 0);
  EXPECT_EQ(json.err, "");
  EXPECT_NEAR(nlohmann::json::parse(json.out).at("B_max"), 2, 1e-12);
  const Outcome words = run("solve " + data("furnace_cube.toml"));
  EXPECT_THAT(words.out, testing::HasSubstr("closure defect"));
  EXPECT_EQ(words.err, "");
}

TEST_F(SolveTest, FailsTheCheckWhenTheToleranceIsOutOfReach) {
  const auto result = solve(data("furnace_cube.toml"), "--tolerance 1e-30", "furnace", 1);
  EXPECT_FALSE(result.at("converged"));
}

}  // namespace
}  // namespace exitance
