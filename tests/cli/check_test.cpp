// exitance check and exitance generate.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.h"

namespace exitance {
namespace {

std::vector<std::string> kinds(const nlohmann::json& report) {
  std::vector<std::string> result;
  for (const auto& finding : report.at("findings")) result.push_back(finding.at("kind"));
  return result;
}

TEST(Check, ListsTheContactsOfTheCornellBox) {
  const Outcome outcome = run("check " + data("cornell_box_closed.toml") + " --json");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "");
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(report.at("closed"));
  EXPECT_EQ(report.at("surfaces"), 19);
  for (const auto& finding : report.at("findings")) {
    if (finding.at("kind") != "overlap_against") continue;
    EXPECT_EQ(finding.at("count"), 2);
    // The bottoms of both blocks, by the shoelace formula on the published coordinates.
    EXPECT_NEAR(finding.at("amount"), 0.0276330 + 0.0276265, 1e-9);
  }
  EXPECT_THAT(kinds(report), testing::Contains("overlap_against"));
  EXPECT_FALSE(nlohmann::json::parse(run("check " + data("cornell_box.toml") + " --json").out).at("closed"));
}

TEST(Check, EndsWithThreeOnErrorsAndNamesTheirPlace) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "bad.obj") << "v 0 0 0\nv 1 0 0\nv 0 nan 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n";
  const std::string scene = (scratch / "bad.obj").string();
  const Outcome words = run("check " + scene);
  EXPECT_EQ(words.code, 3);
  EXPECT_THAT(words.out, testing::HasSubstr("bad.obj:5"));
  EXPECT_EQ(words.err, "");
  const Outcome json = run("check --json " + scene);
  EXPECT_EQ(json.code, 3);
  EXPECT_THAT(kinds(nlohmann::json::parse(json.out)), testing::IsSupersetOf({"non_finite", "no_emitter"}));
}

TEST(Generate, TheSameSeedGivesTheSameClosedRoom) {
  const ScratchFolder scratch;
  const auto make = [&](const char* name, const char* seed) {
    const auto file = scratch / name;
    EXPECT_EQ(run(std::string("generate furnished-room --polygons 500 --seed ") + seed + " -o " + file.string()).code,
              0);
    return contents(file);
  };
  const std::string first = make("a.obj", "7");
  EXPECT_EQ(make("a.obj", "7"), first);
  EXPECT_NE(make("b.obj", "8"), first);
  const auto report = nlohmann::json::parse(run("check --json " + (scratch / "a.obj").string()).out);
  EXPECT_EQ(report.at("surfaces"), 500);
  EXPECT_TRUE(report.at("closed"));
}

}  // namespace
}  // namespace exitance
