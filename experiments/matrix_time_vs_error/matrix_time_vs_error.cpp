// What do whole matrices of form factors cost, and how wrong are they? Exact visibility at several tolerances against
// rays at several numbers of them.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/matrix_time_vs_error/matrix_truth.h"
#include "experiments/plot_note.h"
#include "experiments/power_law.h"
#include "src/output/plot.h"
#include "src/output/run_clock.h"
#include "src/reference/contender.h"
#include "src/reference/matrix_comparison.h"
#include "src/scene/furnished_room.h"
#include "src/scene/reader.h"
#include "tests/places.h"

namespace exitance {
namespace {

struct Subject {
  std::string name;
  Scene scene;
  double patch_size = 0;           ///< [m]; 0: surfaces as they are
  std::vector<double> tolerances;  ///< of exact visibility, falling
  double truth = 1e-10;            ///< tolerance of what all are compared with
  std::uint32_t most_rays_a_pair = 1024;
};

std::vector<Subject> subjects() {
  const auto read = [](const char* file) { return read_scene(source_file(std::string("data/") + file), {}); };
  const std::vector<double> all{1e-3, 1e-5, 1e-7, 1e-9};
  return {{"box room 1 m", read("box_on_floor.toml"), 1, all},
          {"box room 1/3 m", read("box_on_floor.toml"), 0.3334, all},
          {"Cornell box 0.1 m", read("cornell_box_closed.toml"), 0.1, all},
          {"furnished room of 100", make_furnished_room(100, 1), 0, {1e-2, 1e-3, 1e-4}, 1e-5, 4096},
          {"another furnished room of 100", make_furnished_room(100, 2), 0, {1e-2, 1e-3}, 1e-4, 4096},
          {"box room 1/7 m", read("box_on_floor.toml"), 0.1429, {1e-3, 1e-5, 1e-7}, 1e-8, 64}};
}

struct Series {
  std::string name;
  std::vector<Contender> contenders;
};

Series exact_series(const std::vector<double>& tolerances) {
  Series series{"exact", {}};
  for (const double tolerance : tolerances) {
    PairOptions pairs;
    pairs.tolerance = tolerance;
    series.contenders.push_back({fmt::format("{:g}", tolerance), pairs});
  }
  return series;
}

Series ray_series(const std::string& name, const RayOptions& options, const std::vector<std::uint32_t>& numbers) {
  Series series{name, {}};
  for (const std::uint32_t n : numbers) {
    RayOptions rays = options;
    rays.rays = n;
    series.contenders.push_back({fmt::format("{}", n), rays});
  }
  return series;
}

std::vector<Series> all_series(const Subject& subject, bool reduced) {
  std::vector<std::uint32_t> of_pairs, of_rows{1024, 4096, 16384, 65536};
  for (std::uint32_t n = 4; n <= (reduced ? 64 : subject.most_rays_a_pair); n *= 4) of_pairs.push_back(n);
  if (reduced) of_rows.resize(1);
  return {exact_series(subject.tolerances),
          ray_series("kernel random", {.sampler = Sampler::random}, of_pairs),
          ray_series("kernel sobol", {.sampler = Sampler::sobol}, of_pairs),
          ray_series("kernel owen", {.sampler = Sampler::owen}, of_pairs),
          ray_series("fraction sobol", {.estimator = Estimator::fraction}, of_pairs),
          ray_series("hemisphere owen", {.sampler = Sampler::owen, .estimator = Estimator::hemisphere}, of_rows),
          ray_series("one centre ray", {.estimator = Estimator::centre}, {1})};
}

/// Exact form factors and single rays claim no standard error.
std::string or_none(const std::optional<double>& value) {
  return value ? digits(*value) : "none";
}

void answer(const Subject& subject, bool reduced, CsvTable& table, CsvTable& truths, Plot& plot) {
  const PolygonSoup soup = make_soup(subject.scene);
  const PatchMesh mesh = make_patch_mesh(subject.scene, soup, {.patch_size = subject.patch_size});
  const ExchangeScene exchange(soup, mesh);
  const RunClock clock;
  const KnownMatrix known = known_matrix(exchange, subject.truth);
  truths.rows.push_back({subject.name, fmt::format("{}", exchange.size()), digits(subject.truth),
                         fmt::format("{}", known.by_points), digits(known.largest_error), digits(known.rms_error),
                         fmt::format("{:.3g}", clock.cpu_seconds())});
  fmt::print(stderr, "{}: {} patches, errors of the truth at most {:.2g}, rms {:.2g}\n", subject.name, exchange.size(),
             known.largest_error, known.rms_error);
  plot.title = fmt::format("{}: {} patches", subject.name, exchange.size());
  for (const Series& series : all_series(subject, reduced)) {
    Curve curve, of_number;
    for (const Contender& contender : series.contenders) {
      const ContenderRun made = run(contender, mesh, exchange, {}, {});
      const MatrixComparison errors = compare(known.truth, made.F, 0, made.standard_errors);
      const auto of = [&](PairClass kind) { return errors.of_class[static_cast<std::size_t>(kind)]; };
      table.rows.push_back(
          {subject.name, series.name, contender.name, fmt::format("{}", exchange.size()), digits(errors.facing.rms),
           digits(errors.facing.largest), digits(errors.facing.largest_of_999), digits(of(PairClass::open).largest),
           digits(of(PairClass::partial).rms), or_none(made.standard_error), or_none(errors.beyond_3_standard_errors),
           fmt::format("{}", made.rays), fmt::format("{}", made.queries), fmt::format("{:.3g}", made.cpu_seconds)});
      curve.emplace_back(made.cpu_seconds, errors.facing.rms);
      of_number.emplace_back(std::stod(contender.name), errors.facing.rms);
      fmt::print(stderr, "{}, {} {}: {:.2g} in {:.3g} s\n", subject.name, series.name, contender.name,
                 errors.facing.rms, made.cpu_seconds);
    }
    const bool by_rays = series.contenders.front().maker() != Maker::exact && curve.size() > 1;
    plot.series.push_back({by_rays ? fmt::format("{} (N^{:.2f})", series.name, slope(of_number)) : series.name, curve});
  }
}

int ask(int argc, char** argv) {
  CLI::App app{"Error against time of whole matrices of form factors"};
  std::vector<std::string> names;
  app.add_option("--scene", names, "Only these");
  ExperimentOptions wanted(app, "results.csv, truth.csv and plots", "The first scene, few rays",
                           "Compare errors with this table; exit code 1 where they differ");
  CLI11_PARSE(app, argc, argv);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  CsvTable table{{"scene", "method", "rays_or_tolerance", "patches", "rms_error", "largest_error", "largest_of_999",
                  "largest_of_open", "rms_of_partial", "mean_standard_error", "beyond_3_standard_errors", "rays",
                  "queries", "cpu_seconds"},
                 {}};
  CsvTable truths{{"scene", "patches", "tolerance", "pairs_by_points", "largest_error", "rms_error", "cpu_seconds"},
                  {}};
  std::size_t drawn = 0;
  for (const Subject& subject : subjects()) {
    ++drawn;
    if (!names.empty() && std::ranges::find(names, subject.name) == names.end()) continue;
    Plot plot{subject.name, "seconds of one thread", "rms error of pairs that face each other"};
    plot.note = plot_note();
    answer(subject, wanted.reduced(), table, truths, plot);
    if (wanted.writes()) {  // after each scene, as they take long
      table.write(wanted.folder() / "results.csv");
      truths.write(wanted.folder() / "truth.csv");
      write_plot(wanted.folder() / fmt::format("plot_{}.svg", drawn), plot);
    }
    if (wanted.reduced()) break;
  }
  return wanted.check([&](const CsvTable& expected) {
    // What exact visibility errs by is rounding and luck; it must only be as small as it says.
    std::vector<std::string> wrong;
    for (const auto& row : table.rows) {
      if (row[1] == "exact" && std::stod(row[5]) > std::stod(row[2])) wrong.push_back(row[2] + " is not reached");
    }
    std::erase_if(table.rows, [](const auto& row) { return row[1] == "exact"; });
    for (const std::string& line :
         differences(table, expected, 4, 0.25,
                     {"largest_error", "largest_of_999", "largest_of_open", "queries", "cpu_seconds"}))
      wrong.push_back(line);
    return wrong;
  });
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::ask(argc, argv);
}
