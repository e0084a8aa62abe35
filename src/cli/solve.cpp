// exitance solve: the radiosity of a scene.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "src/cli/console.h"
#include "src/cli/given_options.h"
#include "src/cli/interrupt.h"
#include "src/cli/link_settings.h"
#include "src/cli/memory_limit.h"
#include "src/cli/number_range.h"
#include "src/cli/progress_display.h"
#include "src/cli/ray_settings.h"
#include "src/cli/scene_options.h"
#include "src/cli/verbs.h"
#include "src/links/hierarchical_solution.h"
#include "src/output/checkpoint.h"
#include "src/output/process_memory.h"
#include "src/output/report.h"
#include "src/output/result_folder.h"
#include "src/solve/scene_solution.h"
#include "src/solve/solution_files.h"

namespace exitance {
namespace {

/// A closed scene whose closure defect is above this is a failed check.
constexpr double kLargestClosureDefect = 1e-9;

/// Along the edge of a patch: what would make 2^32 points of a single one.
constexpr std::uint64_t kMostElements = 65'535;

/// Options that change nothing of the work, or the path of a scene, whose contents count.
constexpr std::array<std::string_view, 7> kOfNoConsequence = {"SCENE",      "json",       "memory-limit", "output",
                                                              "save-every", "time-limit", "threads"};

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string number_or(const std::optional<double>& value, const char* otherwise) {
  return value ? fmt::format("{:.3g}", *value) : otherwise;
}

std::string summary(const Report& r) {
  const double pairs = static_cast<double>(
      std::max<std::uint64_t>(1, r.pairs.facing_away + r.pairs.open + r.pairs.blocked + r.pairs.partial));
  const auto percent = [&](std::uint64_t count) { return 100 * static_cast<double>(count) / pairs; };
  std::string text = fmt::format("{}\n", r.scene);
  const auto line = [&](std::string_view name, const std::string& value) {
    text += fmt::format("  {:<22}{}\n", name, value);
  };
  line("surfaces", fmt::format("{}", r.surfaces));
  line("patches, elements", fmt::format("{}, {}", r.patches, r.elements));
  line("method", fmt::format("{}, receivers {}, visibility {}", r.method, r.receivers, r.visibility));
  if (r.links) {
    line("sub-patches", fmt::format("{}", r.links->sub_patches));
    line("links", fmt::format("{} active, {} shadow, {} ghost; E-E {}, E-O {}, O-O {}", r.links->active,
                              r.links->shadow, r.links->ghost, r.links->environment, r.links->mixed, r.links->dynamic));
    line("pairs of patches", fmt::format("{} have links; {} links of {} clusters", r.links->patch_pairs,
                                         r.links->cluster_links, r.links->clusters));
  }
  line("pairs", fmt::format("{:.1f} % facing away, {:.1f} % open, {:.1f} % blocked, {:.1f} % partial",
                            percent(r.pairs.facing_away), percent(r.pairs.open), percent(r.pairs.blocked),
                            percent(r.pairs.partial)));
  line("time", fmt::format("{:.2f} s: form factors {:.2f}, solving {:.2f}, output {:.2f}; {} threads", r.seconds.total,
                           r.seconds.form_factors, r.seconds.solve, r.seconds.output, r.threads));
  line("memory", fmt::format("{:.0f} MiB at most", static_cast<double>(r.peak_memory_bytes) * 0x1p-20));
  line("iterations", fmt::format("{}, residual {:.3g}", r.iterations, r.residual));
  const bool points = r.receivers == "points";
  line("closure defect",
       fmt::format("{} ({} {} measured, {} in contact{})",
                   number_or(r.closure_max_defect, r.measured_points > 0 ? "none, the scene is open" : "not measured"),
                   r.measured_points, points ? "sample points" : "elements", r.covered_points,
                   points ? "" : " or in view of backs"));
  const std::string quadrature = r.links  ? " (thresholds and points of links)"
                                 : points ? " (quadrature of sample points)"
                                          : "";
  line("reciprocity defect", number_or(r.reciprocity_max_defect, "not measured") + quadrature);
  line("energy balance defect", number_or(r.energy_balance_defect, "not measured") + quadrature);
  if (r.rays) {
    line("rays", fmt::format("{} in all; mean standard error of form factors {}", r.rays->cast,
                             number_or(r.rays->mean_standard_error, "unknown")));
    line("error bound", fmt::format("none, as rays prove nothing (solver {:.3g} of B max)", r.solver_error_bound));
  } else {
    line("error bound",
         fmt::format("{:.3g} of B max (solver {:.3g}, form factors {:.3g}){}", r.error_bound, r.solver_error_bound,
                     r.form_factor_error, r.links ? "; over these links, what they miss is not in it" : ""));
  }
  line("B min, B max", fmt::format("{:.12g}, {:.12g} {}", r.B_min, r.B_max, r.unit));
  return text;
}

class Solve {
 public:
  explicit Solve(CLI::App& verb) : verb_(verb) {
    scene_.add_to(verb);
    verb.add_option("--method", method_,
                    "gather: whole matrix; shoot: progressive refinement, without a matrix if need be; hierarchical: "
                    "links between sub-patches")
        ->check(CLI::IsMember({"gather", "shoot", "hierarchical"}))
        ->capture_default_str();
    verb.add_option("--solver", solver_, "How gathering solves")
        ->check(CLI::IsMember({"gauss-seidel", "jacobi", "krylov", "direct"}))
        ->capture_default_str();
    verb.add_option("--receivers", receivers_,
                    "points: one sample point an element; area: the mean over each element, integrated")
        ->check(CLI::IsMember({"points", "area"}))
        ->capture_default_str();
    verb.add_option("--form-factor-tolerance", options_.form_factor_tolerance,
                    "Error of each form factor of --receivers area")
        ->check(positive_number())
        ->capture_default_str();
    rays_.add_to(verb);
    links_.add_to(verb);
    links_.add_clusters_to(verb);
    patch_size_ =
        verb.add_option("--patch-size", options_.mesh.patch_size,
                        "Longest edge of a patch [m]; 0: surfaces as they are; as the scene says unless given")
            ->check(number_between(0))
            ->capture_default_str();
    elements_ = verb.add_option("--elements", options_.mesh.elements_per_edge,
                                "Elements along the edge of a patch; as the scene says unless given")
                    ->check(whole_number_between(1, kMostElements))
                    ->capture_default_str();
    verb.add_option("--tolerance", options_.tolerance, "Bound of the solver's error of B, relative to B max")
        ->check(positive_number())
        ->capture_default_str();
    verb.add_option("--shots", shots_, "Most shots of --method shoot; what is reached then is saved, exit code 4")
        ->check(whole_number_between(0));
    verb.add_option("--time-limit", time_limit_, "Seconds after which to end likewise")->check(positive_number());
    memory_limit_.add_to(verb);
    verb.add_option("--save-every", options_.save_every,
                    "Seconds after which finished form factors, or what has been shot, are saved in the folder; more\n"
                    "where saving takes over 5 % of the time")
        ->check(number_between(0))
        ->capture_default_str();
    verb.add_option("--threads", threads_, "Threads; as many as there are cores unless given")
        ->check(whole_number_between(1, kMostThreads));
    verb.add_option("--seed", options_.seed, "Of rays, and of the pairs whose reciprocity is measured")
        ->check(whole_number_between(0))
        ->capture_default_str();
    verb.add_option("-o,--output", folder_, "Folder for result.json, solution.vtp, solution.ply and image.png");
    verb.add_flag("--json", json_, "Print result.json instead of a summary");
    verb.footer(fmt::format(
        "Exit code 1: the solver did not reach the tolerance, or front and back of a closed scene miss 1 by more than "
        "{} at\n"
        "some sample point (of rays that is reported, no failure). The results are saved all the same. Ctrl-C saves "
        "what has been shot so far, exit code 4.\n"
        "With -o what is finished is kept in the folder, in {}: the same command goes on after Ctrl-C or a crash,\n"
        "another one begins anew. Links and rows of areas by rays are not kept.",
        kLargestClosureDefect, ResultFolder::kUnfinished));
  }

  void run() {
    const auto start = Clock::now();
    const std::size_t threads =
        threads_ ? *threads_ : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    catch_interrupts();
    if (method_ != "hierarchical") links_.refuse_any("hierarchical");
    if (shots_ && method_ != "shoot") throw CLI::ValidationError("--shots", "needs --method shoot");

    const Scene scene = scene_.read();
    if (patch_size_->count() == 0) options_.mesh.patch_size = scene.mesh.patch_size;
    if (elements_->count() == 0) {
      options_.mesh.elements_per_edge = scene.mesh.elements_per_edge;
      options_.mesh.small_patch = scene.mesh.small_patch;
    }
    for (const std::string& warning : scene.warnings) print_warning(warning);
    std::optional<ResultFolder> folder;
    if (!folder_.empty()) folder.emplace(folder_);
    const double loading = seconds_since(start);

    const bool by_links = method_ == "hierarchical";
    std::optional<HierarchicalSolution> linked;
    if (by_links) linked.emplace(solve_links(scene, start));
    const SceneSolution solution = by_links ? std::move(linked->solution) : solve(scene, start);
    Report report = make_report(scene, solution);
    if (by_links) add_links(report, *linked);
    report.method = method_;
    report.threads = static_cast<unsigned>(threads);
    report.seed = options_.seed;
    report.options = given_options(verb_);
    report.seconds.load = loading;

    const auto before_output = Clock::now();
    if (folder) write_solution(folder->draft(), scene, solution);
    report.seconds.output = seconds_since(before_output);
    report.seconds.total = seconds_since(start);
    report.peak_memory_bytes = peak_memory_bytes();
    if (folder) {
      write_report(folder->draft() / "result.json", report);
      folder->publish();
      if (solution.checkpoint && !solution.may_go_on) solution.checkpoint->remove();
    }
    print_results(json_ ? to_json(report) : printable(summary(report)));
    end(report, solution);
  }

 private:
  HierarchicalSolution solve_links(const Scene& scene, Clock::time_point start) {
    for (const char* name : {"--solver", "--form-factor-tolerance", "--elements", "--save-every"}) {
      if (verb_.get_option(name)->count() > 0)
        throw CLI::ValidationError(name, "has no meaning for --method hierarchical");
    }
    if (receivers_ != "points") throw CLI::ValidationError("--receivers", "--method hierarchical receives at points");
    if (rays_.chosen(options_.seed)) throw CLI::ValidationError("--visibility", "--method hierarchical is exact");
    std::optional<double> patch_size;
    if (patch_size_->count() > 0) patch_size = options_.mesh.patch_size;
    std::optional<Checkpoint> of_other_methods;
    if (!folder_.empty()) {
      of_other_methods.emplace(unfinished(), key_of(scene) + "work links\n", Checkpoint::OtherRun::forgotten);
      if (of_other_methods->has_forgotten()) print_warning(of_other_methods->what_was_forgotten());
    }
    HierarchicalOptions how;
    const DynamicScene given = scene_.read_dynamic();
    how.links = links_.chosen(given, patch_size);
    how.links.tolerance = options_.tolerance;
    how.links.mesh.memory_limit = memory_limit_.bytes();
    how.seed = options_.seed;
    how.stop = [this, start] { return interrupted() || (time_limit_ && seconds_since(start) > *time_limit_); };
    std::vector<std::uint8_t> moves(scene.objects.size());
    for (const Event& event : given.events) moves[event.edit.object] = 1;
    return solve_by_links(scene, how, moves);
  }

  static void add_links(Report& report, const HierarchicalSolution& s) {
    report.links = Report::Links{.sub_patches = s.sub_patches,
                                 .active = s.links.active,
                                 .shadow = s.links.shadow,
                                 .ghost = s.links.ghost,
                                 .environment = s.links.environment,
                                 .mixed = s.links.mixed,
                                 .dynamic = s.links.dynamic,
                                 .patch_pairs = s.links.patch_pairs,
                                 .clusters = s.clusters,
                                 .cluster_links = s.cluster_links,
                                 .rounds = s.update.rounds,
                                 .bytes = s.links.bytes,
                                 .cpu_seconds = s.update.cpu_seconds,
                                 .eps1 = s.options.eps1,
                                 .eps2 = s.options.eps2,
                                 .smallest_area = s.options.smallest_area};
  }

  SceneSolution solve(const Scene& scene, Clock::time_point start) {
    static const std::map<std::string, GatherMethod> kSolvers = {{"gauss-seidel", GatherMethod::gauss_seidel},
                                                                 {"jacobi", GatherMethod::jacobi},
                                                                 {"krylov", GatherMethod::krylov},
                                                                 {"direct", GatherMethod::direct}};
    options_.method = method_ == "shoot" ? Method::shoot : Method::gather;
    options_.gather_method = kSolvers.at(solver_);
    options_.receivers = receivers_ == "area" ? Receivers::area : Receivers::points;
    options_.rays = rays_.chosen(options_.seed);
    options_.max_shots = shots_;
    options_.memory_limit = memory_limit_.bytes();
    options_.stop = [this, start] { return interrupted() || (time_limit_ && seconds_since(start) > *time_limit_); };
    options_.stop_is_a_limit = time_limit_.has_value();
    if (!folder_.empty()) {
      options_.checkpoint = unfinished();
      options_.key = key_of(scene);
      options_.warn = print_warning;
    }
    ProgressDisplay display;
    options_.progress = [&](double fraction, std::string_view label) { display.show(fraction, label); };
    return solve_scene(scene, options_);
  }

  std::string unfinished() const { return (std::filesystem::path(folder_) / ResultFolder::kUnfinished).string(); }

  std::string key_of(const Scene& scene) const { return key_of_run(verb_, kOfNoConsequence, scene, options_.mesh); }

  void end(const Report& report, const SceneSolution& solution) const {
    const auto with = [](ExitCode code, const std::string& message) {
      print_message(message);
      throw CLI::RuntimeError(code);
    };
    if (solution.stopped) {
      with(limit_reached,
           fmt::format("stopped after {} {}; {}", report.iterations, method_ == "shoot" ? "shots" : "iterations",
                       folder_.empty() ? "the result is partial"
                       : solution.may_go_on && solution.checkpoint && !solution.checkpoint->parts().empty()
                           ? "the partial result was saved, and the same command goes on"
                           : "the partial result was saved"));
    }
    if (!report.converged) {
      with(check_failed, fmt::format("the solver reached an error bound of {:.3g}, not the tolerance of {:.3g}",
                                     report.solver_error_bound, options_.tolerance));
    }
    if (!report.rays && report.closure_max_defect &&
        !(*report.closure_max_defect <= kLargestClosureDefect + solution.closure_error)) {
      with(check_failed,
           fmt::format("the scene is closed, but front and back miss 1 by {:.3g} at some {}",
                       *report.closure_max_defect, report.receivers == "points" ? "sample point" : "element"));
    }
  }

  CLI::App& verb_;
  CLI::Option *patch_size_ = nullptr, *elements_ = nullptr;
  SceneOptions scene_;
  SolveOptions options_;
  RaySettings rays_;
  LinkSettings links_;
  std::string method_ = "gather", solver_ = "gauss-seidel", receivers_ = "points";
  std::optional<std::uint64_t> shots_;
  std::optional<double> time_limit_;
  MemoryLimit memory_limit_;
  std::optional<std::size_t> threads_;
  std::string folder_;
  bool json_ = false;
};

}  // namespace

void add_solve(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("solve", "Solve the radiosity of a scene");
  verb->callback([solve = std::make_shared<Solve>(*verb)] { solve->run(); });
}

}  // namespace exitance
