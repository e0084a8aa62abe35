#include "src/cli/stress_state.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "src/cli/json_text.h"
#include "src/output/whole_file.h"
#include "src/scene/input_error.h"

namespace exitance {
namespace {

using Json = nlohmann::json;

Json json_of(const StressTally& t) {
  Json properties = Json::array();
  for (const PropertyTally& p : t.properties) properties.push_back({p.tried, p.broken, p.worst_defect});
  return {{"questions", t.questions},
          {"seen", {t.none, t.some, t.all}},
          {"unjudged", t.unjudged},
          {"wrong", t.wrong},
          {"classes", t.classes},
          {"worst", {t.worst_error, t.worst_relative_error, t.worst_margin}},
          {"stages", {t.stages.filter, t.stages.interval, t.stages.exact}},
          {"extended", t.extended},
          {"seconds", t.seconds},
          {"properties", properties}};
}

/// JSON has no infinity: it is written as null.
double number_of(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

StressTally tally_of(const Json& json) {
  const Json &seen = json.at("seen"), &worst = json.at("worst"), &stages = json.at("stages");
  StressTally t{.questions = json.at("questions"),
                .none = seen.at(0),
                .some = seen.at(1),
                .all = seen.at(2),
                .unjudged = json.at("unjudged"),
                .wrong = json.at("wrong"),
                .classes = json.at("classes"),
                .worst_error = number_of(worst.at(0)),
                .worst_relative_error = number_of(worst.at(1)),
                .worst_margin = number_of(worst.at(2)),
                .stages = {stages.at(0), stages.at(1), stages.at(2)},
                .extended = json.at("extended"),
                .seconds = json.at("seconds"),
                .properties = {}};
  for (const Json& p : json.at("properties")) t.properties.push_back({p.at(0), p.at(1), number_of(p.at(2))});
  return t;
}

}  // namespace

std::optional<StressState> read_stress_state(const std::filesystem::path& file, const StressKey& key) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  const Json json = read_json(file.string());
  try {
    const StressKey there = json.at("key");
    for (const auto& [name, here] : key) {
      const auto found = there.find(name);
      if (found == there.end() || found->second != here) {
        throw InputError(file.string(), 0,
                         fmt::format("belongs to another run ({} is \"{}\" there, \"{}\" here); finish that one, or "
                                     "remove the file",
                                     name, found == there.end() ? "" : found->second, here));
      }
    }
    StressState state{.done = json.at("done"), .tallies = {}, .found = {}, .unjudged = {}};
    for (const Json& t : json.at("tallies")) state.tallies.push_back(tally_of(t));
    for (const Json& f : json.at("found")) {
      state.found.push_back({f.at(0), f.at(1), f.at(2), {}});
      if (!f.at(3).is_null()) state.found.back().exception = f.at(3).get<std::string>();
    }
    for (const Json& u : json.at("unjudged")) state.unjudged.push_back({u.at(0), u.at(1)});
    return state;
  } catch (const Json::exception& wrong) {
    throw InputError(file.string(), 0,
                     fmt::format("is no state of a stress run ({}); remove it to begin anew", wrong.what()));
  }
}

void write_stress_state(const std::filesystem::path& file, const StressKey& key, const StressState& state) {
  Json json{{"key", key},
            {"done", state.done},
            {"tallies", Json::array()},
            {"found", Json::array()},
            {"unjudged", Json::array()}};
  for (const StressTally& tally : state.tallies) json["tallies"].push_back(json_of(tally));
  for (const StressFinding& f : state.found) {
    json["found"].push_back({f.number, f.contender, f.what, f.exception ? Json(*f.exception) : Json(nullptr)});
  }
  for (const StressUnjudged& u : state.unjudged) json["unjudged"].push_back({u.number, u.exception});
  write_whole_file(file, [&](std::ostream& out) { out << json << '\n'; });
}

}  // namespace exitance
