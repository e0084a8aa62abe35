#include "src/output/report.h"

#include <nlohmann/json.hpp>

#include "src/output/whole_file.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;

Json or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json rays(const std::optional<Report::Rays>& rays) {
  if (!rays) return nullptr;
  return {{"sampler", rays->sampler}, {"estimator", rays->estimator},
          {"rays", rays->rays},       {"replicates", rays->replicates},
          {"offset", rays->offset},   {"seed", rays->seed},
          {"cast", rays->cast},       {"mean_standard_error", or_null(rays->mean_standard_error)}};
}

Json links(const std::optional<Report::Links>& links) {
  if (!links) return nullptr;
  return {{"sub_patches", links->sub_patches},
          {"active", links->active},
          {"shadow", links->shadow},
          {"ghost", links->ghost},
          {"E-E", links->environment},
          {"E-O", links->mixed},
          {"O-O", links->dynamic},
          {"patch_pairs", links->patch_pairs},
          {"clusters", links->clusters},
          {"cluster_links", links->cluster_links},
          {"rounds", links->rounds},
          {"cpu_seconds", links->cpu_seconds},
          {"bytes", links->bytes},
          {"eps1", links->eps1},
          {"eps2", links->eps2},
          {"smallest_area", links->smallest_area}};
}

Json manifest(const Report& r) {
  return {{"version", r.manifest.version},     {"commit", r.manifest.commit}, {"compiler", r.manifest.compiler},
          {"libraries", r.manifest.libraries}, {"threads", r.threads},        {"seed", r.seed},
          {"scene_hash", r.scene_hash},        {"options", r.options}};
}

}  // namespace

std::string to_json(const Report& r) {
  const Json json = {{"scene", r.scene},
                     {"surfaces", r.surfaces},
                     {"patches", r.patches},
                     {"elements", r.elements},
                     {"bands", r.bands},
                     {"unit", r.unit},
                     {"method", r.method},
                     {"receivers", r.receivers},
                     {"visibility", r.visibility},
                     {"rays", rays(r.rays)},
                     {"links", links(r.links)},
                     {"converged", r.converged},
                     {"iterations", r.iterations},
                     {"residual", r.residual},
                     {"error_bound", r.error_bound},
                     {"solver_error_bound", r.solver_error_bound},
                     {"form_factor_error", r.form_factor_error},
                     {"energy_balance_defect", or_null(r.energy_balance_defect)},
                     {"closure_max_defect", or_null(r.closure_max_defect)},
                     {"measured_points", r.measured_points},
                     {"covered_points", r.covered_points},
                     {"resumed_rows", r.resumed_rows},
                     {"reciprocity_max_defect", or_null(r.reciprocity_max_defect)},
                     {"ambient", r.ambient},
                     {"B_min", r.B_min},
                     {"B_max", r.B_max},
                     {"pairs",
                      {{"facing_away", r.pairs.facing_away},
                       {"open", r.pairs.open},
                       {"blocked", r.pairs.blocked},
                       {"partial", r.pairs.partial}}},
                     {"predicate_stages", r.predicate_stages},
                     {"seconds",
                      {{"load", r.seconds.load},
                       {"form_factors", r.seconds.form_factors},
                       {"solve", r.seconds.solve},
                       {"output", r.seconds.output},
                       {"total", r.seconds.total}}},
                     {"peak_memory_bytes", r.peak_memory_bytes},
                     {"warnings", r.warnings},
                     {"manifest", manifest(r)}};
  // Names in files need not be UTF-8.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_report(const std::filesystem::path& path, const Report& report) {
  write_whole_file(path, [&](std::ostream& out) { out << to_json(report); });
}

}  // namespace exitance
