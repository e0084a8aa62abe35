#include "src/scene/reader.h"

#include "src/scene/face_mending.h"
#include "src/scene/input_error.h"
#include "src/scene/mesh_file.h"
#include "src/scene/placement.h"
#include "src/scene/scene_file.h"

namespace exitance {
namespace {

constexpr std::uint32_t kMeshBands = 3;  // linear RGB

Scene read_bare_mesh(const std::filesystem::path& path, const ReadOptions& options) {
  Scene scene = read_mesh(path, options.emission, options.keep_faults);
  mend_faces(scene);
  if (options.flip) flip(scene);
  if (options.two_sided) make_two_sided(scene);
  settle_materials(scene, kMeshBands, options.keep_faults);
  return scene;
}

}  // namespace

Scene read_scene(const std::filesystem::path& path, const ReadOptions& options) {
  if (lower_extension(path) != ".toml") return read_bare_mesh(path, options);
  if (options.flip || options.two_sided) {
    throw InputError(
        path.string(), 0,
        "flip and two-sided are for bare meshes; write flip = true or two_sided = true in the scene file's object");
  }
  return read_scene_file(path, options.emission, options.keep_faults);
}

}  // namespace exitance
