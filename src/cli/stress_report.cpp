#include "src/cli/stress_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "src/output/manifest.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;

Json point(const Vec3& v) {
  return {v.x, v.y, v.z};
}

Json loop(const std::vector<Vec3>& vertices) {
  Json json = Json::array();
  for (const Vec3& v : vertices) json.push_back(point(v));
  return json;
}

Json polygon(const Polygon& p) {
  Json json{{"polygon", loop(p.outer)}};
  for (const auto& hole : p.holes) json["holes"].push_back(loop(hole));
  return json;
}

Json occluders_of(const Question& question) {
  Json occluders = Json::array();
  for (const Obstacle& obstacle : question.occluders) {
    if (!obstacle.solid) {
      for (const Polygon& face : obstacle.faces) occluders.push_back(polygon(face));
      continue;
    }
    Json faces = Json::array();
    for (const Polygon& face : obstacle.faces) faces.push_back(loop(face.outer));
    occluders.push_back({{"polyhedron", faces}});
  }
  return occluders;
}

Json one_case(const std::string& id, const Question& question) {
  const bool of_areas = !question.receiver.outer.empty();
  const Json receiver = of_areas ? polygon(question.receiver)
                                 : Json{{"point", point(question.point)}, {"normal", point(question.normal)}};
  return {{"id", id},
          {"kind", of_areas ? "polygon_polygon" : "point_polygon"},
          {"receiver", receiver},
          {"source", polygon(question.source)},
          {"occluders", occluders_of(question)}};
}

Json properties_of(const QuestionKind& kind, const StressTally& tally) {
  const std::vector<std::string> names = property_names(kind);
  Json json = Json::object();
  for (std::size_t p = 0; p < tally.properties.size(); ++p) {
    const PropertyTally& property = tally.properties[p];
    json[names[p]] = {{"tried", property.tried}, {"broken", property.broken}, {"worst_defect", property.worst_defect}};
  }
  return json;
}

Json of_tally(const QuestionKind& kind, const StressTally& t) {
  return {{"questions", t.questions},
          {"seen", {{"none", t.none}, {"some", t.some}, {"all", t.all}}},
          {"unjudged", t.unjudged},
          {"wrong", t.wrong},
          {"classes", t.classes},
          {"worst_value_error", t.worst_error},
          {"worst_relative_error", t.worst_relative_error},
          {"worst_margin", t.worst_margin},
          {"predicates", {{"filter", t.stages.filter}, {"interval", t.stages.interval}, {"exact", t.stages.exact}}},
          {"extended", t.extended},
          {"seconds", t.seconds},
          {"properties_broken", t.broken()},
          {"properties", properties_of(kind, t)}};
}

/// Of one contender, by family, over all departures.
std::vector<std::pair<std::string, std::vector<const StressRow*>>> by_family(const StressReport& report,
                                                                             const std::string& contender) {
  std::vector<std::pair<std::string, std::vector<const StressRow*>>> families;
  for (const StressRow& row : report.rows) {
    if (row.contender != contender || row.tally.questions == 0) continue;
    if (families.empty() || families.back().first != row.family) families.push_back({row.family, {}});
    families.back().second.push_back(&row);
  }
  return families;
}

std::string share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? "-" : fmt::format("{:.3g} %", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
}

std::string family_in_words(const std::string& family, const std::vector<const StressRow*>& rows) {
  StressTally sum;
  std::string wrong;
  for (const StressRow* row : rows) {
    sum.add(row->tally);
    wrong += fmt::format("{:>8}", row->tally.wrong);
  }
  double defect = 0;
  for (const PropertyTally& p : sum.properties) defect = std::max(defect, p.worst_defect);
  const std::uint64_t predicates = sum.stages.filter + sum.stages.interval + sum.stages.exact;
  return fmt::format("  {:<17}{:>9}{}{:>10.2g}{:>10.2g}{:>8}{:>10.2g}{:>9}{:>9}{:>9.1f}\n", family, sum.questions,
                     wrong, sum.worst_error, sum.worst_relative_error, sum.broken(), defect,
                     share(sum.stages.interval, predicates), share(sum.stages.exact, predicates),
                     1e6 * sum.seconds / static_cast<double>(std::max<std::uint64_t>(1, sum.questions)));
}

std::string contender_in_words(const StressReport& report, const std::string& contender) {
  const StressTally sum = report.total(contender);
  std::string text = fmt::format(
      "{}: {} {} ({} see nothing, {} some, {} all, {} not judged), {} wrong, worst error {:.3g}, relative {:.3g}\n",
      contender, sum.questions, report.kind->name, sum.none, sum.some, sum.all, sum.unjudged, sum.wrong,
      sum.worst_error, sum.worst_relative_error);
  std::string departing;
  for (const Departure& d : departures()) departing += fmt::format("{:>8}", d.name);
  if (sum.worst_margin > 0) text += fmt::format("  its largest margin of an F is {:.3g}\n", sum.worst_margin);
  text += fmt::format("  {:<17}{:>9}{}{:>10}{:>10}{:>8}{:>10}{:>9}{:>9}{:>9}\n", "wrong by family", "questions",
                      departing, "error", "relative", "broken", "defect", "interval", "exact", "us each");
  for (const auto& [family, rows] : by_family(report, contender)) text += family_in_words(family, rows);
  if (sum.tried() == 0) return text;
  text += fmt::format("  {:<17}{:>10}{:>8}{:>10}\n", "property", "tried", "broken", "defect");
  const std::vector<std::string> names = property_names(*report.kind);
  for (std::size_t p = 0; p < sum.properties.size(); ++p) {
    const PropertyTally& property = sum.properties[p];
    if (property.tried > 0)
      text += fmt::format("  {:<17}{:>10}{:>8}{:>10.2g}\n", names[p], property.tried, property.broken,
                          property.worst_defect);
  }
  return text;
}

}  // namespace

StressTally StressSummary::total() const {
  StressTally sum;
  for (const std::string& contender : contenders) sum.add(report.total(contender));
  return sum;
}

std::string to_json(const StressSummary& summary) {
  const StressReport& report = summary.report;
  const Manifest build = build_manifest();
  Json json{{"manifest",
             {{"version", build.version},
              {"commit", build.commit},
              {"compiler", build.compiler},
              {"libraries", build.libraries},
              {"seed", summary.seed},
              {"options", summary.options}}}};
  json["rows"] = Json::array();
  for (const StressRow& row : report.rows) {
    Json of_row{{"family", row.family}, {"magnitude", row.departure}, {"contender", row.contender}};
    of_row.update(of_tally(*report.kind, row.tally));
    json["rows"].push_back(of_row);
  }
  json["contenders"] = Json::object();
  for (const std::string& contender : summary.contenders)
    json["contenders"][contender] = of_tally(*report.kind, report.total(contender));
  json["found"] = report.found;
  json["failures"] = Json::array();
  for (const StressFailure& failure : report.failures) {
    json["failures"].push_back({{"question", failure.question},
                                {"contender", failure.contender},
                                {"what", failure.what},
                                {"exception", failure.exception.empty() ? Json(nullptr) : Json(failure.exception)},
                                {"F", failure.F},
                                {"truth", failure.truth ? Json(*failure.truth) : Json(nullptr)}});
  }
  json["not_judged"] = Json::array();
  for (const UnjudgedQuestion& u : report.unjudged)
    json["not_judged"].push_back({{"question", u.question}, {"exception", u.exception}});
  const StressTally total = summary.total();
  json["kind"] = report.kind->name;
  json["seconds"] = report.seconds;
  json["complete"] = report.complete;
  json["resumed_questions"] = report.resumed;
  json["questions"] = report.questions;
  json["wrong"] = total.wrong;
  json["worst_value_error"] = total.worst_error;
  json["properties_broken"] = total.broken();
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string in_words(const StressSummary& summary) {
  std::string text;
  for (const std::string& contender : summary.contenders) text += contender_in_words(summary.report, contender) + "\n";
  for (const StressFailure& failure : summary.report.failures) {
    text += fmt::format("{}: {} of {}: ", failure.contender, failure.what, failure.question);
    text += failure.exception.empty() ? fmt::format("F = {:.17g}", failure.F) : "throws: " + failure.exception;
    text += failure.truth ? fmt::format(", truth {:.17g}\n", *failure.truth) : "\n";
  }
  if (summary.report.found > summary.report.failures.size()) {
    text +=
        fmt::format("{} of the {} wrong answers and broken properties are kept as failures, in failures.json, too\n",
                    summary.report.failures.size(), summary.report.found);
  }
  std::map<std::string, std::uint64_t> exceptions;
  for (const UnjudgedQuestion& u : summary.report.unjudged) ++exceptions[u.exception];
  const bool is_cut = summary.report.unjudged.size() == StressOptions().failures_kept;
  for (const auto& [exception, count] : exceptions) {
    text += fmt::format("not judged, {} times{}: {}\n", count, is_cut ? " of those kept" : "", exception);
  }
  const StressTally total = summary.total();
  text += fmt::format("{} questions in {:.3g} s: {} answers wrong, worst error {:.3g}; {} of {} properties broken\n",
                      summary.report.questions, summary.report.seconds, total.wrong, total.worst_error, total.broken(),
                      total.tried());
  return text;
}

std::string failures_as_cases(const StressReport& report) {
  std::string text = "{\"cases\":[";
  bool is_first = true;
  for (const StressFailure& failure : report.failures) {
    const std::string id = failure.contender + " " + failure.what + " " + failure.question;
    for (std::size_t k = 0; k < failure.asked.size(); ++k) {
      Json asked = one_case(k == 0 ? id : fmt::format("{} form {}", id, k), failure.asked[k]);
      if (k == 0 && failure.truth) asked["truth"] = *failure.truth;
      text += (is_first ? "\n" : ",\n") + asked.dump();
      is_first = false;
    }
  }
  return text + "\n]}\n";
}

}  // namespace exitance
