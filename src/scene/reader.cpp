#include "src/scene/reader.h"

#include "src/scene/face_mending.h"
#include "src/scene/input_error.h"
#include "src/scene/mesh_file.h"
#include "src/scene/placement.h"
#include "src/scene/read_vs3.h"
#include "src/scene/scene_extent.h"
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

Scene read_view3d(const std::filesystem::path& path, bool keep_faults) {
  Scene scene = read_vs3(path, keep_faults);
  settle_materials(scene, 1, keep_faults);
  return scene;
}

Scene read_any(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string extension = lower_extension(path);
  const bool is_scene_file = extension == ".toml", is_view3d = extension == ".vs3";
  if (!is_scene_file && !is_view3d) return read_bare_mesh(path, options);
  if (options.flip || options.two_sided) {
    throw InputError(path.string(), 0,
                     is_view3d ? "flip and two-sided are for bare meshes; list the vertices in the other direction, or "
                                 "add surfaces for the other side"
                               : "flip and two-sided are for bare meshes; write flip = true or two_sided = true in the "
                                 "scene file's object");
  }
  return is_view3d ? read_view3d(path, options.keep_faults)
                   : read_scene_file(path, options.emission, options.keep_faults);
}

}  // namespace

Scene read_scene(const std::filesystem::path& path, const ReadOptions& options) {
  Scene scene = read_any(path, options);
  if (!options.keep_faults) refuse_bad_extents(scene, path);
  return scene;
}

}  // namespace exitance
