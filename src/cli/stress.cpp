// exitance stress: degenerate questions by the thousand, against the oracle and against properties.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "src/cli/console.h"
#include "src/cli/given_options.h"
#include "src/cli/interrupt.h"
#include "src/cli/number_range.h"
#include "src/cli/progress_display.h"
#include "src/cli/stress_report.h"
#include "src/cli/stress_state.h"
#include "src/cli/verbs.h"
#include "src/output/manifest.h"
#include "src/output/result_folder.h"
#include "src/output/whole_file.h"
#include "src/scene/input_error.h"
#include "src/stress/stress_table.h"

namespace exitance {
namespace {

std::string lists() {
  std::string text = "Kinds of questions, and who can be asked:\n";
  for (const QuestionKind& kind : question_kinds())
    text += fmt::format("  {:<18}{}: {}\n", kind.name, kind.what, kind.contender_names);
  text += "Families:\n";
  for (const QuestionFamily& family : question_families()) {
    text += "  " + family.name + std::string(family.name.size() < 18 ? 18 - family.name.size() : 1, ' ') + family.what +
            "\n";
  }
  return text;
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const QuestionKind& kind : question_kinds()) names.push_back(kind.name);
  return names;
}

class Stress {
 public:
  explicit Stress(CLI::App& verb) : verb_(verb) {
    verb.add_option("--family", options_.families, "Families of questions, separated by commas; all without it")
        ->delimiter(',');
    verb.add_option("--question", kind_, "What is asked about the same scenes")
        ->check(CLI::IsMember(kind_names()))
        ->capture_default_str();
    verb.add_option("--count", options_.count, "Questions, spread over families and magnitudes")
        ->check(whole_number_between(1))
        ->capture_default_str();
    verb.add_option("--first", options_.first, "Number of the first question, to go on where another run ended")
        ->check(whole_number_between(0))
        ->capture_default_str();
    verb.add_option("--seed", options_.seed, "Other numbers give other questions")
        ->check(whole_number_between(0))
        ->capture_default_str();
    verb.add_option("--contender", contenders_,
                    "Who is asked, separated by commas; of points exact, plain-double, rays:N, rays:N:fast, cgal-epeck")
        ->delimiter(',')
        ->capture_default_str();
    verb.add_option("--against", against_,
                    "oracle: the answer by another route; properties: forms of the same question")
        ->check(CLI::IsMember({"oracle", "properties", "both"}))
        ->capture_default_str();
    verb.add_option("--threads", threads_, "Threads; as many as there are cores unless given")
        ->check(whole_number_between(1, kMostThreads));
    verb.add_option("--save-every", options_.save_every,
                    "Seconds after which what is known is kept in the folder, in unfinished.json")
        ->check(number_between(0))
        ->capture_default_str();
    verb.add_flag("--json", json_, "Print the report as JSON");
    verb.add_option("-o,--output", folder_,
                    "Folder for stress.json, stress.csv, stress.svg, and failures.json, which `cases` replays");
    verb.footer(
        lists() +
        "Magnitudes: how far things are moved from the degenerate position, of a stage whose lengths are 1 to 16.\n"
        "Of shafts and shadows failures.json has the polygons, for `cases` to compute what they exchange; the object\n"
        "of a question of shadows is the first half of the occluders.\n"
        "With -o the same command goes on after Ctrl-C (exit code 4) or a crash, also with a larger --count.\n"
        "Exit code 1: an answer is wrong or a property broken, of any contender asked. What the oracle fails on\n"
        "is counted as not judged.");
  }

  void run() {
    std::optional<tbb::global_control> limit;
    if (threads_) limit.emplace(tbb::global_control::max_allowed_parallelism, *threads_);
    catch_interrupts();
    options_.kind = &question_kind_named(kind_);
    for (const std::string& name : contenders_) add_contender(name);
    options_.oracle = against_ != "properties";
    options_.properties = against_ != "oracle";
    options_.stop = interrupted;
    std::optional<ResultFolder> folder;
    if (!folder_.empty()) {
      folder.emplace(folder_);
      go_on();
    }
    const StressReport report = ask();
    const StressSummary summary{report, contenders_, options_.seed, given_options(verb_)};
    if (folder) {
      const auto write = [&](const char* name, const std::string& text) {
        write_whole_file(folder->draft() / name, [&](std::ostream& out) { out << text; });
      };
      write("stress.json", to_json(summary));
      write("stress.csv", stress_csv(report));
      write("failures.json", failures_as_cases(report));
      const Manifest build = build_manifest();
      write_stress_map(
          folder->draft() / "stress.svg", report, contenders_,
          fmt::format("seed {}; exitance {} ({})", options_.seed, build.version, build.commit.substr(0, 7)));
      folder->publish();
      std::error_code ignored;
      if (report.complete) std::filesystem::remove(unfinished(), ignored);
    }
    print_results(json_ ? to_json(summary) : printable(in_words(summary)));
    if (summary.total().wrong + summary.total().broken() > 0) throw CLI::RuntimeError(check_failed);
    if (!report.complete) {
      print_message(folder ? "stopped; what was asked until then holds, and the same command goes on"
                           : "stopped; what was asked until then holds");
      throw CLI::RuntimeError(limit_reached);
    }
  }

 private:
  std::filesystem::path unfinished() const { return std::filesystem::path(folder_) / "unfinished.json"; }

  /// Where an earlier run of the same command ended.
  void go_on() {
    const Manifest build = build_manifest();
    const StressKey key{{"version", build.version},
                        {"commit", build.commit},
                        {"compiler", build.compiler},
                        {"question", kind_},
                        {"families", fmt::format("{}", fmt::join(options_.families, ","))},
                        {"contenders", fmt::format("{}", fmt::join(contenders_, ","))},
                        {"against", against_},
                        {"seed", std::to_string(options_.seed)},
                        {"first", std::to_string(options_.first)}};
    options_.resumed = read_stress_state(unfinished(), key);
    if (options_.resumed && options_.resumed->done > options_.count) {
      throw InputError(unfinished().string(), 0,
                       fmt::format("holds {} questions already; give --count {} or more, or remove it",
                                   options_.resumed->done, options_.resumed->done));
    }
    options_.save = [this, key](const StressState& state) { write_stress_state(unfinished(), key, state); };
  }

  void add_contender(const std::string& name) {
    if (std::ranges::find(options_.contenders, name, &Contender::name) != options_.contenders.end())
      throw CLI::ValidationError("--contender", name + " is named twice");
    options_.contenders.push_back(options_.kind->contender_named(name));
    if (against_ == "properties" && !options_.contenders.back().has_properties)
      throw CLI::ValidationError("--against", "no properties are asked of " + name + "; give --against oracle");
  }

  StressReport ask() {
    ProgressDisplay display;
    options_.progress = [&](double fraction, std::string_view label) { display.show(fraction, label); };
    return run_stress(options_);
  }

  CLI::App& verb_;
  StressOptions options_;
  std::vector<std::string> contenders_{"exact"};
  std::string kind_ = "points", against_ = "both", folder_;
  std::optional<std::size_t> threads_;
  bool json_ = false;
};

}  // namespace

void add_stress(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("stress", "Ask degenerate questions by the thousand and check the answers");
  verb->callback([stress = std::make_shared<Stress>(*verb)] { stress->run(); });
}

}  // namespace exitance
