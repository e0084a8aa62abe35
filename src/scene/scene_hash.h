#pragma once
// A name for what a scene contains, by which results are recognised.

#include <string>

#include "src/scene/scene.h"

namespace exitance {

/// The same for scenes with bit for bit the same polygons, reflectances, emissions, bands and unit in the same order,
/// whatever their names, files and cameras. A UUID of version 5 (122 bits of SHA-1).
std::string scene_hash(const Scene& scene);

}  // namespace exitance
