// Where does a second of work go best: into finer patches or into better visibility? Error of the solved radiosity,
// that of meshing included, against the whole time.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/plot_note.h"
#include "experiments/power_law.h"
#include "src/output/plot.h"
#include "src/output/run_clock.h"
#include "src/reference/comparison.h"
#include "src/reference/matrix_solution.h"
#include "src/scene/furnished_room.h"
#include "src/scene/reader.h"
#include "src/solve/radiosity_system.h"
#include "tests/places.h"

namespace exitance {
namespace {

struct Subject {
  std::string name;
  Scene scene;
  std::vector<double> patch_sizes;  ///< coarse to fine; the reference's are half of the last, cut into four elements
};

std::vector<Subject> subjects(bool reduced) {
  const Scene box = read_scene(source_file("data/cornell_box_closed.toml"), {});
  if (reduced) return {{"Cornell box (reduced)", box, {0.4, 0.2}}};  // another reference: other errors
  return {{"Cornell box", box, {0.4, 0.2, 0.1, 0.05}}, {"furnished room", make_furnished_room(500, 1), {3, 1.5, 1}}};
}

struct Way {
  std::string name;
  std::optional<RayOptions> rays;
};

std::vector<Way> ways() {
  return {
      {"exact", {}},
      {"16 rays", RayOptions{.rays = 16}},
      {"256 rays", RayOptions{.rays = 256}},
      {"hemisphere of 1024", RayOptions{.rays = 1024, .sampler = Sampler::owen, .estimator = Estimator::hemisphere}},
      {"hemisphere of 16384", RayOptions{.rays = 16384, .sampler = Sampler::owen, .estimator = Estimator::hemisphere}},
      {"centre ray", RayOptions{.estimator = Estimator::centre}}};
}

SceneSolution solution_of(const Scene& scene, const MeshOptions& mesh, const std::optional<RayOptions>& rays) {
  SolveOptions options;
  options.mesh = mesh;
  options.rays = rays;
  options.tolerance = 1e-9;
  return solve_scene(scene, options);
}

SolutionRecord solved(const Scene& scene, const MeshOptions& mesh, const std::optional<RayOptions>& rays) {
  return record_of(scene, solution_of(scene, mesh, rays));
}

/// Wrong answers are not worth timing: on the coarsest mesh what exact visibility sees must be closed, and its
/// radiosity that by 4,096 rays a pair, whose errors are a fifth at most of all that is told apart here.
void verify(const Subject& subject) {
  const MeshOptions mesh{.patch_size = subject.patch_sizes.front()};
  const SceneSolution exact = solution_of(subject.scene, mesh, {});
  if (!exact.closed || !(exact.statistics.closure_max_defect < 1e-12))
    throw std::runtime_error(
        fmt::format("{}: rows miss closure by {}", subject.name, exact.statistics.closure_max_defect));
  const double apart =
      compare(record_of(subject.scene, exact), solved(subject.scene, mesh, RayOptions{.rays = 4096})).error;
  if (!(apart < 1e-3)) throw std::runtime_error(fmt::format("{}: rays are {} from exact B", subject.name, apart));
}

void answer(const Subject& subject, CsvTable& table, Plot& plot) {
  verify(subject);
  const SolutionRecord reference =
      solved(subject.scene, {.patch_size = subject.patch_sizes.back() / 2, .elements_per_edge = 2}, {});
  for (const Way& way : ways()) {
    Curve curve;
    for (const double size : subject.patch_sizes) {
      const RunClock clock;
      std::optional<SolutionRecord> solution;
      try {
        solution = solved(subject.scene, {.patch_size = size}, way.rays);
      } catch (const InvalidSystem& wrong) {  // rows of form factors that sum to too much
        table.rows.push_back({subject.name, way.name, digits(size), "none", "none", "none", "none",
                              fmt::format("{:.3g}", clock.cpu_seconds())});
        fmt::print(stderr, "{}, {}, {} m: {}\n", subject.name, way.name, size, wrong.what());
        continue;
      }
      const double seconds = clock.cpu_seconds();
      const Comparison errors = compare(reference, *solution);
      table.rows.push_back({subject.name, way.name, digits(size), fmt::format("{}", solution->mesh.patches.size()),
                            digits(errors.error), digits(errors.error_worst_1_percent), digits(errors.pointwise_error),
                            fmt::format("{:.3g}", seconds)});
      curve.emplace_back(seconds, errors.error);
      fmt::print(stderr, "{}, {}, {} m: {:.3g} in {:.3g} s\n", subject.name, way.name, size, errors.error, seconds);
    }
    plot.series.push_back({fmt::format("{} (t^{:.2f})", way.name, slope(curve)), curve});
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Error of the radiosity against the time of the whole solution"};
  std::vector<std::string> names;
  app.add_option("--scene", names, "Only these");
  ExperimentOptions wanted(app, "results.csv and plots", "The first scene on coarse meshes",
                           "Compare errors with this table; exit code 1 where they differ");
  CLI11_PARSE(app, argc, argv);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  CsvTable table{{"scene", "visibility", "patch_size", "patches", "error", "error_worst_1_percent", "pointwise_error",
                  "cpu_seconds"},
                 {}};
  std::size_t drawn = 0;
  for (const Subject& subject : subjects(wanted.reduced())) {
    ++drawn;
    if (!names.empty() && std::ranges::find(names, subject.name) == names.end()) continue;
    Plot plot{fmt::format("{}: solved radiosity", subject.name), "seconds of one thread",
              "error (George et al., eq. 7), meshing included"};
    plot.note = plot_note();
    answer(subject, table, plot);
    if (!wanted.writes()) continue;
    table.write(wanted.folder() / "results.csv");
    write_plot(wanted.folder() / fmt::format("plot_{}.svg", drawn), plot);
  }
  return wanted.check(table, 4, 0.1, {"cpu_seconds"});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
