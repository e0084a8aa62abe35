// Disks that are full and processes that are killed: no verb crashes, no result is half-written, and what was finished
// is not lost.

#include <gtest/gtest.h>
#include <sys/mount.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <set>

#include "src/reference/solution_record.h"
#include "tests/cli/program.h"
#include "tests/cli/running.h"
#include "tests/places.h"

namespace exitance {
namespace {

/// No file may grow beyond so many blocks of 512 bytes; writing more fails as on a full disk.
std::string disk_of(int blocks) {
  return "trap '' XFSZ; ulimit -f " + std::to_string(blocks) + ";";
}

/// A disk of one's own; where the system lets nobody mount one, `is_there` is false.
class Disk {
 public:
  explicit Disk(std::size_t kibibytes)
      : is_there_(mount("tmpfs", (folder_ / "").c_str(), "tmpfs", 0, size(kibibytes).c_str()) == 0) {}
  ~Disk() {
    if (is_there_) umount2((folder_ / "").c_str(), MNT_DETACH);
  }
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;

  bool is_there() const { return is_there_; }
  std::string folder() const { return (folder_ / "").string(); }
  void grow(std::size_t kibibytes) const {
    ASSERT_EQ(mount("tmpfs", (folder_ / "").c_str(), "tmpfs", MS_REMOUNT, size(kibibytes).c_str()), 0);
  }

 private:
  static std::string size(std::size_t kibibytes) { return "size=" + std::to_string(kibibytes) + "k"; }

  ScratchFolder folder_;
  bool is_there_;
};

/// Results, not drafts nor what a run needs to go on.
std::set<std::string> results_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  std::error_code missing;
  for (std::filesystem::recursive_directory_iterator entry(folder, missing), end; !missing && entry != end; ++entry) {
    const std::string name = entry->path().lexically_relative(folder).string();
    const bool is_draft = name.find(".draft.") != std::string::npos || name.find(".part") != std::string::npos ||
                          name.ends_with("unfinished.json");
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
        "dynamic " + source_file("tests/fuzz/seeds/scene.toml") + " --method scratch --patch-size 1 --elements 1" +
            out + "frames",
        "dynamic " + source_file("tests/fuzz/seeds/scene.toml") + " --method hvt" + out + "frames",
        "solve " + cube + " --method hierarchical" + out + "linked",
        "generate furnished-room --polygons 500" + out + "r.obj",
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

/// Long work, made short; @ stands for the folder of the results.
struct Work {
  std::string name, arguments;
  int code = 0;  ///< that it ends with
};

std::vector<Work> long_work() {
  const std::string cube = data("furnace_cube.toml");
  const std::string frames = "dynamic " + data("cube.toml") + " --image-size 32 -o @/frames";
  return {{"solve", "solve " + cube + " --patch-size 0.5 --save-every 0 -o @/solved"},
          {"solve_shots", "solve " + cube +
                              " --patch-size 0.5 --method shoot --time-limit 1000 --tolerance 1e-3 --save-every 0 "
                              "-o @/solved"},
          {"formfactor", "formfactor " + cube + " --patch-size 0.25 --save-every 0 -o @/a.h5"},
          {"reference", "reference " + data("box_on_floor.toml") + " --error 3e-2 --save-every 0 -o @/r.h5"},
          {"compare", "compare " + cube + " --patch-size 0.25 --save-every 0 --against rays:16 -o @/worst.vtp"},
          {"redistribute",
           frames + " --object-terms shot --patch-size 1.6 --elements 1 --save-every 0.05 --references @/kept.h5"},
          {"hvt", frames + " --method hvt --patch-size 1.6 --eps 0.5 --min-area 1 --no-reference"},
          {"stress",
           "stress --family gap,duplicate --contender plain-double --count 1536 --against properties --save-every 0 "
           "-o @/stress",
           1},
          {"generate", "generate furnished-room --polygons 3000 -o @/room.obj"}};
}

std::string command(const Work& work, const std::string& folder) {
  std::string text = work.arguments;
  for (std::size_t at; (at = text.find('@')) != std::string::npos;) text.replace(at, 1, folder);
  return text;
}

class LongWork : public testing::TestWithParam<Work> {
 protected:
  LongWork() {
    std::filesystem::create_directory(whole_);
    const auto start = std::chrono::steady_clock::now();
    const Outcome whole = run(command(GetParam(), whole_));
    EXPECT_EQ(whole.code, GetParam().code) << whole.err;
    seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    names_ = results_in(whole_);
  }

  /// What is there is whole: the bytes of the run that nothing happened to; of files with times in them, and those that
  /// hold more after every frame or level, that they can be read.
  void expect_nothing_half_written(const std::string& folder) const {
    for (const std::string& name : results_in(folder)) {
      EXPECT_TRUE(names_.contains(name)) << name;
      const std::string file = folder + "/" + name;
      if (name.ends_with(".json")) {
        EXPECT_NO_THROW(json_in(file)) << name;
      } else if (name == "r.h5") {
        EXPECT_NO_THROW(read_solution(file)) << name;
      } else if (name == "kept.h5") {
        EXPECT_TRUE(contents(file).starts_with("\x89HDF"));
      } else if (!name.ends_with(".csv")) {
        EXPECT_TRUE(contents(file) == contents(whole_ + "/" + name)) << name;
      }
    }
    expect_listed_frames(folder + "/frames");
  }
  void expect_all(const std::string& folder) const {
    EXPECT_EQ(results_in(folder), names_);
    expect_nothing_half_written(folder);
    if (names_.contains("r.h5")) {
      EXPECT_EQ(read_solution(folder + "/r.h5").B, read_solution(whole_ + "/r.h5").B);
    }
  }

  const ScratchFolder scratch_;
  const std::string whole_ = (scratch_ / "whole").string();
  double seconds_ = 0;
  std::set<std::string> names_;

 private:
  /// A frame that is listed has its picture and its mesh.
  static void expect_listed_frames(const std::string& folder) {
    if (!std::filesystem::exists(folder + "/frames.json")) return;
    for (std::size_t k = 0; k < json_in(folder + "/frames.json").size(); ++k) {
      for (const char* kind : {".png", ".vtp"})
        EXPECT_TRUE(std::filesystem::exists(folder + "/frame_00" + std::to_string(k) + kind)) << k << kind;
    }
  }
};

TEST_P(LongWork, IsWholeOrNotThereAfterAKillAtAnyMoment) {
  const std::string folder = (scratch_ / "killed").string();
  std::filesystem::create_directory(folder);
  std::mt19937 random(7);
  for (int k = 0; k < 3; ++k) {
    run_and_kill(command(GetParam(), folder), seconds_ * std::uniform_real_distribution(0.1, 0.9)(random));
    expect_nothing_half_written(folder);
  }
  const Outcome last = run(command(GetParam(), folder));
  EXPECT_EQ(last.code, GetParam().code) << last.err;
  expect_all(folder);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    EXPECT_TRUE(!entry.is_regular_file() || names_.contains(name)) << name << " is left";
  }
}

TEST_P(LongWork, GoesOnWhenAFullDiskHasRoomAgain) {
  std::size_t kibibytes = 8;
  const Disk disk(kibibytes);
  if (!disk.is_there()) GTEST_SKIP() << "no file system can be mounted here";
  Outcome outcome;
  while ((outcome = run(command(GetParam(), disk.folder()))).code != GetParam().code && kibibytes < 65'536) {
    EXPECT_EQ(outcome.code, 3) << kibibytes << " KiB: " << outcome.err;
    expect_nothing_half_written(disk.folder());
    disk.grow(kibibytes *= 4);
  }
  EXPECT_GT(kibibytes, 8u) << "it was never full";
  EXPECT_EQ(outcome.code, GetParam().code) << outcome.err;
  expect_all(disk.folder());
}

INSTANTIATE_TEST_SUITE_P(Verbs, LongWork, testing::ValuesIn(long_work()),
                         [](const auto& one) { return one.param.name; });

/// Everything but times and what is said of the run itself.
nlohmann::json answers(nlohmann::json report) {
  for (auto& row : report["rows"]) row.erase("seconds");
  return report["rows"];
}

/// What a solution says, but for times and memory.
nlohmann::json solution_in(const std::filesystem::path& folder) {
  nlohmann::json report = json_in(folder / "result.json");
  for (const char* name : {"seconds", "peak_memory_bytes", "threads", "resumed_rows"}) report.erase(name);
  report.at("manifest").erase("threads");
  report.at("manifest").erase("options");
  return report;
}

/// The name of the part that was kept last.
std::string last_part(const std::filesystem::path& kept) {
  std::string last;
  std::error_code failed;
  for (std::filesystem::directory_iterator part(kept, failed), end; !failed && part != end; part.increment(failed)) {
    if (part->path().extension() == ".h5") last = std::max(last, part->path().filename().string());
  }
  return last;
}

void end_when_more_is_kept(const std::filesystem::path& kept, const std::string& command, int signal, int code) {
  const std::string first = last_part(kept);
  EXPECT_EQ(Running(command).end_when([&] { return last_part(kept) > first; }, signal), code);
}

/// How a scene is solved.
class KilledSolve : public testing::TestWithParam<const char*> {
 protected:
  std::string command(const char* folder, const std::string& more = "") const {
    return "solve " + data("box_on_floor.toml") + " --save-every 0 " + GetParam() + more + " -o " +
           (scratch_ / folder).string();
  }
  const ScratchFolder scratch_;
  const std::filesystem::path kept_ = scratch_ / "killed/unfinished.parts";
};

TEST_P(KilledSolve, GoesOnWithTheSameBits) {
  ASSERT_EQ(run(command("whole")).code, 0);
  end_when_more_is_kept(kept_, command("killed", " --seed 2"), SIGKILL, -1);  // other work: it is forgotten
  end_when_more_is_kept(kept_, command("killed"), SIGKILL, -1);
  end_when_more_is_kept(kept_, command("killed"), SIGKILL, -1);
  const std::string before = last_part(kept_);
  end_when_more_is_kept(kept_, command("killed"), SIGINT, 4);
  EXPECT_GT(last_part(kept_), before);
  ASSERT_EQ(run(command("killed")).code, 0);
  EXPECT_FALSE(exists(kept_));
  EXPECT_EQ(solution_in(scratch_ / "killed"), solution_in(scratch_ / "whole"));
  for (const char* name : {"solution.vtp", "solution.ply", "image.png"})
    EXPECT_TRUE(contents(scratch_ / "killed" / name) == contents(scratch_ / "whole" / name)) << name;
}

INSTANTIATE_TEST_SUITE_P(Methods, KilledSolve,
                         testing::Values("--patch-size 0.5 --elements 3", "--patch-size 1.5 --receivers area",
                                         "--patch-size 1 --method shoot --time-limit 1000 --tolerance 1e-3"));

/// How a scene's events are followed by shots.
class KilledFrames : public testing::TestWithParam<const char*> {
 protected:
  std::string command(const char* folder) const {
    return "dynamic " + data("cube.toml") + " --patch-size 1.2 --elements 2 --no-images --save-every 0.01 " +
           GetParam() + " -o " + (scratch_ / folder).string();
  }
  /// What they tell, but for times, and how many form factors it took: what is gone with a process is computed anew.
  nlohmann::json frames_in(const char* folder) const {
    nlohmann::json frames = json_in(scratch_ / folder / "frames.json");
    for (nlohmann::json& frame : frames) {
      for (const char* name : {"seconds", "seconds_edits", "visibility_tests", "redistribution_tests",
                               "redistribution_tests_idle", "redistribution_tests_idle_patches"})
        frame.erase(name);
    }
    return frames;
  }

  const ScratchFolder scratch_;
  const std::filesystem::path kept_ = scratch_ / "killed/unfinished.parts";
};

TEST_P(KilledFrames, GoOnToTheSameBits) {
  ASSERT_EQ(run(command("whole")).code, 0);
  end_when_more_is_kept(kept_, command("killed") + " --tolerance 1e-3", SIGKILL, -1);
  const Outcome other = run(command("killed") + " --time-limit 1e-3");
  EXPECT_EQ(other.code, 4);
  EXPECT_NE(other.err.find("warning: what was kept in " + kept_.string()), std::string::npos) << other.err;
  for (int k = 0; k < 3; ++k) end_when_more_is_kept(kept_, command("killed"), SIGKILL, -1);
  end_when_more_is_kept(kept_, command("killed"), SIGINT, 4);
  EXPECT_NO_THROW(json_in(scratch_ / "killed/frames.json"));
  const Outcome stopped = run(command("killed") + " --json --time-limit 1e-3");
  EXPECT_EQ(stopped.code, 4);
  EXPECT_GE(nlohmann::json::parse(stopped.out).size(), 1u) << "what an earlier run has done is told";
  EXPECT_NE(stopped.err.find("the same command goes on"), std::string::npos) << stopped.err;
  const Outcome last = run(command("killed"));
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_FALSE(exists(kept_));
  EXPECT_EQ(frames_in("killed"), frames_in("whole"));
}

INSTANTIATE_TEST_SUITE_P(Methods, KilledFrames,
                         testing::Values("--object-terms shot", "--object-terms shot --budget-shots 7 --work-off",
                                         "--object-terms shot --memory-limit 0.0005", "--method restart --strategy 2",
                                         "--method scratch"));

TEST(KilledGathering, GoesOnToTheSameErrors) {
  const ScratchFolder scratch;
  const auto command = [&](const char* folder) {
    return "dynamic " + data("cube.toml") + " --patch-size 1.2 --elements 2 --no-images --save-every 0.01 -o " +
           (scratch / folder).string();
  };
  const std::filesystem::path frames = scratch / "killed/frames.json";
  ASSERT_EQ(run(command("whole")).code, 0);
  const auto has_added_the_cube = [&] { return exists(frames) && json_in(frames).size() == 2; };
  EXPECT_EQ(Running(command("killed")).end_when(has_added_the_cube, SIGKILL), -1);
  ASSERT_EQ(run(command("killed")).code, 0);
  const nlohmann::json whole = json_in(scratch / "whole/frames.json"), killed = json_in(scratch / "killed/frames.json");
  ASSERT_EQ(killed.size(), whole.size());
  for (std::size_t k = 0; k < killed.size(); ++k) {
    EXPECT_TRUE(killed[k].at("finished"));
    EXPECT_EQ(killed[k].at("edits"), whole[k].at("edits"));
    EXPECT_NEAR(killed[k].at("error"), whole[k].at("error"), 1e-9) << k;
  }
}

/// Of what is kept where: whatever is solved next in that folder.
class OtherSolve : public testing::TestWithParam<const char*> {};

TEST_P(OtherSolve, RemovesWhatWasKeptAndSaysSo) {
  const ScratchFolder scratch;
  const std::filesystem::path kept = scratch / "out/unfinished.parts";
  std::filesystem::create_directories(kept);
  std::ofstream(kept / "part-000001.h5") << "of another program";
  const Outcome outcome = run("solve " + data("furnace_cube.toml") + " --patch-size 0.5 " + GetParam() + " -o " +
                              (scratch / "out").string());
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("warning: what was kept in " + kept.string()), std::string::npos) << outcome.err;
  EXPECT_FALSE(exists(kept));
  EXPECT_EQ(json_in(scratch / "out/result.json").at("resumed_rows"), 0);
}

INSTANTIATE_TEST_SUITE_P(Methods, OtherSolve,
                         testing::Values("", "--method shoot --time-limit 1000 --tolerance 1e-3",
                                         "--method hierarchical", "--receivers area --visibility rays --rays 16"));

TEST(Kill, OfStressLosesNoQuestionThatWasKept) {
  const ScratchFolder scratch;
  const auto command = [&](const char* folder) {
    return "stress --family duplicate,gap --contender plain-double --count 2048 --against properties "
           "--save-every 0 -o " +
           (scratch / folder).string();
  };
  EXPECT_EQ(run(command("whole")).code, 1) << "plain doubles are wrong";
  const auto unfinished = scratch / "killed/unfinished.json";
  const auto kept = [&] { return exists(unfinished) ? json_in(unfinished).at("done").get<int>() : 0; };
  EXPECT_EQ(Running(command("killed")).end_when([&] { return kept() >= 512; }, SIGKILL), -1);
  const int first = kept();
  EXPECT_EQ(Running(command("killed")).end_when([&] { return kept() > first; }, SIGINT), 1);
  EXPECT_FALSE(json_in(scratch / "killed/stress.json").at("complete"));
  EXPECT_GT(kept(), first);
  EXPECT_EQ(run("stress --seed 2 -o " + (scratch / "killed").string()).code, 3) << "another run";
  EXPECT_EQ(run(command("killed")).code, 1);
  EXPECT_FALSE(exists(unfinished));
  const auto killed = json_in(scratch / "killed/stress.json"), whole = json_in(scratch / "whole/stress.json");
  EXPECT_GT(killed.at("resumed_questions"), 512);
  EXPECT_EQ(answers(killed), answers(whole));
  EXPECT_EQ(killed.at("failures"), whole.at("failures"));
  EXPECT_EQ(contents(scratch / "killed/failures.json"), contents(scratch / "whole/failures.json"));
}

TEST(Kill, OfDynamicLosesNoFrameThatWasDone) {
  const ScratchFolder scratch;
  const auto list = scratch / "killed/frames.json";
  const std::string command = "dynamic " + data("cube.toml") + " --patch-size 0.8 --elements 1 --image-size 32 -o " +
                              (scratch / "killed").string() + " --references " + (scratch / "kept.h5").string();
  const auto frames = [&] { return exists(list) ? json_in(list).size() : 0; };
  EXPECT_EQ(Running(command).end_when([&] { return frames() >= 2; }, SIGKILL), -1);
  ASSERT_GE(frames(), 2u);
  const auto killed = json_in(list);
  EXPECT_EQ(run(command).code, 0);
  const auto whole = json_in(list);
  EXPECT_EQ(whole.size(), 4u);
  for (std::size_t k = 0; k < killed.size(); ++k) EXPECT_EQ(whole[k]["error"], killed[k]["error"]) << k;
}

TEST(Kill, OfCompareLosesNoRowOfTheTruth) {
  const ScratchFolder scratch;
  const auto command = [&](const char* file) {
    return "compare " + data("box_on_floor.toml") + " --patch-size 0.6 --save-every 0 --json --against rays:16 -o " +
           (scratch / file).string();
  };
  const Outcome whole = run(command("whole.vtp"));
  const auto parts = scratch / "killed.vtp.parts";
  EXPECT_EQ(Running(command("killed.vtp")).end_when([&] { return files_with(".h5", parts) >= 3; }, SIGKILL), -1);
  const Outcome resumed = run(command("killed.vtp"));
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  const auto killed = nlohmann::json::parse(resumed.out);
  EXPECT_GE(killed.at("truth").at("resumed_rows"), 3);
  EXPECT_FALSE(exists(parts));
  EXPECT_EQ(contents(scratch / "killed.vtp"), contents(scratch / "whole.vtp"));
  EXPECT_EQ(killed.at("contenders")[0].at("solution"),
            nlohmann::json::parse(whole.out).at("contenders")[0].at("solution"));
}

}  // namespace
}  // namespace exitance
