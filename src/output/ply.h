#pragma once
// Stanford polygon files (.ply) with a colour at every vertex.

#include <cstdint>
#include <filesystem>
#include <span>

#include "src/output/faces.h"
#include "src/output/shading.h"

namespace exitance {

/// Binary, little-endian; coordinates in double, colours tone-mapped (tone_map.h) with the exposure set by the area of
/// whatever does not emit. Constant shading gives each face its own vertices, smooth shading shares them within a
/// surface. Throws InputError when the file cannot be written.
void write_ply(const std::filesystem::path& path, const Faces& faces, const Appearance& appearance, Shading shading);

}  // namespace exitance
