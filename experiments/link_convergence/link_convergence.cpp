// Do hierarchical solutions come near the truth as their thresholds fall, and how fast?

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/link_scene.h"
#include "experiments/luminance_record.h"
#include "experiments/plot_note.h"
#include "src/output/plot.h"
#include "src/output/run_clock.h"
#include "src/reference/comparison.h"
#include "src/reference/reference_solution.h"
#include "src/scene/reader.h"
#include "tests/places.h"

namespace exitance {
namespace {

struct Question {
  std::string scene, label;
  double smallest_area = 0;  ///< [m²] for all eps2
  double area_per_eps2 = 0;  ///< [m²] to be added in proportion to eps2, as B F of what is small is to its area
  std::vector<double> eps2;  ///< falling
  std::optional<double> B;   ///< the truth where it is the same everywhere; else it is a reference solution
  double error = 0;          ///< that one states
};

std::vector<Question> questions(bool reduced) {
  if (reduced) return {{"furnace_cube", "furnace_cube reduced", 0, 0.08, {0.1, 0.025}, 2.0, 0}};
  return {{"furnace_cube", "furnace_cube", 0, 0.08, {0.1, 0.025, 0.00625}, 2.0, 0},
          {"furnace_cube", "furnace_cube of 384 squares", 0.004, 0, {0.3, 0.1, 0.03}, 2.0, 0},
          {"furnace_cube", "furnace_cube of 6144 squares", 0.0009, 0, {0.3, 0.1, 0.03, 0.01}, 2.0, 0},
          {"box", "box", 0, 18, {3e-2, 1e-2, 3e-3, 1e-3, 3e-4}, {}, 2e-3},
          {"cornell_box_closed", "cornell_box_closed", 0, 0.3, {3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4}, {}, 2e-3}};
}

/// By element of a mesh of one scene, the same B.
SolutionRecord constant(const LinkedRadiosity& links, double B) {
  SolutionRecord record = luminance_record(links);
  std::ranges::fill(record.B, B);
  return record;
}

SolutionRecord reference(const Question& question, const Scene& scene) {
  ReferenceOptions options;
  options.error = question.error;
  const RunClock clock;
  const SolutionRecord record = solve_reference(scene, make_soup(scene), options).record;
  fmt::print(stderr, "{}: reference of {} elements, states {:.3g}, in {:.3g} s\n", question.label,
             record.mesh.elements.size(), record.error.total, clock.cpu_seconds());
  return luminance_record(record);
}

struct Tables {
  CsvTable results{{"scene", "eps2", "smallest_area", "links", "elements", "error", "order", "error_worst_1_percent",
                    "order_worst", "pointwise_error", "order_pointwise", "seconds"},
                   {}};
  Plot plot{"Links against the truth", "eps2", "eq. 7 error"};
};

void converge(const Question& question, Tables& tables) {
  const Scene scene = read_scene(source_file("data/" + question.scene + ".toml"));
  std::optional<SolutionRecord> truth;
  if (!question.B) truth = reference(question, scene);
  PlotSeries all{question.label, {}}, worst{question.label + ", worst 1 %", {}, true},
      pointwise{question.label + ", pointwise", {}};
  for (const double eps2 : question.eps2) {
    LinkOptions options = link_options(eps2, question.smallest_area + question.area_per_eps2 * eps2);
    options.tolerance = 1e-8;
    LinkedRadiosity links(scene, options);
    const LinkUpdate built = links.build();
    const SolutionRecord found = luminance_record(links);
    const Comparison apart = compare(question.B ? constant(links, *question.B) : *truth, found);
    const LinkCounts counts = links.links().count(links.tree(), std::vector<std::uint8_t>(scene.objects.size()));
    const auto order = [&](const PlotSeries& before, double error) {
      if (before.points.empty()) return std::string();
      const auto& [x, y] = before.points.back();
      return fmt::format("{:.2f}", std::log(y / error) / std::log(x / eps2));
    };
    tables.results.rows.push_back({question.label, digits(eps2), digits(options.smallest_area),
                                   fmt::format("{}", counts.links()), fmt::format("{}", found.B.size()),
                                   digits(apart.error), order(all, apart.error), digits(apart.error_worst_1_percent),
                                   order(worst, apart.error_worst_1_percent), digits(apart.pointwise_error),
                                   order(pointwise, apart.pointwise_error), fmt::format("{:.3g}", built.cpu_seconds)});
    all.points.emplace_back(eps2, apart.error);
    worst.points.emplace_back(eps2, apart.error_worst_1_percent);
    pointwise.points.emplace_back(eps2, apart.pointwise_error);
    fmt::print(stderr, "{}, eps2 {}: {} links, {:.3g}, {:.3g}, {:.3g}\n", question.label, eps2, counts.links(),
               apart.error, apart.error_worst_1_percent, apart.pointwise_error);
  }
  tables.plot.series.push_back(all);
  tables.plot.series.push_back(worst);
  if (!question.B) tables.plot.series.push_back(pointwise);
}

int run(int argc, char** argv) {
  CLI::App app{"Hierarchical solutions against the truth as their thresholds fall"};
  ExperimentOptions wanted(app, "results.csv and plot.svg", "The furnace only, with few links",
                           "Compare counts and errors with this table; exit code 1 where they differ");
  CLI11_PARSE(app, argc, argv);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  Tables tables;
  tables.plot.note = plot_note();
  for (const Question& question : questions(wanted.reduced())) {
    converge(question, tables);
    if (!wanted.writes()) continue;
    tables.results.write(wanted.folder() / "results.csv");
    write_plot(wanted.folder() / "plot.svg", tables.plot);
  }
  return wanted.check(tables.results, 2, 0.02, {"order", "order_worst", "order_pointwise", "seconds"});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
