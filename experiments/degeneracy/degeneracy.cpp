// Who is right where everything touches, coincides or lies in line?

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/plot_note.h"
#include "src/stress/stress_table.h"

namespace exitance {
namespace {

struct Asked {
  std::vector<std::string> contenders;
  std::uint64_t count;
};

void add_rows(const StressReport& report, std::uint64_t count, CsvTable& table) {
  for (const StressRow& row : report.rows) {
    const StressTally& t = row.tally;
    double defect = 0;
    for (const PropertyTally& p : t.properties) defect = std::max(defect, p.worst_defect);
    table.rows.push_back({fmt::format("{}", count), row.family, row.departure, row.contender,
                          fmt::format("{}", t.questions), fmt::format("{}", t.none), fmt::format("{}", t.some),
                          fmt::format("{}", t.all), fmt::format("{}", t.wrong), fmt::format("{}", t.broken()),
                          digits(t.worst_error), digits(t.worst_relative_error), digits(defect),
                          digits(1e6 * t.seconds / static_cast<double>(t.questions))});
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Degenerate questions, put to exact visibility, to plain doubles, to rays and to CGAL's EPECK"};
  ExperimentOptions wanted(app, "results.csv and plot.svg", "Few questions, and neither rays nor EPECK",
                           "Compare counts with this table; exit code 1 where they differ");
  CLI11_PARSE(app, argc, argv);
  const Asked asked = wanted.reduced()
                          ? Asked{{"exact", "plain-double"}, 348}
                          : Asked{{"exact", "plain-double", "rays:1024", "rays:1024:fast", "cgal-epeck"}, 8700};
  StressOptions options;
  options.count = asked.count;
  options.failures_kept = 0;
  for (const std::string& name : asked.contenders) options.contenders.push_back(point_contender_named(name));
  const StressReport report = run_stress(options);
  CsvTable table{{"count", "family", "magnitude", "contender", "questions", "none", "some", "all", "wrong", "broken",
                  "worst_error", "worst_relative_error", "worst_defect", "microseconds_each"},
                 {}};
  add_rows(report, asked.count, table);
  for (const std::string& name : asked.contenders) {
    const StressTally t = report.total(name);
    fmt::print(stderr, "{}: {} of {} wrong, worst error {:.3g}, {} of {} properties broken, {:.3g} us each\n", name,
               t.wrong, t.questions, t.worst_error, t.broken(), t.tried(),
               1e6 * t.seconds / static_cast<double>(t.questions));
  }
  if (wanted.writes()) {
    table.write(wanted.folder() / "results.csv");
    write_stress_map(wanted.folder() / "plot.svg", report, asked.contenders, plot_note());
  }
  return wanted.check(table, 4, 0, {"worst_error", "worst_relative_error", "worst_defect", "microseconds_each"});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
