#include "src/scene/read_mtl.h"

#include "src/scene/text_cursor.h"

namespace exitance {
namespace {

// "Kd r [g b]": g and b equal r where they are left out.
std::vector<double> read_colour(TextCursor& text) {
  const std::string_view first = text.next_token();
  if (first == "spectral" || first == "xyz")
    text.fail("spectral and xyz colours are not supported; give red, green and blue");
  const double red = text.to_number(first);
  const std::string_view second = text.next_token();
  if (second.empty()) return {red, red, red};
  const double green = text.to_number(second);
  return {red, green, text.number()};
}

}  // namespace

std::vector<Material> read_mtl(const std::filesystem::path& path, Emission emission) {
  const std::string bytes = read_bytes(path);
  TextCursor text(path.string(), bytes);
  std::vector<Material> materials;
  while (text.next_line()) {
    const std::string_view keyword = text.next_token();
    if (keyword == "newmtl") {
      const std::string name(text.rest_of_line());
      materials.push_back({.name = name, .rho = {}, .E = {}, .file = text.file(), .line = text.line()});
    } else if (keyword == "Kd" || keyword == "Ke") {
      if (materials.empty()) text.fail(std::string(keyword) + " comes before any newmtl; name the material first");
      std::vector<double> colour = read_colour(text);
      if (keyword == "Kd") {
        materials.back().rho = std::move(colour);
      } else {
        for (double& band : colour) band = to_exitance(band, emission);
        materials.back().E = std::move(colour);
      }
    }
  }
  return materials;
}

}  // namespace exitance
