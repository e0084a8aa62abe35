#include "src/solve/convergence_error.h"

#include <algorithm>
#include <cmath>

#include "src/solve/radiosity_system.h"

namespace exitance {
namespace {

/// Of an element; 0 beyond the end.
double luminance(std::span<const double> weights, std::span<const double> B, std::uint32_t e) {
  double y = 0;
  for (std::size_t b = 0, i = std::size_t{e} * weights.size(); b < weights.size() && i + b < B.size(); ++b)
    y += weights[b] * B[i + b];
  return y;
}

}  // namespace

std::vector<std::uint32_t> most_changed(std::span<const std::uint32_t> elements, std::uint32_t bands,
                                        std::span<const double> reference, std::span<const double> was) {
  const std::vector<double> weights = luminance_weights(bands);
  std::vector<std::uint32_t> by_change(elements.begin(), elements.end());
  std::ranges::stable_sort(by_change, std::greater<>(), [&](std::uint32_t e) {
    return std::fabs(luminance(weights, reference, e) - luminance(weights, was, e));
  });
  by_change.resize((by_change.size() + 99) / 100);
  std::ranges::sort(by_change);
  return by_change;
}

ConvergenceError convergence_error(std::span<const std::uint32_t> elements,
                                   const std::function<double(std::uint32_t)>& area, std::uint32_t bands,
                                   std::span<const double> reference, std::span<const double> was,
                                   std::span<const double> current) {
  const std::vector<double> weights = luminance_weights(bands);
  const auto Y = [&](std::span<const double> B, std::uint32_t e) { return luminance(weights, B, e); };
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
  return {error(elements), error(most_changed(elements, bands, reference, was))};
}

}  // namespace exitance
