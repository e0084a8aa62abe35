// exitance check: what is wrong with a scene, or worth knowing about it.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <vector>

#include "src/cli/console.h"
#include "src/cli/number_range.h"
#include "src/cli/progress_display.h"
#include "src/cli/scene_options.h"
#include "src/cli/verbs.h"
#include "src/form_factor/point_rows.h"
#include "src/scene/patch_mesh.h"
#include "src/scene/scene_check.h"
#include "src/visibility/exact_visibility.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;

/// Front and back of a closed scene that miss 1 by as much, at some sample point, are a failed check.
constexpr double kFailedClosure = 1e-12;

/// Sample points that --closure takes at most: days of work, and a list that any memory holds.
constexpr std::uint64_t kMostPoints = 100'000'000;

/// What random sample points of a scene, of which every surface is one element, see of front and back sides.
struct Closure {
  std::size_t points = 0;  ///< 0 where the scene is open, so that they need not add up to 1, or without patches
  std::uint64_t seed = 0, covered_points = 0;
  double max_defect = 0;

  bool failed() const { return max_defect >= kFailedClosure; }
};

Closure measure_closure(const Scene& scene, bool closed, std::size_t points, std::uint64_t seed) {
  Closure closure{.seed = seed};
  if (!closed) return closure;
  const PolygonSoup soup = make_soup(scene);
  const PatchMesh mesh = make_patch_mesh(scene, soup, {});
  if (mesh.elements.empty()) return closure;
  std::mt19937_64 random(seed);
  std::vector<std::size_t> elements;
  for (std::size_t k = 0; k < points; ++k) elements.push_back(random() % mesh.elements.size());
  ProgressDisplay display;
  const PointRowStatistics found =
      point_row_statistics(ExactVisibility(mesh, soup), elements,
                           [&](double fraction, std::string_view label) { display.show(fraction, label); });
  closure.points = points;
  closure.covered_points = found.covered_points;
  closure.max_defect = found.closure_max_defect;
  return closure;
}

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

std::string in_words(const Closure& closure) {
  if (closure.points == 0) return "closure: without meaning, the scene is open or has no patches\n";
  return fmt::format("closure: front and back miss 1 by {:.3g} at most, at {} sample points ({} of them in contact)\n",
                     closure.max_defect, closure.points, closure.covered_points);
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

Json to_json(const Closure& closure) {
  return {{"points", closure.points},
          {"seed", closure.seed},
          {"covered_points", closure.covered_points},
          {"max_defect", closure.points > 0 ? Json(closure.max_defect) : Json()}};
}

class Check {
 public:
  explicit Check(CLI::App& verb) {
    scene_.add_to(verb);
    verb.add_flag("--json", json_, "Print the findings as JSON");
    CLI::Option* closure =
        verb.add_option("--closure", closure_points_,
                        "Look from so many random sample points and add up what they see; exit code 1 where front and "
                        "back of a closed scene do not fill the hemisphere")
            ->check(whole_number_between(1, kMostPoints));
    verb.add_option("--seed", seed_, "Of those sample points")
        ->check(whole_number_between(0))
        ->capture_default_str()
        ->needs(closure);
    verb.add_option("--threads", threads_, "Threads; as many as there are cores unless given")
        ->check(whole_number_between(1, kMostThreads))
        ->needs(closure);
    verb.footer(
        fmt::format("Exit code 1: with --closure, front and back of a closed scene miss 1 by {} or more at some sample "
                    "point.",
                    kFailedClosure));
  }

  void run() const {
    std::optional<tbb::global_control> control;
    if (threads_) control.emplace(tbb::global_control::max_allowed_parallelism, *threads_);
    const Scene scene = scene_.read(true);
    const SceneReport report = check_scene(scene);
    const auto is_error = [](const Finding& finding) { return finding.severity == Severity::error; };
    const bool solvable = std::ranges::none_of(report.findings, is_error);
    std::optional<Closure> closure;
    if (closure_points_ && solvable) closure = measure_closure(scene, report.closed, *closure_points_, seed_);
    print(scene, report, closure);
    if (!solvable) throw CLI::RuntimeError(bad_input);
    if (closure && closure->failed()) {
      print_message(fmt::format("the scene is closed, but front and back miss 1 by {:.3g} at some sample point",
                                closure->max_defect));
      throw CLI::RuntimeError(check_failed);
    }
  }

 private:
  void print(const Scene& scene, const SceneReport& report, const std::optional<Closure>& closure) const {
    if (json_) {
      Json json = to_json(scene, report);
      if (closure) json["closure"] = to_json(*closure);
      // Names in files need not be UTF-8.
      print_results(json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    } else {
      print_results(printable(in_words(scene, report) + (closure ? in_words(*closure) : "")));
    }
  }

  SceneOptions scene_;
  bool json_ = false;
  std::optional<std::size_t> closure_points_, threads_;
  std::uint64_t seed_ = 1;
};

}  // namespace

void add_check(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("check", "List what is wrong with a scene; exit code 3 if it cannot be solved");
  verb->callback([check = std::make_shared<const Check>(*verb)] { check->run(); });
}

}  // namespace exitance
