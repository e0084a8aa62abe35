// exitance reference: the radiosity of a scene, refined until its error is what is wanted.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "src/cli/console.h"
#include "src/cli/given_options.h"
#include "src/cli/interrupt.h"
#include "src/cli/memory_limit.h"
#include "src/cli/number_range.h"
#include "src/cli/progress_display.h"
#include "src/cli/scene_options.h"
#include "src/cli/verbs.h"
#include "src/output/manifest.h"
#include "src/output/process_memory.h"
#include "src/reference/reference_solution.h"
#include "src/scene/input_error.h"
#include "src/scene/scene_hash.h"

namespace exitance {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Json json_of(const SolutionError& error) {
  return {{"total", error.total}, {"mesh", error.mesh}, {"integration", error.integration}, {"solver", error.solver}};
}

Json json_of(const ReferenceLevel& level) {
  return {{"patches", level.patches},
          {"elements", level.elements},
          {"new_elements", level.new_elements},
          {"resumed_rows", level.resumed_rows},
          {"partial_pairs", level.partial_pairs},
          {"error", json_of(level.error)},
          {"means_error", level.means_error},
          {"largest_excess", level.largest_excess},
          {"seconds", {{"form_factors", level.seconds_form_factors}, {"solve", level.seconds_solve}}}};
}

/// Names in files need not be UTF-8.
std::string in_text(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string in_words(const ReferenceLevel& level, std::size_t number) {
  return fmt::format(
      "level {}: {} patches, {} elements ({} new): error {:.3g} (mesh {:.3g}, form factors {:.3g}); {:.1f} s\n", number,
      level.patches, level.elements, level.new_elements, level.error.total, level.error.mesh, level.error.integration,
      level.seconds_form_factors + level.seconds_solve);
}

class Reference {
 public:
  explicit Reference(CLI::App& verb) : verb_(verb) {
    scene_.add_to(verb);
    verb.add_option(
            "--error", options_.error,
            "Error wanted: area-weighted luminance norm (George et al. 1990, eq. 7), relative, as a function of "
            "the point")
        ->check(positive_number())
        ->capture_default_str();
    verb.add_option("--patch-size", options_.patch_size,
                    "Longest edge of a patch of the first mesh [m]; 0: surfaces as they are")
        ->check(number_between(0))
        ->capture_default_str();
    verb.add_option("--time-limit", time_limit_, "Seconds after which to end with what there is, exit code 4")
        ->check(positive_number());
    memory_limit_.add_to(verb);
    verb.add_option("--threads", threads_, "Threads; as many as there are cores unless given")
        ->check(whole_number_between(1, kMostThreads));
    verb.add_option("--save-every", options_.block_seconds,
                    "Seconds of work after which finished rows are saved beside FILE")
        ->check(number_between(0))
        ->capture_default_str();
    verb.add_flag("--json", json_, "Print the report as JSON");
    verb.add_option("-o,--output", file_, "File for the solution (.h5)")->required();
    verb.footer(
        "The mesh is refined where the error is, along shadow boundaries first, until the estimated error is below "
        "what\n"
        "is wanted. After each level the solution so far is in FILE. Finished rows of form factors are kept in\n"
        "FILE.parts: the same command goes on after Ctrl-C (exit code 4) or a crash. A FILE of the same scene and "
        "version\n"
        "that is good enough is left as it is. `exitance diff` compares solutions.");
  }

  void run() {
    const auto start = Clock::now();
    if (fs::path(file_).extension() != ".h5") throw InputError(file_, 0, "must end in .h5");
    const std::size_t threads =
        threads_ ? *threads_ : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    catch_interrupts();
    const Scene scene = scene_.read();
    for (const std::string& warning : scene.warnings) print_warning(warning);
    if (already_there(scene)) return;

    const PolygonSoup soup = make_soup(scene);
    options_.key = build_key();
    options_.checkpoint = checkpoint();
    options_.memory_limit = memory_limit_.bytes();
    options_.stop = [this, start] { return interrupted() || (time_limit_ && seconds_since(start) > *time_limit_); };
    const ReferenceSolution solution = solve(scene, soup, static_cast<unsigned>(threads));
    print(solution, seconds_since(start));
    end(solution);
  }

 private:
  fs::path checkpoint() const { return file_ + ".parts"; }

  bool already_there(const Scene& scene) const {
    std::error_code ignored;
    if (!fs::exists(file_, ignored)) return false;
    const SolutionRecord there = read_solution_archive(file_);
    const bool same_version = Json::parse(there.manifest).value("version", "") == build_manifest().version;
    if (there.scene_hash != scene_hash(scene) || !same_version || there.error.total > options_.error) return false;
    clear_finished_checkpoint(checkpoint());
    print_results(
        json_ ? in_text({{"scene", there.scene}, {"error", json_of(there.error)}, {"reused", true}})
              : printable(fmt::format("{} is there already, with an error of {:.3g}\n", file_, there.error.total)));
    return true;
  }

  ReferenceSolution solve(const Scene& scene, const PolygonSoup& soup, unsigned threads) {
    ProgressDisplay display;
    options_.progress = [&](double fraction, std::string_view label) { display.show(fraction, label); };
    return solve_reference(scene, soup, options_, [&](const ReferenceSolution& solution) {
      SolutionRecord record = solution.record;
      record.manifest = manifest(solution, threads);
      write_solution_archive(file_, record);
      display.clear();
      fmt::print(stderr, "{}", in_words(solution.levels.back(), solution.levels.size() - 1));
    });
  }

  std::string manifest(const ReferenceSolution& solution, unsigned threads) const {
    const Manifest build = build_manifest();
    Json levels = Json::array();
    for (const ReferenceLevel& level : solution.levels) levels.push_back(json_of(level));
    const Json json = {{"version", build.version},
                       {"commit", build.commit},
                       {"compiler", build.compiler},
                       {"libraries", build.libraries},
                       {"threads", threads},
                       {"seed", nullptr},  // nothing is random
                       {"scene_hash", solution.record.scene_hash},
                       {"options", given_options(verb_)},
                       {"levels", levels}};
    return in_text(json);
  }

  void print(const ReferenceSolution& solution, double seconds) const {
    const SolutionRecord& record = solution.record;
    if (!json_) {
      print_results(printable(fmt::format(
          "{}: {} patches, {} elements, error {:.3g} (mesh {:.3g}, form factors {:.3g}, solver {:.3g}); {:.1f} s, "
          "{:.0f} MiB at most\n",
          record.scene, record.mesh.patches.size(), record.mesh.elements.size(), record.error.total, record.error.mesh,
          record.error.integration, record.error.solver, seconds, static_cast<double>(peak_memory_bytes()) * 0x1p-20)));
    } else {
      Json levels = Json::array();
      for (const ReferenceLevel& level : solution.levels) levels.push_back(json_of(level));
      const Json json = {{"scene", record.scene},
                         {"patches", record.mesh.patches.size()},
                         {"elements", record.mesh.elements.size()},
                         {"error_wanted", options_.error},
                         {"error", json_of(record.error)},
                         {"reached", solution.end == ReferenceEnd::reached},
                         {"reused", false},
                         {"levels", levels},
                         {"seconds", seconds},
                         {"peak_memory_bytes", peak_memory_bytes()}};
      print_results(in_text(json));
    }
  }

  void end(const ReferenceSolution& solution) const {
    if (solution.end == ReferenceEnd::reached) return;
    const std::string saved =
        fmt::format("{} has the error {:.3g}, not {:.3g}", file_, solution.record.error.total, options_.error);
    if (solution.end == ReferenceEnd::memory) {
      throw LimitError(fmt::format("the next level's form factors would take about {} of memory and {} may be used; {}",
                                   size_in_words(solution.bytes_needed), size_in_words(options_.memory_limit), saved));
    }
    throw LimitError(fmt::format("stopped; {}; the same command goes on", saved));
  }

  CLI::App& verb_;
  SceneOptions scene_;
  ReferenceOptions options_;
  std::optional<double> time_limit_;
  MemoryLimit memory_limit_;
  std::optional<std::size_t> threads_;
  std::string file_;
  bool json_ = false;
};

}  // namespace

void add_reference(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("reference", "Solve a scene to a stated error, as a reference for others");
  verb->callback([reference = std::make_shared<Reference>(*verb)] { reference->run(); });
}

}  // namespace exitance
