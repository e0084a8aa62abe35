#pragma once
// Objects of a version of a scene where none can be in the world.

#include <cstdint>
#include <string>
#include <vector>

#include "src/dynamic/scene_version.h"

namespace exitance {

/// What is odd about where an object of the scene's present version stands (src/scene/trespass.h).
std::vector<std::string> find_trespass(const EditedScene& scene, const SceneVersion& version, std::uint32_t object);

}  // namespace exitance
