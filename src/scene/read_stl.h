#pragma once
// Stereolithography files (STL), text and binary.

#include <filesystem>

#include "src/scene/face_list.h"

namespace exitance {

/// Reads the triangles' vertices as they are given; normals and attributes are ignored, each `solid` of a text file is
/// an object. A file is binary when its length is what its triangle count says. Throws InputError for malformed and
/// truncated files.
FaceList read_stl(const std::filesystem::path& path);

}  // namespace exitance
