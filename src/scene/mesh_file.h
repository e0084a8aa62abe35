#pragma once
// Mesh files of any format.

#include <filesystem>

#include "src/scene/material_check.h"
#include "src/scene/scene.h"

namespace exitance {

/// The faces of an .obj, .ply, .off or .stl file as they stand there: nothing mended, materials without defaults,
/// ranges unchecked. keep_faults leaves coordinates in that are not finite. Throws InputError as read_scene does.
Scene read_mesh(const std::filesystem::path& path, Emission emission, bool keep_faults);

/// The extension in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& path);

}  // namespace exitance
