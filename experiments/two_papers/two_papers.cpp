// What does an edit cost by redistribution (George, Sillion and Greenberg) and over hierarchical links (Feng, Chang,
// Shen and Yang) where both are to leave the same error?

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/link_scene.h"
#include "experiments/luminance_record.h"
#include "experiments/plot_note.h"
#include "src/dynamic/edit_session.h"
#include "src/output/plot.h"
#include "src/output/run_clock.h"
#include "src/reference/comparison.h"
#include "src/reference/reference_solution.h"

namespace exitance {
namespace {

struct Refinement {
  double eps2 = 0;           ///< share of the brightest E
  double smallest_area = 0;  ///< [m²]
};

/// A scene, whose first event is the edit, and what the methods are swept over.
struct Question {
  std::string scene, label;
  MeshOptions measured;                 ///< over whose elements errors are taken
  std::vector<MeshOptions> meshes;      ///< of redistribution
  std::vector<Refinement> refinements;  ///< of links
  std::vector<double> B_eps;            ///< shares of eps2
  /// What is taken for the truth: a reference solution that states this error, or, where it is 0, links of this
  /// refinement, by so many points along an edge of a sub-patch.
  double reference_error = 0;
  Refinement truth = {};
  unsigned truth_points = 3;
  double most_seconds = 600;  ///< of the processor, for one sweep over shots
};

MeshOptions squares(double patch_size, double small_patch, std::uint32_t elements = 2) {
  MeshOptions mesh;
  mesh.patch_size = patch_size;
  mesh.elements_per_edge = elements;
  mesh.small_patch = small_patch;
  return mesh;
}

Refinement times(double share, const Refinement& refinement) {
  return {share * refinement.eps2, share * refinement.smallest_area};
}

std::vector<Question> questions(bool reduced) {
  const std::vector<double> B_eps{0.01, 0.03, 0.1, 0.3, 1};
  const Refinement box{3.1e-3, 0.012}, hall{1.4e-3, 0.015}, cube{3e-3, 0.01}, robot{4e-3, 0.06};
  if (reduced) {
    return {
        {"box", "box reduced", squares(1.5, 0), {squares(1.5, 0)}, {times(16, box)}, {0.3, 1}, 0, times(4, box), 2}};
  }
  return {{"cube",
           "cube",
           squares(0.8, 0.03, 4),
           {squares(0.8, 0.12), squares(0.4, 0.03), squares(0.2, 0.0075)},
           {times(16, cube), times(4, cube), cube, times(0.25, cube)},
           B_eps,
           5e-3},
          {"box",
           "box",
           squares(0.8, 0, 4),
           {squares(0.8, 0), squares(0.4, 0), squares(0.2, 0)},
           {times(16, box), times(4, box), box, times(0.25, box)},
           B_eps,
           2e-3},
          {"hall",
           "hall",
           squares(0.8, 0.03, 4),
           {squares(0.8, 0.12), squares(0.4, 0.03)},
           {times(16, hall), times(4, hall), hall},
           B_eps,
           0,
           times(0.25, hall)},
          {"robot",
           "robot",
           squares(0.514, 0.0056, 1),
           {squares(0.514, 0.0056, 1)},
           {robot},
           {0.3, 3},
           0,
           times(0.25, robot),
           2,
           1200}};
}

LinkOptions options_of(const Refinement& refinement, double of_eps2, unsigned points) {
  LinkOptions options = link_options(refinement.eps2, refinement.smallest_area);
  options.B_eps = of_eps2 * refinement.eps2;
  options.points_per_edge = points;
  return options;
}

struct Tables {
  CsvTable results{
      {"scene", "method", "mesh", "step", "elements", "links", "seconds", "error", "error_worst_1_percent"}, {}};
  CsvTable equal{
      {"scene", "over", "error", "redistribution", "hvt", "hvt_peu", "redistribution_by", "hvt_by", "hvt_peu_by"}, {}};
  std::map<std::string, Plot> plots;  ///< by scene
};

/// What was reached in which time by which knobs.
struct Reached {
  std::string knobs;
  double seconds = 0;
  ConvergenceError error;
};

class Contest {
 public:
  Contest(const Question& question, Tables& tables) : question_(question), tables_(tables), scene_(question.scene) {
    SessionOptions options;
    options.mesh = question.measured;
    EditSession measured(scene_.given.scene, options);
    measured.work({});
    const std::vector<double> was = luminance_of(measured.solution());
    for (const Edit& edit : scene_.edits) measured.apply(edit);
    measured_ = luminance_record(measured.solution());
    for (const std::uint32_t e : present_elements(measured.solution().version()))
      was_.push_back(e < was.size() ? was[e] : 0);
    elements_.resize(was_.size());
    std::iota(elements_.begin(), elements_.end(), 0);

    const RunClock clock;
    const SolutionRecord truth = true_solution(measured.scene().scene());
    truth_ = compare(truth, measured_).Y_reference;
    fmt::print(stderr, "{}: errors over {} elements; truth of {} elements in {:.3g} s\n", question.label, was_.size(),
               truth.B.size(), clock.cpu_seconds());
  }

  void run() {
    Plot plot{fmt::format("{}: what an edit costs", scene_.given.scene.name), "processor seconds",
              "eq. 7 error on the 1 % most changed"};
    plot.note = plot_note();
    record({"nothing", "", ""}, 0, error_of(was_));
    for (const MeshOptions& mesh : question_.meshes) redistribute(mesh, plot);
    for (const Refinement& refinement : question_.refinements) update_links(refinement, plot);
    tables_.plots[question_.label] = plot;
    for (const double goal : {0.05, 0.01, 1e-3}) {
      for (const bool worst : {false, true}) compare_at(goal, worst);
    }
  }

 private:
  SolutionRecord true_solution(const Scene& scene) const {
    if (question_.reference_error > 0) {
      ReferenceOptions options;
      options.error = question_.reference_error;
      return luminance_record(solve_reference(scene, make_soup(scene), options).record);
    }
    LinkedRadiosity links(scene, options_of(question_.truth, 0, question_.truth_points));
    links.build();
    return luminance_record(links);
  }

  struct Knobs {
    std::string method, mesh, step;
    std::size_t elements = 0, links = 0;
  };

  /// Eq. 7 over the elements of the mesh that is the same for all.
  ConvergenceError error_of(const std::vector<double>& Y) const {
    return convergence_error(
        elements_, [&](std::uint32_t e) { return measured_.mesh.elements[e].area; }, 1, truth_, was_, Y);
  }
  ConvergenceError error_of(const SolutionRecord& record) const {
    return error_of(compare(record, measured_).Y_reference);
  }

  void record(const Knobs& knobs, double seconds, const ConvergenceError& error) {
    const auto or_none = [](std::size_t n) { return n > 0 ? fmt::format("{}", n) : std::string(); };
    tables_.results.rows.push_back({question_.label, knobs.method, knobs.mesh, knobs.step, or_none(knobs.elements),
                                    or_none(knobs.links), fmt::format("{:.3g}", seconds), digits(error.all),
                                    digits(error.worst_1_percent)});
    if (knobs.method == "nothing") return;
    const bool shots = knobs.method.starts_with("strategy");
    const std::string by = shots ? fmt::format("{} patches {} shots {}", knobs.method, knobs.mesh, knobs.step)
                           : knobs.method == "hvt" ? fmt::format("eps2 {}", knobs.mesh)
                                                   : fmt::format("eps2 {} B_eps {}", knobs.mesh, knobs.step);
    reached_[shots ? "redistribution" : knobs.method].push_back({by, seconds, error});
  }

  /// One mesh, after each number of shots.
  void redistribute(const MeshOptions& mesh, Plot& plot) {
    SessionOptions options;
    options.mesh = mesh;
    options.tolerance = 1e-5;
    options.object_terms = ObjectTerms::shot;  // as the paper does
    const RunClock whole;
    EditSession before(scene_.given.scene, options);
    before.work({});
    fmt::print(stderr, "{}: before, patches of {} m, in {:.3g} s\n", question_.label, mesh.patch_size,
               whole.cpu_seconds());
    for (const auto& [strategy, name] :
         {std::pair{Strategy::redistribute_first, "strategy 1"}, std::pair{Strategy::interleave, "strategy 2"}}) {
      options.strategy = strategy;
      EditSession session(before, options);
      RunClock clock;
      for (const Edit& edit : scene_.edits) session.apply(edit);
      double seconds = clock.cpu_seconds();
      Knobs knobs{name, digits(mesh.patch_size), "", session.solution().version().present_elements()};
      PlotSeries series{fmt::format("{}, patches of {} m", name, mesh.patch_size), {}};
      std::uint64_t shots = 0;
      for (bool finished = false; !finished && seconds < question_.most_seconds;) {
        Budget budget;
        budget.shots = std::max<std::uint64_t>(1, shots / 3);
        clock = RunClock();
        const SessionWork done = session.work(budget);
        seconds += clock.cpu_seconds();
        shots += done.shots();
        finished = done.finished;
        const ConvergenceError left = error_of(luminance_record(session.solution()));
        knobs.step = fmt::format("{}", shots);
        record(knobs, seconds, left);
        series.points.emplace_back(seconds, left.worst_1_percent);
      }
      plot.series.push_back(series);
    }
  }

  /// One refinement by HVT, and by HVT + PEU with each threshold.
  void update_links(const Refinement& refinement, Plot& plot) {
    PlotSeries series{fmt::format("HVT + PEU, HVT; eps2 {:.2g}", refinement.eps2), {}};
    std::vector<std::optional<double>> thresholds(question_.B_eps.rbegin(), question_.B_eps.rend());
    thresholds.emplace_back();
    for (const std::optional<double> threshold : thresholds) {
      LinkedRadiosity links(scene_.given.scene, options_of(refinement, threshold.value_or(0), 2));
      links.build();
      const LinkUpdate done = links.update(scene_.edits, threshold ? LinkMethod::hvt_peu : LinkMethod::hvt);
      const SolutionRecord found = luminance_record(links);
      const LinkCounts counts = links.links().count(links.tree(), scene_.moves);
      const Knobs knobs{threshold ? "hvt_peu" : "hvt", digits(refinement.eps2),
                        threshold ? digits(*threshold * refinement.eps2) : "", found.B.size(), counts.links()};
      const ConvergenceError left = error_of(found);
      record(knobs, done.cpu_seconds, left);
      series.points.emplace_back(done.cpu_seconds, left.worst_1_percent);
      fmt::print(stderr, "{}, {} {} {}: {:.4f} s, {:.3g}, {:.3g}\n", question_.label, knobs.method, knobs.mesh,
                 knobs.step, done.cpu_seconds, left.all, left.worst_1_percent);
    }
    plot.series.push_back(series);
  }

  /// The soonest that each method has an error.
  void compare_at(double goal, bool worst) {
    std::vector<std::string> seconds, by;
    for (const char* method : {"redistribution", "hvt", "hvt_peu"}) {
      const Reached* soonest = nullptr;
      for (const Reached& r : reached_[method]) {
        const double error = worst ? r.error.worst_1_percent : r.error.all;
        if (error <= goal && (soonest == nullptr || r.seconds < soonest->seconds)) soonest = &r;
      }
      seconds.push_back(soonest != nullptr ? fmt::format("{:.3g}", soonest->seconds) : "none");
      by.push_back(soonest != nullptr ? soonest->knobs : "none");
    }
    std::vector<std::string> row{question_.label, worst ? "worst 1 %" : "all", digits(goal)};
    row.insert(row.end(), seconds.begin(), seconds.end());
    row.insert(row.end(), by.begin(), by.end());
    tables_.equal.rows.push_back(row);
  }

  const Question& question_;
  Tables& tables_;
  LinkScene scene_;
  SolutionRecord measured_;              ///< its mesh is that over whose elements errors are taken
  std::vector<std::uint32_t> elements_;  ///< of that
  std::vector<double> truth_, was_;      ///< by element: after the edit, and, to find what changes most, before
  std::map<std::string, std::vector<Reached>> reached_;
};

int run(int argc, char** argv) {
  CLI::App app{"An edit by redistribution and over links, at equal error"};
  ExperimentOptions wanted(app, "results.csv, equal_error.csv and a plot a scene", "Box only, coarse",
                           "Compare errors with this table; exit code 1 where they differ");
  std::vector<std::string> scenes{"cube", "box", "hall"};
  app.add_option("--scenes", scenes, "Of cube, box, hall and robot")->delimiter(',')->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  Tables tables;
  for (const Question& question : questions(wanted.reduced())) {
    if (!wanted.reduced() && std::ranges::find(scenes, question.scene) == scenes.end()) continue;
    Contest(question, tables).run();
    if (!wanted.writes()) continue;
    tables.results.write(wanted.folder() / "results.csv");
    tables.equal.write(wanted.folder() / "equal_error.csv");
    for (const auto& [scene, plot] : tables.plots)
      write_plot(wanted.folder() / fmt::format("plot_{}.svg", scene), plot);
  }
  return wanted.check(tables.results, 4, 0.02, {"seconds"});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
