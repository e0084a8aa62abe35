#pragma once
// Scenes of experiments with links: what of a scene file they use.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "src/links/linked_radiosity.h"
#include "src/scene/scene_file.h"
#include "tests/places.h"

namespace exitance {

/// To build links by. eps2: a share of the brightest E; smallest_area: [m²].
inline LinkOptions link_options(double eps2, double smallest_area) {
  LinkOptions options;
  options.eps2 = eps2;
  options.eps1 = eps2 / 2;
  options.smallest_area = smallest_area;
  options.tolerance = 1e-5;
  return options;
}

struct LinkScene {
  DynamicScene given;
  std::vector<Edit> edits;          ///< what happens at the time of the first event
  std::vector<std::uint8_t> moves;  ///< by object, whether that is of it

  /// `name`: of a scene file in data/.
  explicit LinkScene(const std::string& name)
      : given(read_dynamic_scene(source_file("data/" + name + ".toml"), Emission::exitance)),
        moves(given.scene.objects.size()) {
    for (const Event& event : given.events) {
      if (event.time != given.events.front().time) break;
      edits.push_back(event.edit);
      moves[event.edit.object] = 1;
    }
  }

  /// With these shares of the eps2 and the smallest area that the file's [links] must have.
  LinkOptions options(double of_eps2, double of_smallest_area) const {
    return link_options(given.links.eps2.value() * of_eps2, given.links.smallest_area.value() * of_smallest_area);
  }
};

}  // namespace exitance
