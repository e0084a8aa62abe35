#pragma once
// From exitance to the colours of a screen.

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace exitance {

using Rgb = std::array<double, 3>;

/// Linear RGB of a value with any number of bands: three are R, G, B; any other number is grey, their mean.
Rgb rgb_of_bands(std::span<const double> bands);

/// Y = 0.2126 R + 0.7152 G + 0.0722 B.
double luminance(const Rgb& rgb);

/// The luminance that is exceeded in 1 % of the weight (of pixels, or area), where what `shown` holds is (luminance,
/// weight); 0 for nothing.
double bright_luminance(std::vector<std::pair<double, double>> shown);

/// One global curve: exposure so that `bright` becomes 0.8, each channel kept up to 0.6 and from there rising ever more
/// slowly towards 1. What is many times brighter, a light source, becomes white. bright ≤ 0: everything is black.
class ToneMap {
 public:
  explicit ToneMap(double bright) : exposure_(bright > 0 ? exposed_bright() / bright : 0) {}
  Rgb operator()(const Rgb& linear) const;  ///< each in [0, 1], still linear

 private:
  static double exposed_bright();
  double exposure_;
};

/// Transfer function of sRGB (IEC 61966-2-1): linear [0, 1] to bytes.
std::array<std::uint8_t, 3> srgb(const Rgb& linear);

}  // namespace exitance
