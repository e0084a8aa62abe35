#include "src/output/shading.h"

namespace exitance {

std::vector<Rgb> element_colours(const Appearance& a) {
  std::vector<Rgb> colours(a.B.size() / a.bands);
  for (std::size_t e = 0; e < colours.size(); ++e) colours[e] = rgb_of_bands(a.B.subspan(e * a.bands, a.bands));
  return colours;
}

std::vector<Rgb> point_colours(const Faces& faces, const Appearance& a) {
  const std::vector<double> B = point_averages(faces, a.B, a.bands, a.covered);
  std::vector<Rgb> colours(faces.points().size());
  for (std::size_t p = 0; p < colours.size(); ++p) {
    colours[p] = rgb_of_bands(std::span(B).subspan(p * a.bands, a.bands));
  }
  return colours;
}

}  // namespace exitance
