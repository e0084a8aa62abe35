#pragma once
// Scenes from files: one door for all formats.

#include <filesystem>

#include "src/scene/material_check.h"
#include "src/scene/scene.h"

namespace exitance {

struct ReadOptions {
  Emission emission = Emission::exitance;  ///< how MTL's Ke is meant, and E in a TOML file that does not say
  bool flip = false;                       ///< turn every face over; bare meshes only
  bool two_sided = false;                  ///< add every face again, turned over; bare meshes only (after flip)
  /// For checking: leave coordinates that are not finite, reflectances and emissions out of range and, in scene files,
  /// polygons that cross themselves, and sizes that cannot be computed with in the scene, for check_scene to list,
  /// where they would be refused.
  bool keep_faults = false;
};

/// Reads .obj (with its .mtl), .ply, .off, .stl, .toml (see scene_file.h) or .vs3 (see read_vs3.h), whatever the case
/// of the extension.
/// Polygons stay polygons, in file order, coordinates the doubles nearest to what is written. Faces of meshes that
/// cross themselves are mended and zero-area faces kept (see face_mending.h), materials that are missing are replaced
/// by rho 0.5, E 0, each with a warning in the scene. Throws InputError for a missing or unreadable file, an unknown
/// extension, a truncated mesh, malformed or non-finite numbers, a face with fewer than three vertices, a vertex number
/// out of range, rho outside [0, 1), E negative, too small or too large, sizes that cannot be computed with
/// (scene_extent.h), and a scene in which no surface has an area and is more than an obstruction.
Scene read_scene(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace exitance
