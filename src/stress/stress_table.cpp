#include "src/stress/stress_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "src/output/heat_map.h"

namespace exitance {

std::string stress_csv(const StressReport& report) {
  std::string text =
      "family,magnitude,contender,questions,none,some,all,unjudged,wrong,worst_error,worst_relative_error,worst_margin,"
      "filter,"
      "interval,exact,extended,seconds";
  for (const std::string& name : property_names(*report.kind))
    text += fmt::format(",{0}_tried,{0}_broken,{0}_defect", name);
  text += "\n";
  for (const StressRow& row : report.rows) {
    const StressTally& t = row.tally;
    text += fmt::format("{},{},{},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{},{},{},{},{:.6g}", row.family, row.departure,
                        row.contender, t.questions, t.none, t.some, t.all, t.unjudged, t.wrong, t.worst_error,
                        t.worst_relative_error, t.worst_margin, t.stages.filter, t.stages.interval, t.stages.exact,
                        t.extended, t.seconds);
    for (const PropertyTally& p : t.properties) text += fmt::format(",{},{},{:.6g}", p.tried, p.broken, p.worst_defect);
    text += "\n";
  }
  return text;
}

void write_stress_map(const std::filesystem::path& path, const StressReport& report,
                      const std::vector<std::string>& contenders, const std::string& note) {
  HeatMap map;
  map.title = "Worst error of F (with the number of wrong answers and broken properties)";
  map.scale_label = "|F - truth|, or defect of a property where larger";
  map.note = fmt::format("{} questions; {}", report.questions, note);
  for (const std::string& contender : contenders) {
    HeatMap::Panel panel{contender, {}, {}};
    for (const Departure& d : departures()) panel.columns.push_back(d.name);
    std::string family;
    for (const StressRow& row : report.rows) {
      if (row.contender != contender) continue;
      if (row.family != family) {
        family = row.family;
        panel.rows.emplace_back();
        if (map.panels.empty()) map.row_names.push_back(family);
      }
      double worst = row.tally.worst_error;
      for (const PropertyTally& p : row.tally.properties) worst = std::max(worst, p.worst_defect);
      const std::uint64_t wrong = row.tally.wrong + row.tally.broken();
      panel.rows.back().push_back({worst, wrong == 0 ? "" : std::to_string(wrong)});
    }
    map.panels.push_back(std::move(panel));
  }
  write_heat_map(path, map);
}

}  // namespace exitance
