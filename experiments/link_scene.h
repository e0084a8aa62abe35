#pragma once
// Scenes of experiments with links: what of a scene file they use.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "src/links/linked_radiosity.h"
#include "src/scene/scene_file.h"

namespace exitance {

struct LinkScene {
  DynamicScene given;
  std::vector<Edit> edits;          ///< what happens at the time of the first event
  std::vector<std::uint8_t> moves;  ///< by object, whether that is of it

  /// `name`: of a scene file in data/, which has [links] with eps2 and smallest_area.
  explicit LinkScene(const std::string& name)
      : given(read_dynamic_scene(std::filesystem::path(EXITANCE_SOURCE_DIR) / "data" / (name + ".toml"),
                                 Emission::exitance)),
        moves(given.scene.objects.size()) {
    for (const Event& event : given.events) {
      if (event.time != given.events.front().time) break;
      edits.push_back(event.edit);
      moves[event.edit.object] = 1;
    }
  }

  /// With these shares of the file's eps2 and smallest area.
  LinkOptions options(double of_eps2, double of_smallest_area) const {
    LinkOptions options;
    options.eps2 = given.links.eps2.value() * of_eps2;
    options.eps1 = options.eps2 / 2;
    options.smallest_area = given.links.smallest_area.value() * of_smallest_area;
    options.tolerance = 1e-5;
    return options;
  }
};

}  // namespace exitance
