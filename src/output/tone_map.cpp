#include "src/output/tone_map.h"

#include <algorithm>
#include <cmath>

namespace exitance {
namespace {

constexpr double kKneeStart = 0.6;    // the curve is the identity up to here
constexpr double kBrightShown = 0.8;  // what the bright luminance becomes
constexpr double kBrightShare = 0.01;

double curve(double x) {
  constexpr double room = 1 - kKneeStart;
  return x <= kKneeStart ? std::max(x, 0.0) : 1 - room * std::exp(-(x - kKneeStart) / room);
}

}  // namespace

Rgb rgb_of_bands(std::span<const double> bands) {
  if (bands.size() == 3) return {bands[0], bands[1], bands[2]};
  double sum = 0;
  for (const double value : bands) sum += value;
  const double mean = bands.empty() ? 0 : sum / static_cast<double>(bands.size());
  return {mean, mean, mean};
}

double luminance(const Rgb& rgb) {
  return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

double bright_luminance(std::vector<std::pair<double, double>> shown) {
  std::sort(shown.begin(), shown.end(), [](const auto& a, const auto& b) { return a > b; });
  double all = 0;
  for (const auto& [value, weight] : shown) all += weight;
  double above = 0;
  for (const auto& [value, weight] : shown) {
    above += weight;
    if (above >= kBrightShare * all) return value;
  }
  return 0;
}

double ToneMap::exposed_bright() {
  constexpr double room = 1 - kKneeStart;
  return kKneeStart - room * std::log((1 - kBrightShown) / room);  // the curve's inverse
}

Rgb ToneMap::operator()(const Rgb& linear) const {
  return {curve(exposure_ * linear[0]), curve(exposure_ * linear[1]), curve(exposure_ * linear[2])};
}

std::array<std::uint8_t, 3> srgb(const Rgb& linear) {
  std::array<std::uint8_t, 3> bytes{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double x = std::clamp(linear[c], 0.0, 1.0);
    const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    bytes[c] = static_cast<std::uint8_t>(std::lround(255 * encoded));
  }
  return bytes;
}

}  // namespace exitance
