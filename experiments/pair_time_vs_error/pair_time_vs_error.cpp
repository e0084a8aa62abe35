// What does accuracy cost? Pairs of patches at tolerances from 1e-3 to 1e-12 against known form factors.

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "src/form_factor/pair_form_factor.h"
#include "src/output/plot.h"
#include "tests/form_factor/exchange_scenes.h"
#include "tests/places.h"

namespace exitance {
namespace {

constexpr std::array kScenes = {"box_room", "box_on_uncut_floor", "turned_cubes", "thin_plates", "sliver_fan"};

struct TruePair {
  std::uint32_t i = 0, j = 0;
  double F = 0, error = 0;
};

/// Of lines "i,j,kind,F,error"; none where there is no file.
std::vector<TruePair> read_truth(const std::string& scene) {
  std::ifstream in(source_file("tests/form_factor/truth/" + scene + ".csv"));
  std::vector<TruePair> pairs;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] < '0' || line[0] > '9') continue;
    std::istringstream row(line);
    TruePair pair;
    std::string kind;
    char comma = 0;
    row >> pair.i >> comma >> pair.j >> comma;
    std::getline(row, kind, ',');
    row >> pair.F >> comma >> pair.error;
    if (!row) throw std::runtime_error(scene + ".csv: malformed: " + line);
    pairs.push_back(pair);
  }
  return pairs;
}

/// Of the processor: what else runs on the machine counts little.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Measured {
  double largest_error = 0, mean_error = 0, seconds = 0;
  std::uint64_t points = 0;
  int beyond = 0;  ///< errors that F_error does not cover
};

Measured measure(const ExchangeScene& exchange, const std::vector<TruePair>& truth, double tolerance) {
  PairIntegrator integrator(exchange);
  Measured m;
  const double start = thread_seconds();
  std::vector<PairFormFactor> found;
  for (const TruePair& pair : truth) found.push_back(integrator.form_factor(pair.i, pair.j, {.tolerance = tolerance}));
  m.seconds = thread_seconds() - start;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double error = std::fabs(found[k].F - truth[k].F);
    m.largest_error = std::max(m.largest_error, error);
    m.mean_error += error / static_cast<double>(truth.size());
    m.beyond += error > found[k].F_error + truth[k].error;
    m.points += found[k].points;
  }
  return m;
}

void answer(const std::string& name, bool reduced, CsvTable& table, Plot& plot) {
  const std::vector<TruePair> truth = read_truth(name);
  if (truth.empty()) {
    fmt::print(stderr, "{}: no truth is stored; left out\n", name);
    return;
  }
  const KnownScene known = known_scene(name);
  const PolygonSoup soup = make_soup(known.scene);
  const PatchMesh mesh = make_patch_mesh(known.scene, soup, {.patch_size = known.patch_size});
  const ExchangeScene exchange(soup, mesh);
  PlotSeries series{name, {}};
  for (int digits_wanted = 3; digits_wanted <= (reduced ? 6 : 12); digits_wanted += reduced ? 3 : 1) {
    const double tolerance = std::pow(10, -digits_wanted);
    const Measured m = measure(exchange, truth, tolerance);
    const double each = m.seconds / static_cast<double>(truth.size());
    series.points.emplace_back(each, m.largest_error);
    table.rows.push_back({name, fmt::format("1e-{:02}", digits_wanted), fmt::format("{}", truth.size()),
                          digits(m.largest_error), digits(m.mean_error), fmt::format("{}", m.beyond),
                          fmt::format("{}", m.points), fmt::format("{:.3g}", each)});
    fmt::print(stderr, "{} {:g}: {:.2g} at most, {:.3g} s a pair\n", name, tolerance, m.largest_error, each);
  }
  plot.series.push_back(series);
}

/// Rows whose largest error is ten times what was expected, or more.
std::vector<std::string> worse_than(const CsvTable& found, const CsvTable& expected) {
  std::vector<std::string> lines;
  for (const auto& row : found.rows) {
    const auto match = std::ranges::find_if(
        expected.rows, [&](const auto& other) { return other[0] == row[0] && other[1] == row[1]; });
    const double error = std::stod(row[3]);
    if (match == expected.rows.end()) {
      lines.push_back(fmt::format("{} {}: not expected", row[0], row[1]));
    } else if (error > std::max(10 * std::stod((*match)[3]), 1e-14)) {
      lines.push_back(fmt::format("{} {}: error {}, expected {}", row[0], row[1], row[3], (*match)[3]));
    }
  }
  return lines;
}

int run(int argc, char** argv) {
  CLI::App app{"Error against time of form factors between patches"};
  ExperimentOptions wanted(app, "results.csv and plot.svg", "The first scene at two tolerances only",
                           "Compare errors with this table; exit code 1 where they are ten times larger");
  CLI11_PARSE(app, argc, argv);
  CsvTable table{
      {"scene", "tolerance", "pairs", "largest_error", "mean_error", "beyond_F_error", "points", "seconds_a_pair"}, {}};
  Plot plot{"Form factors between patches", "seconds a pair (one thread)", "largest error", {}};
  for (const char* name : kScenes) {
    answer(name, wanted.reduced(), table, plot);
    if (wanted.writes()) {  // after each scene, as they take long
      table.write(wanted.folder() / "results.csv");
      write_plot(wanted.folder() / "plot.svg", plot);
    }
    if (wanted.reduced()) break;
  }
  return wanted.check([&](const CsvTable& expected) { return worse_than(table, expected); });
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
