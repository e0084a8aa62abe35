#pragma once
// Material libraries of OBJ files (MTL): Kd is the reflectance, Ke the emission, the rest does not matter to a diffuse
// world.

#include <filesystem>
#include <vector>

#include "src/scene/material_check.h"

namespace exitance {

/// The materials in file order, three bands each; without Kd, rho is empty. Throws InputError for a missing file and
/// malformed or missing numbers; ranges are not checked (settle_materials does, for what is used).
std::vector<Material> read_mtl(const std::filesystem::path& path, Emission emission);

}  // namespace exitance
