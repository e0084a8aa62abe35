#pragma once
// Objects where none can be in the world: through walls, or out of the scene. Both are legal geometry.

#include <cstdint>
#include <string>
#include <vector>

#include "src/dynamic/scene_version.h"

namespace exitance {

/// What is odd about where an object of the scene's present version stands, in words; empty where nothing is:
///  - an edge of the object passes through the interior of another object's face, or the other way round (exact;
///    touching, edge on edge and faces in contact are in order);
///  - all of the object lies outside of the box around all others, if there are others.
/// Nothing is said of an object that is not there.
std::vector<std::string> find_trespass(const EditedScene& scene, const SceneVersion& version, std::uint32_t object);

}  // namespace exitance
