// Disks that are full and processes that are killed: no verb crashes, no result is half-written, and what was finished
// is not lost.

#include <gtest/gtest.h>

#include <set>

#include "tests/cli/program.h"

namespace exitance {
namespace {

/// No file may grow beyond so many blocks of 512 bytes; writing more fails as on a full disk.
std::string disk_of(int blocks) {
  return "trap '' XFSZ; ulimit -f " + std::to_string(blocks) + ";";
}

/// Results, not drafts nor what a run needs to go on.
std::set<std::string> results_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  std::error_code missing;
  for (std::filesystem::recursive_directory_iterator entry(folder, missing), end; !missing && entry != end; ++entry) {
    const std::string name = entry->path().lexically_relative(folder).string();
    const bool is_draft = name.find(".draft.") != std::string::npos || name.find(".part") != std::string::npos;
    if (entry->is_regular_file() && !is_draft) names.insert(name);
  }
  return names;
}

const std::string kCases =
    R"({"cases":[{"id":"a","kind":"point_polygon","receiver":{"point":[0,0,0],"normal":[0,0,1]},"source":{"polygon":[[0,1,1],[1,1,1],[1,0,1],[0,0,1]]}}]})";

TEST(FullDisk, EndsEveryVerbWithAMessageAndNothingHalfWritten) {
  const ScratchFolder scratch;
  std::string many = "{\"cases\":[";
  for (int k = 0; k < 40; ++k) many += (k > 0 ? "," : "") + kCases.substr(10, kCases.size() - 12);
  std::ofstream(scratch / "cases.json") << many << "]}";
  const std::string out = " -o " + (scratch / "out/").string();
  std::filesystem::create_directory(scratch / "out");
  const std::string cube = data("furnace_cube.toml");
  for (const std::string& arguments :
       {"formfactor " + cube + " --patch-size 0.25 --save-every 0" + out + "a.h5",
        "formfactor " + cube + " --patch-size 0.25" + out + "a.csv",
        "reference " + cube + " --error 1e-6 --save-every 0" + out + "r.h5",
        "solve " + cube + " --patch-size 0.5" + out + "solved",
        "dynamic " EXITANCE_SOURCE_DIR "/tests/fuzz/seeds/scene.toml --method scratch --patch-size 1 --elements 1" +
            out + "frames",
        "compare " + cube + " --against rays:16" + out + "worst.vtp", "stress --count 29" + out + "stress",
        "cases " + (scratch / "cases.json").string() + out + "answers.json"}) {
    const Outcome outcome = run(arguments, disk_of(2));
    EXPECT_EQ(outcome.code, 3) << arguments << "\n" << outcome.err;
    const std::size_t last = outcome.err.rfind('\n', outcome.err.size() - 2);
    EXPECT_EQ(outcome.err.substr(last == std::string::npos ? 0 : last + 1, 10), "exitance: ") << outcome.err;
    EXPECT_EQ(outcome.err.find("major:"), std::string::npos) << "HDF5 prints nothing of its own: " << outcome.err;
    EXPECT_EQ(results_in(scratch / "out"), std::set<std::string>{}) << arguments;
  }
}

TEST(FullDisk, LosesNothingThatIsFinished) {
  const ScratchFolder scratch;
  const auto command = [&](const std::string& file) {
    return "formfactor " + data("furnace_cube.toml") + " --patch-size 0.25 --save-every 0 --json -o " +
           (scratch / file).string();
  };
  ASSERT_EQ(run(command("whole.h5")).code, 0);
  const Outcome full = run(command("a.h5"), disk_of(32));  // parts of rows fit, all rows together do not
  EXPECT_EQ(full.code, 3) << full.err;
  EXPECT_EQ(results_in(scratch / ""), std::set<std::string>{"whole.h5"});
  const Outcome resumed = run(command("a.h5"));
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(nlohmann::json::parse(resumed.out).at("resumed_rows"), 96);
  EXPECT_EQ(contents(scratch / "a.h5"), contents(scratch / "whole.h5"));
}

TEST(Kill, LeavesWholeResultsOrNone) {
  const ScratchFolder scratch;
  const std::string solve = "solve " + data("furnace_cube.toml") + " --patch-size 0.2 --threads 1 -o ";
  const std::string whole = (scratch / "whole").string(), killed = (scratch / "killed").string();
  ASSERT_EQ(run(solve + whole).code, 0);
  const auto names = results_in(whole);
  ASSERT_GE(names.size(), 4u);
  for (const char* after : {"0.02", "0.04", "0.06", "0.1", "0.15"}) {
    run(solve + killed, std::string("timeout -s KILL ") + after);
    for (const std::string& name : results_in(killed)) {
      EXPECT_TRUE(names.contains(name)) << name;
      if (name.ends_with(".vtp")) {
        EXPECT_EQ(contents(killed + "/" + name), contents(whole + "/" + name)) << after;
      }
    }
  }
  ASSERT_EQ(run(solve + killed).code, 0);
  EXPECT_EQ(results_in(killed), names);
  for (const char* name : {"solution.vtp", "solution.ply", "image.png"})
    EXPECT_EQ(contents(killed + "/" + name), contents(whole + "/" + name)) << name;
}

}  // namespace
}  // namespace exitance
