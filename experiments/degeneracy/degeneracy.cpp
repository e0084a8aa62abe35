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
  std::string kind;
  std::vector<std::string> contenders;
  std::uint64_t count;
};

std::vector<Asked> reduced() {
  return {{"points", {"exact", "plain-double"}, 348}, {"shafts", {"exact"}, 58}, {"shadows", {"exact"}, 29}};
}

std::vector<Asked> whole() {
  return {{"points", {"exact", "plain-double", "rays:1024", "rays:1024:fast", "cgal-epeck"}, 8700},
          {"shafts", {"exact"}, 1740},
          {"shadows", {"exact"}, 348},
          {"pairs", {"one-way"}, 29}};
}

StressReport report_of(const Asked& asked) {
  StressOptions options;
  options.kind = &question_kind_named(asked.kind);
  options.count = asked.count;
  options.failures_kept = 0;
  for (const std::string& name : asked.contenders) options.contenders.push_back(options.kind->contender_named(name));
  return run_stress(options);
}

void add_rows(const StressReport& report, std::uint64_t count, CsvTable& table) {
  for (const StressRow& row : report.rows) {
    const StressTally& t = row.tally;
    if (t.questions == 0) continue;
    double defect = 0;
    for (const PropertyTally& p : t.properties) defect = std::max(defect, p.worst_defect);
    table.rows.push_back({fmt::format("{}", count), report.kind->name, row.family, row.departure, row.contender,
                          fmt::format("{}", t.questions), fmt::format("{}", t.none), fmt::format("{}", t.some),
                          fmt::format("{}", t.all), fmt::format("{}", t.unjudged), fmt::format("{}", t.wrong),
                          fmt::format("{}", t.broken()), digits(t.worst_error), digits(t.worst_relative_error),
                          digits(defect), digits(1e6 * t.seconds / static_cast<double>(t.questions))});
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Degenerate questions, put to exact visibility, to plain doubles, to rays and to CGAL's EPECK"};
  ExperimentOptions wanted(app, "results.csv and plot.svg", "Few questions, and neither rays nor EPECK nor pairs",
                           "Compare counts with this table; exit code 1 where they differ");
  CLI11_PARSE(app, argc, argv);
  CsvTable table{
      {"count", "question", "family", "magnitude", "contender", "questions", "none", "some", "all", "unjudged", "wrong",
       "broken", "worst_error", "worst_relative_error", "worst_defect", "microseconds_each"},
      {}};
  for (const Asked& asked : wanted.reduced() ? reduced() : whole()) {
    const StressReport report = report_of(asked);
    add_rows(report, asked.count, table);
    for (const std::string& name : asked.contenders) {
      const StressTally t = report.total(name);
      fmt::print(stderr, "{}, {}: {} of {} wrong, worst error {:.3g}, {} of {} properties broken, {:.3g} us each\n",
                 asked.kind, name, t.wrong, t.questions, t.worst_error, t.broken(), t.tried(),
                 1e6 * t.seconds / static_cast<double>(t.questions));
    }
    if (wanted.writes() && asked.kind == "points") {
      write_stress_map(wanted.folder() / "plot.svg", report, asked.contenders, plot_note());
    }
  }
  if (wanted.writes()) table.write(wanted.folder() / "results.csv");
  return wanted.check(table, 5, 0, {"worst_error", "worst_relative_error", "worst_defect", "microseconds_each"});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
