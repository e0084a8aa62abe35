#include "src/dynamic/converged_reference.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "src/form_factor/point_rows.h"
#include "src/form_factor/row_blocks.h"
#include "src/solve/gather.h"

namespace exitance {

std::vector<double> converged_reference(const DynamicRadiosity& state) {
  const SceneVersion& version = state.version();
  FormFactorMatrix rows;
  rows.columns = static_cast<std::uint32_t>(version.patches());
  constexpr std::size_t kBlock = 1024;
  const auto n = static_cast<std::uint32_t>(version.elements());
  for_each_row(
      n, kBlock,
      [&](std::size_t k) {
        const auto e = static_cast<std::uint32_t>(k);
        return version.has_element(e) ? version.row(e) : PointRow{};
      },
      [&](const PointRow& row) { append(rows, row); }, [](std::size_t) {});
  const Discretisation d = state.discretisation();
  const Solution solution = gather(make_system(d, rows), {.tolerance = 1e-13});
  std::vector<double> B = element_exitance(d, irradiance(rows, solution.B, d.bands));
  for (std::uint32_t e = 0; e < n; ++e) {
    if (!version.has_element(e)) std::fill_n(B.begin() + static_cast<std::ptrdiff_t>(std::size_t{e} * d.bands), d.bands, 0.0);
  }
  return B;
}

ConvergenceError convergence_error(const SceneVersion& version, std::uint32_t bands,
                                   const std::vector<double>& reference, const std::vector<double>& was,
                                   const std::vector<double>& current) {
  const std::vector<double> weights = luminance_weights(bands);
  const auto Y = [&](const std::vector<double>& B, std::uint32_t e) {
    double y = 0;
    for (std::uint32_t b = 0; b < bands; ++b) {
      const std::size_t i = std::size_t{e} * bands + b;
      if (i < B.size()) y += weights[b] * B[i];
    }
    return y;
  };
  std::vector<std::uint32_t> elements;
  std::vector<double> change(version.elements());
  for (std::uint32_t e = 0; e < version.elements(); ++e) {
    if (!version.has_element(e)) continue;
    elements.push_back(e);
    change[e] = std::fabs(Y(reference, e) - Y(was, e));
  }
  const auto error = [&](std::span<const std::uint32_t> of) {
    double missed = 0, all = 0;
    for (const std::uint32_t e : of) {
      const double area = version.mesh().elements[e].area, y = Y(reference, e), d = y - Y(current, e);
      missed += area * d * d;
      all += area * y * y;
    }
    return missed == 0 ? 0 : std::sqrt(missed / all);
  };
  ConvergenceError result;
  result.all = error(elements);
  std::ranges::stable_sort(elements, std::greater<>(), [&](std::uint32_t e) { return change[e]; });
  const std::size_t most = (elements.size() + 99) / 100;
  result.worst_1_percent = error(std::span(elements).first(most));
  return result;
}

}  // namespace exitance
