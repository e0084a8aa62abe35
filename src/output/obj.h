#pragma once
// Writing a scene as Wavefront OBJ.

#include <filesystem>

#include "src/scene/scene.h"

namespace exitance {

/// Writes the scene's polygons to `path` and its materials beside, with the extension .mtl: Kd is ρ and Ke the emitted
/// exitance E (to be read as exitance, not as radiance). Numbers are the shortest decimals that read back to the same
/// doubles. A polygon with holes, which OBJ does not know, is written as its facets; that a surface is there for
/// obstruction only is lost. One band is written as grey; std::invalid_argument for other numbers of bands than 1
/// and 3, and for a path that does not end in .obj. Either both files are written or none; InputError when that fails.
void write_obj(const Scene& scene, const std::filesystem::path& path);

}  // namespace exitance
