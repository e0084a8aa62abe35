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

nlohmann::json closure_of(const std::string& arguments) {
  const Outcome outcome = run("check --json " + arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return nlohmann::json::parse(outcome.out).at("closure");
}

TEST(CheckClosure, LooksFromRandomPointsOfAClosedScene) {
  const ScratchFolder scratch;
  const std::string scene = (scratch / "room.obj").string();
  ASSERT_EQ(run("generate furnished-room --polygons 300 --seed 5 -o " + scene).code, 0);
  const auto closure = closure_of(scene + " --closure 200 --threads 2");
  EXPECT_EQ(closure.at("points"), 200);
  EXPECT_EQ(closure.at("seed"), 1);
  EXPECT_LT(closure.at("max_defect"), 1e-12);
  EXPECT_GT(closure.at("covered_points"), 0);
  EXPECT_LT(closure.at("covered_points"), 100);
  EXPECT_EQ(closure_of(scene + " --closure 200 --threads 1"), closure);
  EXPECT_EQ(closure_of(scene + " --closure 200 --seed 1"), closure);
  // Other points: not as many of them lie in contacts.
  bool differs = false;
  for (const char* seed : {"2", "3", "4"}) {
    differs = differs ||
              closure_of(scene + " --closure 200 --seed " + seed).at("covered_points") != closure.at("covered_points");
  }
  EXPECT_TRUE(differs);
  const Outcome words = run("check " + scene + " --closure 3");
  EXPECT_EQ(words.code, 0);
  EXPECT_THAT(words.out, testing::HasSubstr("at 3 sample points"));
}

TEST(CheckClosure, MeansNothingInAnOpenScene) {
  const std::string scene = data("cornell_box.toml");
  const auto closure = closure_of(scene + " --closure 5");
  EXPECT_EQ(closure.at("points"), 0);
  EXPECT_TRUE(closure.at("max_defect").is_null());
  const Outcome words = run("check " + scene + " --closure 5");
  EXPECT_EQ(words.code, 0);
  EXPECT_THAT(words.out, testing::HasSubstr("closure: without meaning"));
  EXPECT_THAT(run("check " + scene).out, testing::Not(testing::HasSubstr("closure:")));
}

// A shelf most of which lies in the room, so that the scene counts as closed; but its end stands out of the wall, and
// from there the open is seen.
TEST(CheckClosure, EndsWithOneWhereFrontAndBackMissOne) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "shelf.toml") << R"([[material]]
name = "white"
rho = 0.5
E = 1

[[object]]
name = "room"
box = {min = [0, 0, 0], max = [4, 4, 4]}
material = "white"
flip = true

[[object]]
name = "shelf"
material = "white"
polygons = [
  {polygon = [[1, 1, 2], [4, 1, 2], [4, 3, 2], [1, 3, 2]]},
  {polygon = [[4, 1, 2], [5, 1, 2], [5, 3, 2], [4, 3, 2]]},
  {polygon = [[5, 1, 2], [5, 1, 3], [5, 3, 3], [5, 3, 2]]},
]
)";
  const std::string scene = (scratch / "shelf.toml").string();
  const Outcome words = run("check " + scene + " --closure 50");
  EXPECT_EQ(words.code, 1);
  EXPECT_TRUE(words.one_line_on_stderr()) << words.err;
  EXPECT_THAT(words.out, testing::HasSubstr("closed: no light escapes"));
  const Outcome json = run("check --json " + scene + " --closure 50");
  EXPECT_EQ(json.code, 1);
  EXPECT_GT(nlohmann::json::parse(json.out).at("closure").at("max_defect"), 0.1);
}

TEST(CheckClosure, RefusesWhatIsNoNumberOfPoints) {
  const std::string scene = data("box_on_floor.toml");
  for (const char* wrong : {" --closure 0", " --closure -3", " --closure 1.5", " --closure many", " --closure",
                            " --closure 5 --seed x", " --closure 5 --threads 0", " --seed 2", " --threads 2"}) {
    const Outcome outcome = run("check " + scene + wrong);
    EXPECT_EQ(outcome.code, 2) << wrong;
    EXPECT_TRUE(outcome.one_line_on_stderr()) << wrong << ": " << outcome.err;
    EXPECT_EQ(outcome.out, "") << wrong;
  }
}

TEST(CheckClosure, IsNotAskedOfASceneThatCannotBeSolved) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "bad.obj") << "v 0 0 0\nv 1 0 0\nv 0 nan 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n";
  const Outcome outcome = run("check --json --closure 5 " + (scratch / "bad.obj").string());
  EXPECT_EQ(outcome.code, 3);
  EXPECT_FALSE(nlohmann::json::parse(outcome.out).contains("closure"));
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
