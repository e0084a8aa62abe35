// exitance check: what is wrong with a scene, or worth knowing about it.

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "src/cli/scene_options.h"
#include "src/cli/verbs.h"
#include "src/scene/scene_check.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;

std::string in_words(const FindingPlace& place) {
  const std::string file = place.file.empty() ? "" : fmt::format("{}:{}: ", place.file, place.line);
  return fmt::format("{}{} ({})", file, place.object, place.surface);
}

std::string in_words(const Finding& f) {
  const std::string amount = f.unit.empty() ? "" : fmt::format(" {:.6g} {}", f.amount, f.unit);
  std::string text = fmt::format("{}: {} {}{}\n    {}\n", name_of(f.severity), f.count, f.what, amount, f.hint);
  for (const FindingPlace& place : f.places) text += fmt::format("    {}\n", in_words(place));
  if (f.count > f.places.size() && !f.places.empty())
    text += fmt::format("    and {} more\n", f.count - f.places.size());
  return text;
}

std::string in_words(const Scene& scene, const SceneReport& report) {
  std::string text =
      fmt::format("{}: {} surfaces in {} connected pieces, {} bands\n{}, {}\n", scene.name, scene.surfaces.size(),
                  report.pieces, scene.bands, report.closed ? "closed: no light escapes" : "open: light may escape",
                  report.watertight ? "no free edges" : "some edges are free");
  for (const std::string& warning : scene.warnings) text += fmt::format("warning: {}\n", warning);
  for (const Finding& finding : report.findings) text += in_words(finding);
  return text;
}

Json to_json(const Finding& f) {
  Json places = Json::array();
  for (const FindingPlace& p : f.places) {
    places.push_back({{"surface", p.surface}, {"object", p.object}, {"file", p.file}, {"line", p.line}});
  }
  return {{"kind", name_of(f.kind)}, {"severity", name_of(f.severity)},
          {"count", f.count},        {"amount", f.amount},
          {"unit", f.unit},          {"what", f.what},
          {"hint", f.hint},          {"places", places}};
}

Json to_json(const Scene& scene, const SceneReport& report) {
  Json findings = Json::array();
  for (const Finding& finding : report.findings) findings.push_back(to_json(finding));
  return {{"scene", scene.name},     {"surfaces", scene.surfaces.size()}, {"bands", scene.bands},
          {"closed", report.closed}, {"watertight", report.watertight},   {"pieces", report.pieces},
          {"findings", findings},    {"warnings", scene.warnings}};
}

class Check {
 public:
  explicit Check(CLI::App& verb) {
    scene_.add_to(verb);
    verb.add_flag("--json", json_, "Print the findings as JSON");
  }

  void run() const {
    const Scene scene = scene_.read(true);
    const SceneReport report = check_scene(scene);
    if (json_) {
      // Names in files need not be UTF-8.
      fmt::print("{}\n", to_json(scene, report).dump(1, ' ', false, Json::error_handler_t::replace));
    } else {
      fmt::print("{}", in_words(scene, report));
    }
    const auto is_error = [](const Finding& finding) { return finding.severity == Severity::error; };
    if (std::ranges::any_of(report.findings, is_error)) throw CLI::RuntimeError(bad_input);
  }

 private:
  SceneOptions scene_;
  bool json_ = false;
};

}  // namespace

void add_check(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("check", "List what is wrong with a scene; exit code 3 if it cannot be solved");
  verb->callback([check = std::make_shared<const Check>(*verb)] { check->run(); });
}

}  // namespace exitance
