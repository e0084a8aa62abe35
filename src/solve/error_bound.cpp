#include "src/solve/error_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "src/solve/compensated.h"

namespace exitance {
namespace {

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

// a / b where 0 / 0 is 0.
double ratio(double a, double b) {
  return a == 0 ? 0 : a / b;
}

std::vector<double> max_rho(const RadiositySystem& s) {
  std::vector<double> largest(s.bands);
  for (std::size_t i = 0; i < s.rho.size(); ++i) largest[i % s.bands] = std::max(largest[i % s.bands], s.rho[i]);
  return largest;
}

}  // namespace

std::vector<double> contraction(const RadiositySystem& s) {
  std::vector<double> result(s.bands);
  const std::vector<double> ones(s.patches(), 1.0);
  const std::vector<double> sums = irradiance(s.F, ones, 1);
  for (std::size_t p = 0; p < s.patches(); ++p) {
    // A sum within the rounding of 1 counts as 1.
    const double row_sum = sums[p] <= 1 + 4 * kUnitRoundoff ? 1 : sums[p];
    for (std::size_t b = 0; b < s.bands; ++b) result[b] = std::max(result[b], s.rho[p * s.bands + b] * row_sum);
  }
  for (double& q : result) {
    q *= 1 + 8 * kUnitRoundoff;
    if (!(q < 1)) {
      throw InvalidSystem("reflectance times sum of form factors reaches " + std::to_string(q) +
                          "; nothing bounds the solution: compute the form factors to a smaller tolerance");
    }
  }
  return result;
}

Residual residual(const RadiositySystem& s, std::span<const double> B) {
  const std::size_t n = s.E.size();
  Residual result{irradiance(s.F, B, s.bands), std::vector<double>(n), std::vector<double>(s.bands),
                  std::vector<double>(s.bands), std::vector<double>(s.bands)};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t b = i % s.bands;
    const double reflected = s.rho[i] * result.H[i];
    result.r[i] = (s.E[i] + reflected) - B[i];
    result.norm[b] = std::max(result.norm[b], std::abs(result.r[i]));
    result.max_B[b] = std::max(result.max_B[b], std::abs(B[i]));
    // H, the product, the sum and the difference round once each: below 4 u of the three magnitudes together.
    result.rounding[b] =
        std::max(result.rounding[b], 4 * kUnitRoundoff * (std::abs(s.E[i]) + std::abs(reflected) + std::abs(B[i])));
  }
  // The quadratic term of the compensated product, below u max |B| for rows of up to 2^25 entries.
  for (std::size_t b = 0; b < s.bands; ++b) result.rounding[b] += kUnitRoundoff * result.max_B[b];
  return result;
}

std::vector<double> error_bounds(std::span<const double> norm, std::span<const double> rounding,
                                 std::span<const double> contraction, std::span<const double> max_B) {
  std::vector<double> result(norm.size());
  for (std::size_t b = 0; b < result.size(); ++b) {
    result[b] = ratio((norm[b] + rounding[b]) / (1 - contraction[b]) * (1 + 8 * kUnitRoundoff), max_B[b]);
  }
  return result;
}

double form_factor_error(const RadiositySystem& s, std::span<const double> B) {
  std::vector<double> magnitude(B.size()), H_error(s.bands), worst(s.bands), max_B(s.bands);
  for (std::size_t i = 0; i < B.size(); ++i) {
    magnitude[i] = std::abs(B[i]);
    max_B[i % s.bands] = std::max(max_B[i % s.bands], magnitude[i]);
  }
  for (std::size_t p = 0; p < s.patches(); ++p) {
    row_product(s.F.row_columns(p), s.F.row_error(p), magnitude.data(), s.bands, H_error.data());
    for (std::size_t b = 0; b < s.bands; ++b) worst[b] = std::max(worst[b], s.rho[p * s.bands + b] * H_error[b]);
  }
  const std::vector<double> largest_rho = max_rho(s);
  double result = 0;
  for (std::size_t b = 0; b < s.bands; ++b) {
    result = std::max(result, ratio(worst[b] / (1 - largest_rho[b]) * (1 + 8 * kUnitRoundoff), max_B[b]));
  }
  return result;
}

EnergyBalance energy_balance(std::span<const double> area, std::span<const double> row_sum, std::span<const double> rho,
                             std::span<const double> E, std::span<const double> B, std::span<const double> H,
                             std::uint32_t bands) {
  EnergyBalance result;
  for (std::uint32_t b = 0; b < bands; ++b) {
    CompensatedSum emitted, absorbed, escaped;
    for (std::size_t p = 0; p < area.size(); ++p) {
      const std::size_t i = p * bands + b;
      emitted.add_product(area[p], E[i]);
      absorbed.add_product(area[p] * (1 - rho[i]), H[i]);
      escaped.add_product(area[p] * (1 - row_sum[p]), B[i]);
    }
    result.emitted.push_back(emitted.value());
    result.absorbed.push_back(absorbed.value());
    result.escaped.push_back(escaped.value());
    const double missing = emitted.value() - absorbed.value() - escaped.value();
    result.defect.push_back(ratio(std::abs(missing), std::abs(emitted.value())));
    result.worst_defect = std::max(result.worst_defect, result.defect.back());
  }
  return result;
}

}  // namespace exitance
