#pragma once
// Published form factors, for tests.

#include <cmath>
#include <numbers>

namespace exitance {

/// From a point to a rectangle a × b parallel to its surface at distance c, one corner straight above it (Howell's
/// catalogue, B-3).
inline double point_below_corner(double a, double b, double c) {
  const double x = a / c, y = b / c, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * std::numbers::pi);
}

/// Between two equal, opposite rectangles a × b at distance c (Howell's catalogue, C-11). Its terms cancel when c is
/// small.
inline double opposite_rectangles(long double a, long double b, long double c) {
  const long double x = a / c, y = b / c, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
  return static_cast<double>(2 / (std::numbers::pi_v<long double> * x * y) *
                             (0.5L * std::log(p * p * q * q / (1 + x * x + y * y)) + x * q * std::atan(x / q) +
                              y * p * std::atan(y / p) - x * std::atan(x) - y * std::atan(y)));
}

/// Unit squares at a right angle with a common edge (Howell's catalogue, C-14).
inline constexpr double kPerpendicularSquares = 0.20004377607540316;

/// Opposite unit squares at distance 1, a square plate of half their side in between at 3/4 of the distance (the value
/// of Shapiro 1985, 0.11562061, to more digits).
inline constexpr double kShapiroBlocked = 0.115620602132415;

}  // namespace exitance
