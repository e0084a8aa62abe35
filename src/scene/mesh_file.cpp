#include "src/scene/mesh_file.h"

#include <algorithm>
#include <cctype>

#include "src/scene/face_list.h"
#include "src/scene/input_error.h"
#include "src/scene/read_obj.h"
#include "src/scene/read_off.h"
#include "src/scene/read_ply.h"
#include "src/scene/read_stl.h"

namespace exitance {
namespace {

FaceList read_faces(const std::filesystem::path& path, Emission emission) {
  const std::string extension = lower_extension(path);
  if (extension == ".obj") return read_obj(path, emission);
  if (extension == ".ply") return read_ply(path);
  if (extension == ".off") return read_off(path);
  if (extension == ".stl") return read_stl(path);
  throw InputError(path.string(), 0,
                   "the extension \"" + extension + "\" is not known; use .obj, .ply, .off, .stl, .toml or .vs3");
}

}  // namespace

Scene read_mesh(const std::filesystem::path& path, Emission emission, bool keep_faults) {
  return to_scene(read_faces(path, emission), keep_faults);
}

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace exitance
