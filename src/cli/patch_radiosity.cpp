#include "src/cli/patch_radiosity.h"

#include <algorithm>
#include <cmath>

#include "src/solve/error_bound.h"
#include "src/solve/gather.h"

namespace exitance {
namespace {

FormFactorMatrix compressed(const AreaFormFactors& dense) {
  FormFactorMatrix matrix;
  matrix.columns = static_cast<std::uint32_t>(dense.n);
  for (std::size_t i = 0; i < dense.n; ++i) {
    for (std::size_t j = 0; j < dense.n; ++j) {
      if (dense.F[i * dense.n + j] == 0 && dense.F_error[i * dense.n + j] == 0) continue;
      matrix.column.push_back(static_cast<std::uint32_t>(j));
      matrix.F.push_back(dense.F[i * dense.n + j]);
      matrix.F_error.push_back(dense.F_error[i * dense.n + j]);
    }
    matrix.row_first.push_back(matrix.F.size());
  }
  return matrix;
}

}  // namespace

PatchRadiosity patch_radiosity(const AreaFormFactors& form_factors, const std::vector<double>& E,
                               const std::vector<double>& rho, std::size_t bands) {
  const RadiositySystem system{static_cast<std::uint32_t>(bands), form_factors.area, rho, E, compressed(form_factors)};
  GatherOptions options;
  options.tolerance = 1e-15;  // to the last digits: it ends where rounding stops it
  if (system.patches() <= kDirectLimit) options.method = GatherMethod::direct;
  const Solution solution = gather(system, options);
  PatchRadiosity result{solution.B, solution.H, std::vector<double>(E.size())};
  if (E.empty()) return result;

  // With δB = B − B*, F* the true form factors and δF their errors: δB = −r + ρ δF B + ρ F* δB. As rows of F* sum to at
  // most 1, max |δB| ≤ max |r + ρ δF B| / (1 − max ρ); put in once more, it bounds each patch by itself.
  const Residual left = residual(system, solution.B);
  std::vector<double> own(E.size()), row_sum(system.patches());
  std::vector<double> worst(bands), max_rho(bands);
  for (std::size_t p = 0; p < system.patches(); ++p) {
    const auto columns = system.F.row_columns(p);
    const auto F = system.F.row(p), F_error = system.F.row_error(p);
    for (std::size_t k = 0; k < columns.size(); ++k) row_sum[p] += F[k] + F_error[k];
    for (std::size_t b = 0; b < bands; ++b) {
      double uncertain = 0;
      for (std::size_t k = 0; k < columns.size(); ++k) {
        uncertain += F_error[k] * std::fabs(solution.B[columns[k] * bands + b]);
      }
      const std::size_t i = p * bands + b;
      own[i] = std::fabs(left.r[i]) + left.rounding[b] + rho[i] * uncertain;
      worst[b] = std::max(worst[b], own[i]);
      max_rho[b] = std::max(max_rho[b], rho[i]);
    }
  }
  for (std::size_t i = 0; i < E.size(); ++i) {
    const std::size_t b = i % bands;
    const double anywhere = worst[b] / (1 - max_rho[b]);
    result.B_error[i] = (own[i] + rho[i] * std::min(1.0, row_sum[i / bands]) * anywhere) * (1 + 1e-12);
  }
  return result;
}

}  // namespace exitance
