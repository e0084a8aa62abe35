// Does the reference solution converge, does its error figure hold, and do independent routes lead to the same?

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "src/form_factor/pair_form_factor.h"
#include "src/form_factor/visual_events.h"
#include "src/output/plot.h"
#include "src/output/run_clock.h"
#include "src/reference/comparison.h"
#include "src/reference/reference_solution.h"
#include "src/scene/furnished_room.h"
#include "src/scene/reader.h"
#include "src/solve/scene_solution.h"
#include "src/visibility/shadow_rays.h"
#include "tests/places.h"

namespace exitance {
namespace {

struct Question {
  std::string name;
  Scene scene;
  double error = 1e-3;  ///< at which refinement ends
  // Of the independent routes: the mesh that is gathered and shot on, and what its form factors are made to; what
  // those that rays are held against are.
  double solved_patch_size = 0.75, solved_tolerance = 1e-7, pair_tolerance = 1e-9;
};

constexpr std::size_t kAllLevels = std::numeric_limits<std::size_t>::max();

std::vector<Question> questions() {
  return {{"box_on_floor", read_scene(source_file("data/box_on_floor.toml")), 3e-3},
          {"cornell_box_closed", read_scene(source_file("data/cornell_box_closed.toml")), 8e-3},
          {"furnished_room", make_furnished_room(100, 1), 2.5e-2, 0, 1e-3, 1e-8}};
}

/// The levels of one scene against the last of them.
void converge(const Question& question, std::size_t most_levels, CsvTable& table, Plot& plot) {
  const PolygonSoup soup = make_soup(question.scene);
  std::vector<SolutionRecord> records;
  ReferenceOptions options;
  options.error = question.error;
  options.stop = [&] { return records.size() >= most_levels; };
  const RunClock clock;
  std::vector<double> seconds;
  const auto keep = [&](const ReferenceSolution& solution) {
    records.push_back(solution.record);
    seconds.push_back(clock.cpu_seconds());
    fmt::print(stderr, "{}: {} elements, error {:.3g}\n", question.name, solution.record.mesh.elements.size(),
               solution.record.error.total);
  };
  const ReferenceSolution finest = solve_reference(question.scene, soup, options, keep);
  PlotSeries estimated{question.name + ", estimated", {}}, measured{question.name + ", measured", {}, true};
  for (std::size_t k = 0; k < records.size(); ++k) {
    const ReferenceLevel& level = finest.levels[k];
    const Comparison apart = compare(records.back(), records[k]);
    const double elements = level.elements;
    std::string order;
    if (!estimated.points.empty()) {
      order = fmt::format("{:.2f}", 2 * std::log(estimated.points.back().second / level.error.total) /
                                        std::log(elements / estimated.points.back().first));
    }
    estimated.points.emplace_back(elements, level.error.total);
    if (k + 1 < records.size()) measured.points.emplace_back(elements, apart.pointwise_error);
    table.rows.push_back({question.name, fmt::format("{}", k), fmt::format("{}", level.patches),
                          fmt::format("{}", level.elements), digits(level.error.total), digits(level.error.integration),
                          order, digits(apart.pointwise_error), digits(apart.error),
                          fmt::format("{:.1f}", seconds[k])});
  }
  plot.series.push_back(estimated);
  plot.series.push_back(measured);
}

/// Form factors of some pairs of patches by exact visibility and by rays; the difference in standard errors.
void compare_with_rays(const Question& question, int pairs, CsvTable& table) {
  constexpr std::uint32_t kPoints = 1024, kRays = 1024;
  const PolygonSoup soup = make_soup(question.scene);
  const PatchMesh mesh = make_patch_mesh(question.scene, soup, {.patch_size = 0.5});
  const ExchangeScene exchange(soup, mesh);
  PairIntegrator integrator(exchange);
  const ShadowRays rays(soup, {.rays = kRays});
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit;
  int found = 0, outside_3 = 0;
  double sum = 0, largest = 0;
  for (int draw = 0; found < pairs && draw < 100'000; ++draw) {
    const std::size_t i = random() % exchange.size(), j = random() % exchange.size();
    if (i == j || exchange.pieces(i).size() != 1 || exchange.pieces(j).size() != 1) continue;
    const PairFormFactor exact = integrator.form_factor(i, j, {.tolerance = question.pair_tolerance});
    if (exact.kind != PairClass::partial || exact.F < 1e-4) continue;
    const ExchangeScene::Piece &from = exchange.pieces(i)[0], &to = exchange.pieces(j)[0];
    const std::vector<Vec3> loop = corners_of(soup, from.source);
    if (loop.size() != 4) continue;
    const Vec3 normal = soup.facets()[from.source.facet].plane.normal;
    double mean = 0, square = 0;
    for (std::uint32_t k = 0; k < kPoints; ++k) {  // patches are parallelograms: even in both coordinates
      const double s = unit(random), t = unit(random);
      const Vec3 point = loop[0] + s * (loop[1] - loop[0]) + t * (loop[3] - loop[0]);
      const double F = rays.form_factor({point, normal, from.source.facet}, to.source, random()).F;
      mean += F / kPoints;
      square += F * F / kPoints;
    }
    const double error = std::sqrt((square - mean * mean) / (kPoints - 1));
    const double apart = (mean - exact.F) / error;
    sum += apart * apart;
    largest = std::max(largest, std::fabs(apart));
    outside_3 += std::fabs(apart) > 3;
    ++found;
  }
  table.rows.push_back({question.name, "exact against 1e6 rays: pairs", fmt::format("{}", found)});
  table.rows.push_back({question.name, "rms difference [standard errors]", digits(std::sqrt(sum / found))});
  table.rows.push_back({question.name, "largest difference [standard errors]", digits(largest)});
  table.rows.push_back({question.name, "beyond 3 standard errors", fmt::format("{}", outside_3)});
}

/// The same mesh, solved by gathering and by shooting.
void compare_shooting(const Question& question, CsvTable& table) {
  SolveOptions options;
  options.receivers = Receivers::area;
  options.form_factor_tolerance = question.solved_tolerance;
  options.mesh.patch_size = question.solved_patch_size;
  options.tolerance = 1e-10;
  const SceneSolution gathered = solve_scene(question.scene, options);
  options.method = Method::shoot;
  const SceneSolution shot = solve_scene(question.scene, options);
  double apart = 0, largest = 0;
  for (std::size_t k = 0; k < shot.element_B.size(); ++k) {
    apart = std::max(apart, std::fabs(shot.element_B[k] - gathered.element_B[k]));
    largest = std::max(largest, std::fabs(gathered.element_B[k]));
  }
  table.rows.push_back({question.name, "gathering against shooting: max |dB| / max B", digits(apart / largest)});
}

int run(int argc, char** argv) {
  CLI::App app{"Refinement level against error; independent routes"};
  std::vector<std::string> scenes;
  app.add_option("--scene", scenes, "Only these");
  ExperimentOptions wanted(app, "levels.csv, routes.csv and plot.svg", "Two levels of the first scene only",
                           "Compare levels with this table; exit code 1 where they differ");
  CLI11_PARSE(app, argc, argv);
  CsvTable levels{{"scene", "level", "patches", "elements", "estimated", "form_factors", "order", "to_finest_pointwise",
                   "to_finest_means", "cpu_seconds"},
                  {}};
  CsvTable routes{{"scene", "route", "value"}, {}};
  Plot plot{"Error of reference solutions (eq. 7, pointwise)", "elements", "error", {}};
  const auto write = [&] {  // after each scene, as they take long
    if (!wanted.writes()) return;
    const std::filesystem::path folder = wanted.folder();
    levels.write(folder / "levels.csv");
    routes.write(folder / "routes.csv");
    write_plot(folder / "plot.svg", plot);
  };
  for (const Question& question : questions()) {
    if (!scenes.empty() && std::ranges::find(scenes, question.name) == scenes.end()) continue;
    if (!wanted.reduced()) {
      compare_shooting(question, routes);
      compare_with_rays(question, 30, routes);
    }
    converge(question, wanted.reduced() ? 2 : kAllLevels, levels, plot);
    write();
    if (wanted.reduced()) break;
  }
  // The last level here is not the last one there: distances to it differ. What errors of form factors do is no more
  // than an estimate of how much better they could be.
  return wanted.check(levels, 2, 1e-2, {"form_factors", "to_finest_pointwise", "to_finest_means", "cpu_seconds"});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
