#include "src/cli/frame_files.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "src/cli/console.h"
#include "src/output/vtk.h"
#include "src/scene/scene_check.h"

namespace exitance {

void warn_of_trespass(const std::string& path, const std::map<std::uint32_t, std::uint32_t>& lines,
                      const EditedScene& scene, const PolygonSoup& soup, std::span<const FacetRange> facets) {
  for (const auto& [object, line] : lines) {
    for (const std::string& warning : find_trespass(scene, soup, facets, object))
      print_warning(fmt::format("{}:{}: {}", path, line, warning));
  }
}

std::string in_words(const std::optional<ConvergenceError>& error) {
  const auto number = [](double value) { return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-"; };
  return error ? fmt::format("error {}  of the 1 % {}", number(error->all), number(error->worst_1_percent))
               : "error -  of the 1 % -";
}

void write_frame(const std::filesystem::path& folder, const DynamicScene& scene, const Frame& frame,
                 const std::function<Image(const Camera&)>& picture) {
  const Camera camera = !scene.camera_path.empty() ? camera_at(scene.camera_path, frame.time)
                        : scene.scene.camera       ? *scene.scene.camera
                                                   : default_camera(frame.faces.points(), is_closed(scene.scene));
  const std::string name = fmt::format("frame_{:03}", frame.number);
  write_png(folder / (name + ".png"), picture(camera));
  VtkArray exitance{"B", scene.scene.unit, {}, frame.B};
  if (frame.bands == 3) exitance.components = {"R", "G", "B"};
  for (std::uint32_t b = 0; frame.bands != 1 && frame.bands != 3 && b < frame.bands; ++b)
    exitance.components.push_back(fmt::format("band {}", b));
  write_vtp(folder / (name + ".vtp"), frame.faces, {&exitance, 1});
}

}  // namespace exitance
