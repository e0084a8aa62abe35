#include "src/cli/given_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "src/output/manifest.h"
#include "src/scene/scene_hash.h"

namespace exitance {

std::map<std::string, std::string> given_options(const CLI::App& verb) {
  std::map<std::string, std::string> given;
  for (const CLI::Option* option : verb.get_options()) {
    if (option == verb.get_help_ptr()) continue;
    given[option->get_single_name()] =
        option->count() > 0 ? CLI::detail::join(option->results(), " ") : option->get_default_str();
  }
  return given;
}

std::string key_of_run(const CLI::App& verb, std::span<const std::string_view> of_no_consequence, const Scene& scene,
                       const MeshOptions& mesh) {
  std::string key = build_key();
  for (const auto& [name, value] : given_options(verb)) {
    if (std::ranges::find(of_no_consequence, name) == of_no_consequence.end())
      key += fmt::format("{} {}\n", name, value);
  }
  return key + fmt::format("scene {}\nmesh {} {} {}\n", scene_hash(scene), mesh.patch_size, mesh.elements_per_edge,
                           mesh.small_patch);
}

}  // namespace exitance
