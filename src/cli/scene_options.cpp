#include "src/cli/scene_options.h"

#include <filesystem>

#include "src/scene/reader.h"

namespace exitance {

void SceneOptions::add_to(CLI::App& verb) {
  verb.add_option("SCENE", path_, "Scene: .toml, .obj, .ply, .off, .stl or .vs3")->required();
  verb.add_option("--emission", emission_, "What Ke (and E where a scene file does not say) means")
      ->check(CLI::IsMember({"exitance", "radiance"}))
      ->capture_default_str();
  verb.add_flag("--flip", flip_, "Turn every face of a mesh over");
  verb.add_flag("--two-sided", two_sided_, "Add every face of a mesh again, turned over");
}

Scene SceneOptions::read(bool keep_faults) const {
  return read_scene(path_, {.emission = emission_ == "radiance" ? Emission::radiance : Emission::exitance,
                            .flip = flip_,
                            .two_sided = two_sided_,
                            .keep_faults = keep_faults});
}

DynamicScene SceneOptions::read_dynamic() const {
  if (std::filesystem::path(path_).extension() == ".toml")
    return read_dynamic_scene(path_, emission_ == "radiance" ? Emission::radiance : Emission::exitance);
  return {.scene = read(), .links = {}, .events = {}, .camera_path = {}};
}

}  // namespace exitance
