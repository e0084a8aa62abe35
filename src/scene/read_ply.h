#pragma once
// Polygon files (PLY), text and binary of either byte order.

#include <filesystem>

#include "src/scene/face_list.h"

namespace exitance {

/// Reads x, y, z of the element `vertex` and the list `vertex_indices` (or `vertex_index`) of the element `face`, of
/// any scalar type; all other elements and properties are skipped. In text files coordinates are the doubles nearest to
/// what is written, whatever type the header declares. Throws InputError for a header it cannot follow, malformed
/// numbers and truncated files.
FaceList read_ply(const std::filesystem::path& path);

}  // namespace exitance
