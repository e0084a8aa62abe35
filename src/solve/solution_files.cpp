#include "src/solve/solution_files.h"

#include <algorithm>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "src/output/image.h"
#include "src/output/mesh_faces.h"
#include "src/output/ply.h"
#include "src/output/vtk.h"
#include "src/scene/scene_hash.h"

namespace exitance {
namespace {

// Values of the patches at their elements.
std::vector<double> at_elements(const Discretisation& d, std::span<const double> of_patch) {
  std::vector<double> values;
  values.reserve(d.elements() * d.bands);
  for (std::size_t p = 0; p < d.patches(); ++p) {
    const auto value = of_patch.subspan(p * d.bands, d.bands);
    for (std::size_t e = d.element_first[p]; e < d.element_first[p + 1]; ++e) {
      values.insert(values.end(), value.begin(), value.end());
    }
  }
  return values;
}

std::vector<std::string> band_names(std::uint32_t bands) {
  if (bands == 1) return {};
  if (bands == 3) return {"R", "G", "B"};
  std::vector<std::string> names;
  for (std::uint32_t b = 0; b < bands; ++b) names.push_back("band " + std::to_string(b));
  return names;
}

// What is shown of B: where shooting was ended early, with the ambient estimate of what it left.
std::vector<double> shown_B(const SceneSolution& s, std::span<const double> rho) {
  std::vector<double> B = s.element_B;
  for (std::size_t i = 0; i < B.size() && !s.ambient.empty(); ++i) B[i] += rho[i] * s.ambient[i % s.ambient.size()];
  return B;
}

std::optional<Report::Rays> rays_of(const SceneSolution& s) {
  if (!s.rays) return {};
  Report::Rays rays{.sampler = to_string(s.rays->sampler),
                    .estimator = to_string(s.rays->estimator),
                    .rays = s.rays->rays,
                    .replicates = s.rays->replicates,
                    .offset = s.rays->offset,
                    .seed = s.rays->seed,
                    .cast = s.statistics.rays,
                    .mean_standard_error = {}};
  if (s.statistics.sampled > 0)
    rays.mean_standard_error = s.statistics.standard_error_sum / static_cast<double>(s.statistics.sampled);
  return rays;
}

// Of the elements that see something; of all where none does.
std::pair<double, double> range_of_B(const SceneSolution& s) {
  constexpr double far = std::numeric_limits<double>::infinity();
  std::pair range{far, -far};
  const bool any = std::ranges::any_of(s.element_row_sum, [](double sum) { return sum > 0; });
  for (std::size_t i = 0; i < s.element_B.size(); ++i) {
    if (any && s.element_row_sum[i / s.discretisation.bands] == 0) continue;
    range = {std::min(range.first, s.element_B[i]), std::max(range.second, s.element_B[i])};
  }
  return range;
}

}  // namespace

Report make_report(const Scene& scene, const SceneSolution& s) {
  Report report;
  report.scene = scene.name;
  report.surfaces = scene.surfaces.size();
  report.patches = s.mesh.patches.size();
  report.elements = s.mesh.elements.size();
  report.bands = scene.bands;
  report.unit = scene.unit;
  report.receivers = s.receivers == Receivers::area ? "area" : "points";
  report.visibility = s.rays ? "rays" : "exact";
  report.rays = rays_of(s);
  report.converged = s.patches.converged;
  report.iterations = s.patches.iterations;
  report.residual = s.patches.residual;
  report.error_bound = s.patches.error_bound + s.form_factor_error;
  report.solver_error_bound = s.patches.error_bound;
  report.form_factor_error = s.form_factor_error;
  report.energy_balance_defect = s.energy_balance_defect;
  if (s.closed && s.measured_points > 0) report.closure_max_defect = s.statistics.closure_max_defect;
  report.ambient = s.ambient;
  report.measured_points = s.measured_points;
  report.covered_points = s.statistics.covered_points;
  report.resumed_rows = s.resumed_rows;
  report.reciprocity_max_defect = s.reciprocity_max_defect;
  std::tie(report.B_min, report.B_max) = range_of_B(s);
  report.pairs = s.statistics.pairs;
  report.predicate_stages = {{"filter", s.statistics.stages.filter},
                             {"interval", s.statistics.stages.interval},
                             {"exact", s.statistics.stages.exact},
                             {"extended", s.statistics.extended}};
  report.seconds.form_factors = s.seconds_form_factors;
  report.seconds.solve = s.seconds_solve;
  report.warnings = scene.warnings;
  report.manifest = build_manifest();
  report.scene_hash = scene_hash(scene);
  return report;
}

void write_solution(const std::filesystem::path& folder, const Scene& scene, const SceneSolution& s) {
  const Discretisation& d = s.discretisation;
  const Faces faces = faces_of(s.mesh, s.soup);
  const std::vector<double> E = at_elements(d, d.E), rho = at_elements(d, d.rho);
  const std::vector<std::string> bands = band_names(d.bands);
  const std::vector<VtkArray> arrays = {{"B", scene.unit, bands, s.element_B},
                                        {"H", scene.unit, bands, s.element_H},
                                        {"E", scene.unit, bands, E},
                                        {"rho", "", bands, rho},
                                        {"row_sum", "", {}, s.element_row_sum}};
  write_vtp(folder / "solution.vtp", faces, arrays);

  std::vector<std::uint8_t> emits(d.elements()), covered(d.elements());
  for (std::size_t e = 0; e < d.elements(); ++e) {
    const auto emission = std::span(E).subspan(e * d.bands, d.bands);
    emits[e] = std::ranges::any_of(emission, [](double value) { return value > 0; });
    covered[e] = s.element_row_sum[e] == 0;
  }
  const std::vector<double> B = shown_B(s, rho);
  const Appearance appearance{d.bands, B, emits, covered};
  write_ply(folder / "solution.ply", faces, appearance, Shading::smooth);
  const Camera camera = scene.camera ? *scene.camera : default_camera(faces.points(), s.closed);
  write_png(folder / "image.png", render(faces, appearance, camera));
}

}  // namespace exitance
