#include "src/reference/contender.h"

#include <fmt/format.h>

#include <utility>

#include "src/form_factor/pair_run.h"
#include "src/form_factor/sampled_area_rows.h"
#include "src/output/run_clock.h"
#include "src/reference/matrix_file.h"
#include "src/scene/input_error.h"

namespace exitance {
namespace {

[[noreturn]] void stopped() {
  throw LimitError("stopped before the comparison was complete");
}

void by(const PairOptions& pairs, const PatchMesh&, const ExchangeScene& exchange, const Progress& progress,
        const std::function<bool()>& stop, ContenderRun& result) {
  PairOptions options = pairs;
  options.stop = stop;
  const PairRun rows = run_pairs(exchange, {.pairs = options, .progress = progress}, nullptr);
  if (!rows.complete) stopped();
  result.queries = rows.statistics.points;
  result.F = matrix_of(rows.rows, static_cast<std::uint32_t>(exchange.size()));
}

void by(const RayOptions& rays, const PatchMesh& mesh, const ExchangeScene& exchange, const Progress& progress,
        const std::function<bool()>& stop, ContenderRun& result) {
  SampledAreaRows rows = sampled_area_rows(mesh, exchange.soup(), ExchangeScene::Unit::patch, rays,
                                           [&](double fraction, std::string_view label) {
                                             if (progress) progress(fraction, label);
                                             if (stop && stop()) stopped();
                                           });
  const PointRowStatistics& statistics = rows.statistics;
  result.rays = statistics.rays;
  if (statistics.sampled > 0) {
    result.standard_error = statistics.standard_error_sum / static_cast<double>(statistics.sampled);
    result.standard_errors = std::move(rows.standard_error);
  }
  result.F = std::move(rows.F);
}

void by(const std::filesystem::path& path, const PatchMesh&, const ExchangeScene& exchange, const Progress&,
        const std::function<bool()>&, ContenderRun& result) {
  MatrixRecord record = read_matrix(path, static_cast<std::uint32_t>(exchange.size()));
  if (record.matrix.rows() != exchange.size() || record.matrix.columns != exchange.size()) {
    throw InputError(path.string(), 0,
                     fmt::format("has {} rows and {} columns, the scene has {} patches; give the --patch-size that it "
                                 "was made with",
                                 record.matrix.rows(), record.matrix.columns, exchange.size()));
  }
  result.F = std::move(record.matrix);
}

}  // namespace

Maker Contender::maker() const {
  if (std::holds_alternative<PairOptions>(how)) return Maker::exact;
  const auto* rays = std::get_if<RayOptions>(&how);
  if (rays == nullptr) return Maker::unknown;
  return rays->estimator == Estimator::hemisphere ? Maker::hemisphere_rays : Maker::shadow_rays;
}

ContenderRun run(const Contender& contender, const PatchMesh& mesh, const ExchangeScene& exchange,
                 const Progress& progress, const std::function<bool()>& stop) {
  ContenderRun result;
  const RunClock clock;
  std::visit([&](const auto& how) { by(how, mesh, exchange, progress, stop, result); }, contender.how);
  result.seconds = clock.seconds();
  result.cpu_seconds = clock.cpu_seconds();
  return result;
}

}  // namespace exitance
