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

// Three faces of a room and the other three combined, a window in one of them.
constexpr std::string_view kRoom =
    "T Room\nF 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\nV 5 0 0 1\nV 6 1 0 1\nV 7 1 1 1\nV 8 0 1 1\n"
    "V 9 .25 0 .25\nV 10 .75 0 .25\nV 11 .75 0 .75\nV 12 .25 0 .75\n"
    "S 1 1 2 3 4 0 0 .5 floor\nS 2 5 8 7 6 0 0 .5 ceiling\nS 3 1 5 6 2 0 0 .5 wall\nS 4 2 6 7 3 0 0 .5 right\n"
    "S 5 3 7 8 4 0 4 .5 back\nS 6 4 8 5 1 0 4 .5 left\nS 7 9 12 11 10 3 0 .5 window\nEnd\n";

TEST(Check, TakesView3DsScenesAndSoDoesSolve) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "room.vs3") << kRoom;
  const std::string scene = (scratch / "room.vs3").string();
  const auto report = nlohmann::json::parse(run("check --json " + scene).out);
  EXPECT_EQ(report.at("scene"), "Room");
  EXPECT_TRUE(report.at("closed"));
  EXPECT_EQ(report.at("bands"), 1);
  EXPECT_THAT(kinds(report), testing::ElementsAre("no_emitter"));
  const Outcome solved = run("solve --json " + scene);
  EXPECT_EQ(solved.code, 0);
  EXPECT_EQ(nlohmann::json::parse(solved.out).at("patches"), 7);
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
