// exitance stress.

#include <gtest/gtest.h>

#include "tests/cli/program.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;

TEST(Stress, EndsItsJsonWithTheNumbersThatCount) {
  const Outcome outcome = run("stress --count 87 --seed 5 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json report = Json::parse(outcome.out);
  std::vector<std::string> keys;
  for (const auto& [key, value] : report.items()) keys.push_back(key);
  ASSERT_GE(keys.size(), 4u);
  EXPECT_EQ(std::vector<std::string>(keys.end() - 4, keys.end()),
            (std::vector<std::string>{"questions", "wrong", "worst_value_error", "properties_broken"}));
  EXPECT_EQ(report["questions"], 87);
  EXPECT_EQ(report["wrong"], 0);
  EXPECT_EQ(report["properties_broken"], 0);
  EXPECT_GT(report["worst_value_error"], 0);
  EXPECT_LE(report["worst_value_error"], 1e-13);
}

TEST(Stress, AsksOtherQuestionsOfTheSameScenes) {
  for (const char* kind : {"shafts", "shadows"}) {
    const Outcome outcome = run(std::string("stress --count 12 --family gap,cover --json --question ") + kind);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Json report = Json::parse(outcome.out);
    EXPECT_EQ(report["kind"], kind);
    EXPECT_EQ(report["questions"], 12);
    EXPECT_EQ(report["wrong"], 0);
    EXPECT_TRUE(report["not_judged"].empty());
    EXPECT_GT(report["contenders"]["exact"]["classes"], 12);
  }
}

TEST(Stress, WritesFailuresThatCasesReplays) {
  const ScratchFolder folder;
  const Outcome outcome =
      run("stress --family duplicate --count 60 --contender plain-double,exact -o " + (folder / "out").string());
  EXPECT_EQ(outcome.code, 1) << "plain doubles are wrong";
  const Json report = Json::parse(contents(folder / "out/stress.json"));
  EXPECT_GT(report["contenders"]["plain-double"]["wrong"], 0);
  EXPECT_EQ(report["contenders"]["exact"]["wrong"], 0);
  const auto cases = json_in(folder / "out/failures.json").at("cases");
  ASSERT_FALSE(cases.empty());
  const Outcome replayed = run("cases " + (folder / "out/failures.json").string());
  ASSERT_EQ(replayed.code, 0) << replayed.err;
  const auto results = nlohmann::json::parse(replayed.out).at("results");
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (!cases[k].contains("truth")) continue;
    EXPECT_NEAR(results[k].at("F").get<double>(), cases[k].at("truth").get<double>(), 1e-13);
  }
  EXPECT_TRUE(contents(folder / "out/stress.svg").ends_with("</svg>\n"));
  const std::string csv = contents(folder / "out/stress.csv");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 2 * 6);
}

TEST(Stress, RefusesWhatItDoesNotKnow) {
  for (const char* arguments :
       {"stress --family gaps", "stress --contender exactly", "stress --contender rays:0", "stress --count 0",
        "stress --question shaft", "stress --question shafts --contender rays:16",
        "stress --contender exact,rays:16,exact", "stress --contender exact,rays:16 --against properties"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_TRUE(outcome.one_line_on_stderr()) << outcome.err;
  }
}

TEST(Stress, RefusesWhatItCannotGoOnFrom) {
  const ScratchFolder folder;
  const auto unfinished = folder / "unfinished.json";
  for (const char* text : {"{", "[]", R"({"key":{}})", R"({"key":{"seed":"2"},"done":0,"tallies":[],"found":[]})",
                           R"({"key":{},"done":"all","tallies":[],"found":[]})",
                           R"({"key":{},"done":0,"tallies":[{"questions":1}],"found":[]})"}) {
    std::ofstream(unfinished) << text;
    const Outcome outcome = run("stress --count 1 --family gap -o " + (folder / "").string());
    EXPECT_EQ(outcome.code, 3) << text;
    EXPECT_TRUE(outcome.one_line_on_stderr()) << outcome.err;
    EXPECT_NE(outcome.err.find("unfinished.json"), std::string::npos) << outcome.err;
    EXPECT_EQ(contents(unfinished), text);
  }
}

}  // namespace
}  // namespace exitance
