#pragma once
// Wavefront OBJ.

#include <filesystem>

#include "src/scene/face_list.h"
#include "src/scene/material_check.h"

namespace exitance {

/// Reads v, f (all index forms, negative ones too), usemtl and mtllib (relative to the OBJ). An object is what `o`
/// names; in a file without `o`, what `g` names. Texture coordinates, normals and smoothing are ignored; lines and
/// points too, with a warning that counts them. A missing library is a warning too, as real meshes name some that were
/// never delivered; a material that no library defines keeps its name and has no rho. Throws InputError for a missing
/// file, malformed numbers and vertex numbers that are zero or reach before the first.
FaceList read_obj(const std::filesystem::path& path, Emission emission);

}  // namespace exitance
