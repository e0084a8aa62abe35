#pragma once
// Object File Format (OFF), text, as described by Geomview.

#include <filesystem>

#include "src/scene/face_list.h"

namespace exitance {

/// Reads OFF with optional colours, normals and texture coordinates ([ST][C][N]OFF), which are ignored. One vertex and
/// one face a line. Throws InputError for binary and four-dimensional files, malformed numbers and truncated files.
FaceList read_off(const std::filesystem::path& path);

}  // namespace exitance
