#include "src/form_factor/area_form_factors.h"

#include <numeric>

#include "src/form_factor/pair_rows.h"

namespace exitance {

AreaFormFactors area_form_factors(const ExchangeScene& scene, const PairOptions& options) {
  AreaFormFactors result;
  const std::size_t n = scene.size();
  result.n = n;
  result.F.assign(n * n, 0);
  result.F_error.assign(n * n, 0);
  for (std::size_t p = 0; p < n; ++p) result.area.push_back(scene.area(p));
  std::vector<std::uint32_t> rows(n);
  std::iota(rows.begin(), rows.end(), 0u);
  PairStatistics statistics;
  const PairRows pairs = pair_rows(scene, rows, options, statistics);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::uint64_t k = pairs.row_first[i]; k < pairs.row_first[i + 1]; ++k) {
      const std::size_t j = pairs.column[k];
      result.F[i * n + j] = pairs.F[k];
      result.F_error[i * n + j] = pairs.F_error[k];
      result.F[j * n + i] = pairs.F_reverse[k];
      result.F_error[j * n + i] = pairs.F_reverse_error[k];
    }
  }
  result.reached = statistics.unreached == 0;
  return result;
}

}  // namespace exitance
