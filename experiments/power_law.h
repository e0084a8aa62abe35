#pragma once
// Errors that fall as a power of what they cost.

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace exitance {

/// x and y of a curve, x ascending.
using Curve = std::vector<std::pair<double, double>>;

/// The power of x by which y goes, by least squares of the logarithms; 0 where that is not known.
inline double slope(const Curve& curve) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [a, b] : curve) {
    if (!(a > 0 && b > 0)) continue;
    const double u = std::log(a), v = std::log(b);
    n += 1;
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  const double variance = n * xx - x * x;
  return variance > 0 ? (n * xy - x * y) / variance : 0;
}

/// The x at which y has fallen to a value: between two points, or beyond the last one by the power of the last four.
/// None for a curve that starts below or hardly falls.
inline std::optional<double> x_at(const Curve& curve, double value) {
  for (std::size_t k = 1; k < curve.size(); ++k) {
    const auto& [x0, y0] = curve[k - 1];
    const auto& [x1, y1] = curve[k];
    if (y0 >= value && y1 <= value && y0 > y1) return x0 * std::pow(x1 / x0, std::log(y0 / value) / std::log(y0 / y1));
  }
  if (curve.size() < 4 || curve.back().second < value) return {};
  const double power = slope(Curve(curve.end() - 4, curve.end()));
  if (!(power < -0.1)) return {};
  return curve.back().first * std::pow(value / curve.back().second, 1 / power);
}

/// The y of a curve at an x, by the power between the two points around it. None outside the curve.
inline std::optional<double> y_at(const Curve& curve, double x) {
  for (std::size_t k = 1; k < curve.size(); ++k) {
    const auto& [x0, y0] = curve[k - 1];
    const auto& [x1, y1] = curve[k];
    if (x0 <= x && x <= x1 && x0 < x1) return y0 * std::pow(y1 / y0, std::log(x / x0) / std::log(x1 / x0));
  }
  return {};
}

}  // namespace exitance
