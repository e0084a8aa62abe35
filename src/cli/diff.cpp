// exitance diff: how far two solutions of one scene are from each other.

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "src/cli/console.h"
#include "src/cli/verbs.h"
#include "src/output/faces.h"
#include "src/output/vtk.h"
#include "src/reference/comparison.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;

/// Infinite numbers are none in JSON.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json json_of(const SolutionRecord& record) {
  return {{"path", record.source},
          {"patches", record.mesh.patches.size()},
          {"elements", record.mesh.elements.size()},
          {"degree", record.degree},
          {"error", number(record.error.total)}};
}

std::string in_words(const SolutionRecord& record) {
  return fmt::format("{} ({} elements{})", record.source, record.mesh.elements.size(),
                     std::isfinite(record.error.total) ? fmt::format(", error {:.3g}", record.error.total) : "");
}

void write_difference(const std::string& path, const SolutionRecord& of, const Comparison& comparison) {
  Faces faces(0);
  for (std::uint32_t e = 0; e < of.mesh.elements.size(); ++e) {
    const Element& element = of.mesh.elements[e];
    for (const PatchPiece& piece : of.mesh.pieces_of(element))
      faces.add(of.mesh.patches[element.patch].surface, element.patch, e, of.mesh.loop(piece));
  }
  std::vector<double> difference(comparison.Y_current);
  for (std::size_t e = 0; e < difference.size(); ++e) difference[e] -= comparison.Y_reference[e];
  const std::vector<VtkArray> arrays = {{"Y_reference", of.unit, {}, comparison.Y_reference},
                                        {"Y_current", of.unit, {}, comparison.Y_current},
                                        {"difference", of.unit, {}, difference}};
  write_vtp(path, faces, arrays);
}

class Diff {
 public:
  explicit Diff(CLI::App& verb) {
    verb.add_option("A", reference_, "The reference: what `reference` wrote (.h5) or `solve` (a folder)")->required();
    verb.add_option("B", current_, "What is compared with it, likewise")->required();
    verb.add_option("-o,--output", file_, "File for B's elements with Y of both and their difference (.vtp)");
    verb.add_flag("--json", json_, "Print the result as JSON");
    verb.footer(
        "Errors are George's (1990, eq. 7), relative to A: the area-weighted norm of the luminance's difference, over "
        "the\n"
        "elements of B with A's means over them, over the 1 % of the area where they differ most, and pointwise, "
        "where\n"
        "how coarse elements are counts, too.");
  }

  void run() const {
    const SolutionRecord reference = read_solution(reference_), current = read_solution(current_);
    const Comparison comparison = compare(reference, current);
    if (!file_.empty()) write_difference(file_, current, comparison);
    if (json_) {
      const Json json = {{"scene", reference.scene},
                         {"scene_hash", reference.scene_hash},
                         {"reference", json_of(reference)},
                         {"current", json_of(current)},
                         {"error", number(comparison.error)},
                         {"error_worst_1_percent", number(comparison.error_worst_1_percent)},
                         {"pointwise_error", number(comparison.pointwise_error)}};
      print_results(json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
      return;
    }
    std::string text = reference.scene + "\n";
    const auto line = [&](std::string_view name, const std::string& value) {
      text += fmt::format("  {:<22}{}\n", name, value);
    };
    line("reference", in_words(reference));
    line("current", in_words(current));
    line("error", fmt::format("{:.6g}", comparison.error));
    line("error of worst 1 %", fmt::format("{:.6g}", comparison.error_worst_1_percent));
    line("pointwise error", fmt::format("{:.6g}", comparison.pointwise_error));
    print_results(printable(text));
  }

 private:
  std::string reference_, current_, file_;
  bool json_ = false;
};

}  // namespace

void add_diff(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("diff", "Compare two solutions of one scene");
  verb->callback([diff = std::make_shared<Diff>(*verb)] { diff->run(); });
}

}  // namespace exitance
