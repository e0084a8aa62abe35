#include "src/solve/convergence_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/solve/radiosity_system.h"

namespace exitance {

ConvergenceError convergence_error(std::span<const std::uint32_t> elements,
                                   const std::function<double(std::uint32_t)>& area, std::uint32_t bands,
                                   std::span<const double> reference, std::span<const double> was,
                                   std::span<const double> current) {
  const std::vector<double> weights = luminance_weights(bands);
  const auto Y = [&](std::span<const double> B, std::uint32_t e) {
    double y = 0;
    for (std::size_t b = 0, i = std::size_t{e} * bands; b < bands && i + b < B.size(); ++b) y += weights[b] * B[i + b];
    return y;
  };
  const auto error = [&](std::span<const std::uint32_t> of) {
    double missed = 0, all = 0, all_before = 0;
    for (const std::uint32_t e : of) {
      const double A = area(e), y = Y(reference, e), d = y - Y(current, e), y_was = Y(was, e);
      missed += A * d * d;
      all += A * y * y;
      all_before += A * y_was * y_was;
    }
    return missed == 0 ? 0 : std::sqrt(missed / (all > 0 ? all : all_before));
  };
  std::vector<std::uint32_t> by_change(elements.begin(), elements.end());
  std::ranges::stable_sort(by_change, std::greater<>(),
                           [&](std::uint32_t e) { return std::fabs(Y(reference, e) - Y(was, e)); });
  return {error(elements), error(std::span(by_change).first((by_change.size() + 99) / 100))};
}

}  // namespace exitance
