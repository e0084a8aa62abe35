#include "src/stress/question_kind.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "src/stress/pair_question.h"
#include "src/stress/point_contender.h"
#include "src/stress/shadow_question.h"
#include "src/stress/shaft_question.h"
#include "src/stress/visibility_oracle.h"

namespace exitance {
namespace {

Contender shaft_contender(const std::string& name) {
  if (name != "exact") throw std::invalid_argument(name + ": no contender for shafts; there is exact");
  return {name, [](const Question& q, std::uint64_t) { return ask_shafts(q); }, true, true};
}

Contender shadow_contender(const std::string& name) {
  if (name != "exact") throw std::invalid_argument(name + ": no contender for shadows; there is exact");
  return {name, [](const Question& q, std::uint64_t) { return ask_shadows(q); }, true, true};
}

Contender pair_contender(const std::string& name) {
  if (name == "exact") return {name, [](const Question& q, std::uint64_t) { return ask_pair(q, true); }, true, true};
  if (name == "one-way") return {name, [](const Question& q, std::uint64_t) { return ask_pair(q, false); }, true, true};
  throw std::invalid_argument(name + ": no contender for pairs; there are exact and one-way");
}

Truth point_truth(const Question& question) {
  const OracleAnswer truth = oracle_form_factor(question);
  return {truth.visible_area == 0 ? Truth::Seen::none
          : truth.is_all_seen     ? Truth::Seen::all
                                  : Truth::Seen::some,
          static_cast<double>(truth.F), [truth](const Opinion& opinion) { return judge(opinion, truth); }};
}

}  // namespace

std::span<const QuestionKind> question_kinds() {
  static const std::array kKinds{
      QuestionKind{"points", "what a point sees of a polygon", "exact, plain-double, rays:N, rays:N:fast, cgal-epeck",
                   point_contender_named, point_truth, point_properties, false, true},
      QuestionKind{"shafts", "what enters or blocks the shaft between two polygons", "exact", shaft_contender,
                   shaft_truth, shaft_properties, true, false},
      QuestionKind{"shadows", "which polygons and points an object can change that comes or goes", "exact",
                   shadow_contender, shadow_truth, shadow_properties, true, false},
      QuestionKind{"pairs", "what two polygons exchange",
                   "exact (over both polygons, as `cases`), one-way (over one, as matrices)", pair_contender,
                   pair_truth, pair_properties, true, false}};
  return kKinds;
}

const QuestionKind& question_kind_named(const std::string& name) {
  std::string names;
  for (const QuestionKind& kind : question_kinds()) {
    if (kind.name == name) return kind;
    names += (names.empty() ? "" : ", ") + kind.name;
  }
  throw std::invalid_argument(name + ": there is no such kind of questions; there are " + names);
}

std::vector<std::string> property_names(const QuestionKind& kind) {
  std::vector<std::string> names;
  for (const Property& property : kind.properties()) names.push_back(property.name);
  if (kind.sums_to_one) names.emplace_back(kClosure);
  return names;
}

}  // namespace exitance
