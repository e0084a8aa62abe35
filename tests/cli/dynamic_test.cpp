// exitance dynamic, as a user runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/cli/program.h"

namespace exitance {
namespace {

using testing::HasSubstr;

constexpr const char* kQuick = " --patch-size 1.6 --elements 1 --no-images ";

TEST(Dynamic, FramesTellWhatWasDoneAndHowFarItIs) {
  const ScratchFolder scratch;
  const std::string out = (scratch / "d").string();
  for (const char* method : {"scratch", "restart", "redistribute"}) {
    const bool draws = method == std::string("redistribute");
    const Outcome outcome = run("dynamic " + data("cube.toml") + " --patch-size 1.6 --elements 1 --method " + method +
                                (draws ? " --image-size 64 -o " : " --no-images -o ") + out);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto frames = json_in(scratch / "d" / "frames.json");
    ASSERT_EQ(frames.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto& frame = frames[k];
      EXPECT_EQ(frame["frame"], k);
      EXPECT_GE(frame["seconds"], 0.0);
      EXPECT_GT(frame["shots"], 0);
      EXPECT_GT(frame["visibility_tests"], 0);
      EXPECT_LT(frame["error"], 1e-5);
      ASSERT_TRUE(frame["error_worst_1_percent"].is_number()) << "also of an element that is dark then";
      EXPECT_LT(frame["error_worst_1_percent"], 1e-4);
      for (const char* kind : {".png", ".vtp"})
        EXPECT_EQ(std::filesystem::exists(scratch / "d" / ("frame_00" + std::to_string(k) + kind)), draws);
    }
    EXPECT_EQ(frames[1]["edits"][0], "add cube");
  }
}

TEST(Dynamic, BudgetsStopReplaysRepeatAndTheLogIsWorkedOff) {
  const ScratchFolder scratch;
  const auto frames_of = [&](const std::string& options, const char* name) {
    const Outcome outcome = run("dynamic " + data("cube.toml") + kQuick + options + " -o " + (scratch / name).string());
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return json_in(scratch / name / "frames.json");
  };
  const std::string kept = " --references " + (scratch / "kept.h5").string();
  const auto some = frames_of("--budget-shots 7 --work-off" + kept, "a");
  EXPECT_EQ(some[1]["shots"], 7);
  EXPECT_FALSE(some[2]["log"].empty());
  EXPECT_GT(some[2]["error"], 1e-5);
  EXPECT_TRUE(some.back()["log"].empty());
  EXPECT_LT(some.back()["error"], 1e-5);
  const auto with_kept = frames_of("--budget-shots 7 --work-off" + kept, "k");
  for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(with_kept[k]["error"], some[k]["error"]);
  const auto forgot = frames_of("--budget-shots 7 --work-off --no-log" + kept, "f");
  EXPECT_TRUE(forgot.back()["log"].empty());
  EXPECT_GT(forgot.back()["error"], 1e-5) << "what was interrupted is lost";
  EXPECT_TRUE(forgot.front()["error_bound"].is_number());
  EXPECT_TRUE(forgot.back()["error_bound"].is_null());
  EXPECT_TRUE(forgot.back()["finished"]) << "there is nothing left to do";
  EXPECT_LE(some.back()["error_bound"], 1e-6);
  const auto none = frames_of("--budget-ms 0", "b");
  EXPECT_EQ(none[1]["shots"], 0);
  EXPECT_GT(none[1]["redistribution_left"], 0.0);
  EXPECT_EQ(none[1]["log"][0]["energy"], none[1]["redistribution_left"]);
  auto again = frames_of("--work-off --replay " + (scratch / "a" / "frames.json").string() + kept, "c");
  auto as_before = some;
  for (auto* frames : {&again, &as_before}) {
    for (auto& frame : *frames) {
      EXPECT_LE(frame["seconds_edits"], frame["seconds"]);
      frame.erase("seconds");
      frame.erase("seconds_edits");
    }
  }
  EXPECT_EQ(again, as_before) << "the same bits";
  EXPECT_TRUE(again.front()["finished"]);
  EXPECT_TRUE(again.back()["finished"]);
}

TEST(Dynamic, OptionsThatAMethodDoesNotUseAreRefused) {
  const ScratchFolder scratch;
  const auto refused = [&](const std::string& method, const std::string& option) {
    const Outcome outcome =
        run("dynamic " + data("cube.toml") + " --method " + method + " " + option + " -o " + (scratch / "o").string());
    EXPECT_EQ(outcome.code, 2) << method << " " << option;
    EXPECT_THAT(outcome.err, HasSubstr(option.substr(0, option.find(' ')) + ": needs --")) << method;
    EXPECT_FALSE(std::filesystem::exists(scratch / "o"));
  };
  for (const char* option : {"--strategy 1", "--threshold 0.1", "--importance exact", "--importance-points 2",
                             "--object-terms shot", "--no-log", "--eps 0.1", "--b-eps 0.1"})
    refused("scratch", option);
  for (const char* option : {"--importance exact", "--object-terms gathered", "--link-points 2"})
    refused("restart", option);
  for (const char* option : {"--strategy 2", "--object-terms gathered", "--no-log", "--budget-shots 1", "--elements 2",
                             "--references kept.h5", "--replay frames.json", "--b-eps 0.1"}) {
    for (const char* method : {"rebuild", "direct", "hvt"}) refused(method, option);
  }
  refused("rebuild", "--budget-ms 1");
  refused("redistribute", "--min-area 1");
  refused("redistribute --importance exact", "--importance-points 2");
  const std::string out = " -o " + (scratch / "o").string();
  EXPECT_EQ(run("dynamic " + data("cube.toml") + " --no-reference --references kept.h5" + out).code, 2);
  for (const char* method : {"rebuild", "direct"}) {
    const Outcome nothing_left = run("dynamic " + data("cube.toml") + " --patch-size 2 --eps 0.5 --min-area 9 " +
                                     "--no-images --work-off --method " + method + out);
    EXPECT_EQ(nothing_left.code, 0) << nothing_left.err;
    EXPECT_EQ(json_in(scratch / "o" / "frames.json").size(), 4u) << "no frame more";
  }
}

TEST(Dynamic, BadInputAndLimits) {
  const ScratchFolder scratch;
  const std::string out = " -o " + (scratch / "o").string();
  EXPECT_EQ(run("dynamic " + data("cube.toml") + " --method magic" + out).code, 2);
  EXPECT_EQ(run("dynamic " + data("cube.toml")).code, 2);
  EXPECT_EQ(run("dynamic " + data("cube.toml") + " --budget-ms 1 --budget-shots 1" + out).code, 2);
  EXPECT_EQ(run("dynamic " + (scratch / "none.toml").string() + out).code, 3);
  std::ofstream(scratch / "bad.toml") << contents(data("cube.toml"))
                                      << "[[event]]\ntime = 4\nobject = \"cup\"\noperation = \"remove\"\n";
  const Outcome unknown = run("dynamic " + (scratch / "bad.toml").string() + out);
  EXPECT_EQ(unknown.code, 3);
  EXPECT_THAT(unknown.err, HasSubstr("there is no object 'cup'"));
  std::ofstream(scratch / "wall.toml") << contents(data("cube.toml"))
                                       << "[[event]]\ntime = 4\nobject = \"cube\"\noperation = \"add\"\n"
                                          "translate = [1.7, 0, 0]\n";
  const Outcome wall = run("dynamic " + (scratch / "wall.toml").string() + kQuick + out);
  EXPECT_EQ(wall.code, 0) << "legal geometry";
  EXPECT_THAT(wall.err, HasSubstr("passes through 'room'"));
  std::ofstream(scratch / "held.toml") << contents(data("cube.toml"))
                                       << "[[event]]\ntime = 4\nobject = \"cube\"\noperation = \"add\"\n"
                                          "[[event]]\ntime = 5\nobject = \"cube\"\noperation = \"select\"\n"
                                          "[[event]]\ntime = 6\nobject = \"cube\"\noperation = \"move\"\n"
                                          "translate = [9, 0, 0]\n";
  const Outcome held = run("dynamic " + (scratch / "held.toml").string() + kQuick + out);
  EXPECT_EQ(held.code, 0) << held.err;
  EXPECT_THAT(held.err, HasSubstr("has left the scene")) << "a selected object, too";
  std::ofstream(scratch / "no.h5") << "no archive";
  EXPECT_EQ(run("dynamic " + data("cube.toml") + kQuick + " --references " + (scratch / "no.h5").string() + out).code,
            3);
  const Outcome unwritable = run("dynamic " + data("cube.toml") + kQuick + " --references " +
                                 (scratch / "nowhere" / "kept.h5").string() + " -o " + (scratch / "never").string());
  EXPECT_EQ(unwritable.code, 3);
  EXPECT_THAT(unwritable.err, HasSubstr("cannot be written"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "never" / "frames.json")) << "it is said before the work";
  std::ofstream(scratch / "still.toml") << contents(data("cube.toml"))
                                        << "[[event]]\ntime = 4\nobject = \"table top\"\noperation = \"move\"\n";
  const Outcome still = run("dynamic " + (scratch / "still.toml").string() + kQuick + out);
  EXPECT_EQ(still.code, 3);
  EXPECT_THAT(still.err, HasSubstr("still.toml:115: a move needs"));
  std::ofstream(scratch / "empty.toml") << "[[material]]\nname = \"grey\"\nrho = 0.5\n[[object]]\nname = \"box\"\n"
                                           "box = {min = [0, 0, 0], max = [1, 1, 1]}\nmaterial = \"grey\"\n"
                                           "absent = true\n[[event]]\ntime = 1\nobject = \"box\"\n"
                                           "operation = \"add\"\n";
  const Outcome empty = run("dynamic " + (scratch / "empty.toml").string() + out);
  EXPECT_EQ(empty.code, 3);
  EXPECT_THAT(empty.err, HasSubstr("all objects are absent"));
  const Outcome late = run("dynamic " + data("cube.toml") + " --no-images --time-limit 0.05" + out);
  EXPECT_EQ(late.code, 4);
  EXPECT_THAT(late.err, HasSubstr("the partial result was saved"));
  EXPECT_EQ(json_in(scratch / "o" / "frames.json").size(), 1u);
}

}  // namespace
}  // namespace exitance
