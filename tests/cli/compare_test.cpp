// exitance compare: who is wrong, where and why.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/cli/program.h"
#include "tests/cli/solution.h"

namespace exitance {
namespace {

using testing::HasSubstr;

class CompareTest : public testing::Test {
 protected:
  nlohmann::json compare(const std::string& against, const std::string& options = "") const {
    const Outcome outcome = run("compare " + scene + " --patch-size 1.5 --json --against " + against + " " + options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  }
  /// The matrix of the scene as `formfactor` makes it.
  std::string matrix(const std::string& name) const {
    const std::string file = (scratch / name).string();
    EXPECT_EQ(run("formfactor " + scene + " --patch-size 1.5 -o " + file).code, 0);
    return file;
  }

  const std::string scene = data("box_on_floor.toml");
  const ScratchFolder scratch;
};

double error(const nlohmann::json& contender, const char* pairs, const char* which) {
  return contender.at("form_factor_errors").at(pairs).at(which);
}

TEST_F(CompareTest, MoreRaysAreLessWrongAndExactFormFactorsAreRight) {
  const auto result = compare("rays:16,rays:1024,rays:1:centre,rays:4096:hemisphere:owen,exact:1e-6");
  const auto& contenders = result.at("contenders");
  ASSERT_EQ(contenders.size(), 5u);
  const auto &few = contenders[0], &many = contenders[1], &centre = contenders[2], &hemisphere = contenders[3],
             &exact = contenders[4];
  EXPECT_EQ(few.at("name"), "rays:16");
  EXPECT_LT(error(many, "facing", "rms"), error(few, "facing", "rms") / 8);
  EXPECT_GT(error(centre, "partial", "rms"), error(few, "partial", "rms"));
  EXPECT_LT(error(exact, "facing", "max"), 1e-6);
  EXPECT_LE(error(few, "facing", "p999"), error(few, "facing", "max"));
  EXPECT_EQ(error(many, "open", "max"), 0) << "weighed against the analytic value";
  EXPECT_GT(error(hemisphere, "open", "max"), 0);
  for (const auto& c : contenders) {
    EXPECT_EQ(error(c, "facing_away", "max"), 0) << c;
    EXPECT_GE(c.at("solution").at("error_worst_1_percent"), c.at("solution").at("error"));
  }
  EXPECT_LT(many.at("solution").at("error"), few.at("solution").at("error"));
  EXPECT_LT(exact.at("solution").at("error"), 1e-5);
  EXPECT_GT(many.at("rays"), 60 * static_cast<double>(few.at("rays")));
  EXPECT_GT(exact.at("queries"), 0);
  EXPECT_LT(many.at("mean_standard_error"), few.at("mean_standard_error"));
  EXPECT_GT(many.at("mean_standard_error"), 0);
  EXPECT_GT(hemisphere.at("mean_standard_error"), 0);
  EXPECT_TRUE(centre.at("mean_standard_error").is_null()) << "one ray has no spread";
  EXPECT_TRUE(exact.at("mean_standard_error").is_null());
  for (const auto& c : {many, hemisphere}) {
    EXPECT_GT(c.at("worst")[0].at("standard_error"), 0);
    EXPECT_LT(c.at("beyond_3_standard_errors"), 0.05);
  }
  for (const auto& c : {centre, exact}) {
    EXPECT_TRUE(c.at("worst")[0].at("standard_error").is_null());
    EXPECT_TRUE(c.at("beyond_3_standard_errors").is_null());
  }
  EXPECT_EQ(few.at("worst").size(), 10u);
  EXPECT_EQ(few.at("worst")[0].at("reason"), "too few rays");
  EXPECT_LE(result.at("truth").at("largest_error"), 1e-10);
  const auto& pairs = result.at("pairs");
  const std::uint64_t n = result.at("patches");
  EXPECT_EQ(pairs.at("facing_away").get<std::uint64_t>() + pairs.at("open").get<std::uint64_t>() +
                pairs.at("blocked").get<std::uint64_t>() + pairs.at("partial").get<std::uint64_t>(),
            n * n);
}

TEST_F(CompareTest, WhatOtherProgramsMadeIsReadAndItsFaultNamed) {
  const std::string right = matrix("right.csv");
  std::istringstream lines(contents(right));
  const std::string wrong = (scratch / "wrong.csv").string();
  std::ofstream out(wrong);
  std::string line;
  bool done = false;
  for (std::getline(lines, line); lines; std::getline(lines, line)) {
    const bool first_entry = !done && line.find("i,j") == std::string::npos;
    if (!first_entry) out << line << '\n';
    done = done || first_entry;  // the first form factor is left out
  }
  out.close();
  const auto result =
      compare(right + "," + wrong + "," + matrix("right.txt"), "-o " + (scratch / "worst.vtp").string());
  EXPECT_LT(error(result.at("contenders")[0], "facing", "max"), 2e-9);
  EXPECT_LT(error(result.at("contenders")[2], "facing", "max"), 2e-9);
  for (const auto& pair : result.at("contenders")[0].at("worst")) {
    const bool is_known =
        std::fabs(pair.at("F").get<double>() - pair.at("truth").get<double>()) > pair.at("truth_error");
    EXPECT_EQ(pair.at("reason") == "none: within the error of the truth", !is_known);
  }
  const auto& worst = result.at("contenders")[1].at("worst")[0];
  EXPECT_EQ(worst.at("F"), 0);
  EXPECT_GT(worst.at("truth"), 1e-3);
  EXPECT_EQ(vtp_array(scratch / "worst.vtp", "rank").front(), 1);
  EXPECT_EQ(vtp_array(scratch / "worst.vtp", "reason").size(), vtp_array(scratch / "worst.vtp", "rank").size());
}

/// A box on a whole floor and one on it. Rays that are not told of contacts run within them, from the bottom of the one
/// through the other.
TEST_F(CompareTest, NamesContactsAndOffsets) {
  const std::string file = (scratch / "stack.toml").string();
  std::ofstream(file) << R"([[material]]
name = "grey"
rho = 0.5
E = 1
[[object]]
material = "grey"
box = {min = [0, 0, 0], max = [3, 3, 3]}
flip = true
[[object]]
material = "grey"
box = {min = [1, 1, 0], max = [2, 2, 1]}
[[object]]
material = "grey"
box = {min = [1.25, 1.25, 1], max = [1.75, 1.75, 1.5]}
)";
  const auto worst = [&](const std::string& against, const std::string& options = "") {
    const Outcome outcome = run("compare " + file + " --tolerance 1e-6 --json --against " + against + " " + options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out).at("contenders")[0].at("worst")[0];
  };
  const auto untold = worst("rays:256:untold");
  EXPECT_EQ(untold.at("truth"), 0);
  EXPECT_GT(untold.at("F"), 0.1);
  EXPECT_EQ(untold.at("reason"), "contact: something lies on one of them");
  EXPECT_EQ(worst("rays:256").at("reason"), "too few rays");
  EXPECT_EQ(worst("rays:256", "--ray-offset 0").at("reason"), "self-intersection: nothing stands between");
}

TEST_F(CompareTest, FormFactorsThatMakeNoSystemAreNoFailure) {
  const std::string file = (scratch / "huge.csv").string();
  std::ofstream(file) << "i,j,F\n0,5,3\n";
  const auto result = compare(file);
  EXPECT_THAT(result.at("contenders")[0].at("why_no_solution"), HasSubstr("form factors"));
  EXPECT_TRUE(result.at("contenders")[0].at("solution").is_null());
  EXPECT_NEAR(result.at("contenders")[0].at("worst")[0].at("F"), 3, 0);
}

TEST_F(CompareTest, AReferenceCountsMeshingToo) {
  const std::string folder = (scratch / "fine").string();
  ASSERT_EQ(run("solve " + scene + " --patch-size 0.5 -o " + folder).code, 0);
  const auto result = compare("rays:1024,rays:1:centre", "--reference " + folder);
  const double meshing = result.at("truth").at("solution_against_reference").at("error");
  EXPECT_GT(meshing, 1e-3);
  EXPECT_NEAR(result.at("contenders")[0].at("solution_against_reference").at("error"), meshing, 0.1 * meshing);
}

TEST_F(CompareTest, AnyNumberOfThreadsGivesTheSameNumbers) {
  const auto one = compare("rays:64,exact:1e-4", "--threads 1"), two = compare("rays:64,exact:1e-4", "--threads 2");
  for (const std::size_t k : {0u, 1u}) {
    for (const char* same : {"form_factor_errors", "solution", "rays", "queries", "worst"})
      EXPECT_EQ(one.at("contenders")[k].at(same), two.at("contenders")[k].at(same));
  }
}

TEST_F(CompareTest, TellsItInWords) {
  const Outcome outcome = run("compare " + scene + " --patch-size 1.5 --against rays:16 --worst 2");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, testing::AllOf(HasSubstr("99.9 %"), HasSubstr(" patches; ordered pairs"),
                                          HasSubstr("rays:16: worst pairs"), HasSubstr("too few rays"),
                                          HasSubstr("truth: exact visibility to 1e-10")));
}

TEST_F(CompareTest, BadInputIsOneLine) {
  const std::string csv = (scratch / "small.csv").string();
  std::ofstream(csv) << "i,j,F\n0,1,0.5\n500,1,0.5\n";
  const std::string text = (scratch / "small.txt").string();
  std::ofstream(text) << "View3D 3.3 0 1 0 2\n1 1\n0 0.5\n0.5 0\n0.5 0.5\n";
  for (const auto& [against, code, says] : {std::tuple{std::string("rays"), 2, "rays"},
                                            {"rays:0", 2, "rays:0"},
                                            {"rays:12:quick", 2, "quick"},
                                            {"exact:-1", 2, "exact:-1"},
                                            {"nonsense", 2, "nonsense"},
                                            {"/nowhere/F.csv", 3, "/nowhere/F.csv"},
                                            {csv, 3, "small.csv"},
                                            {text, 3, "2 rows"}}) {
    const Outcome outcome = run("compare " + scene + " --patch-size 1.5 --against " + against);
    EXPECT_EQ(outcome.code, code) << against;
    EXPECT_TRUE(outcome.one_line_on_stderr()) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(says));
    EXPECT_EQ(outcome.out, "");
  }
  EXPECT_EQ(run("compare " + scene).code, 2);
  EXPECT_EQ(run("compare /nowhere.toml --against rays:4").code, 3);
  EXPECT_EQ(run("compare " + scene + " --against rays:4 --memory-limit 1e-9").code, 4);
}

}  // namespace
}  // namespace exitance
