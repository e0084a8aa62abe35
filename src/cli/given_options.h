#pragma once
// The options of a verb, for the manifest of its results and the key of what is kept of them.

#include <CLI/CLI.hpp>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "src/scene/patch_mesh.h"
#include "src/scene/scene.h"

namespace exitance {

/// All options but --help, by name without dashes, as given or by default.
std::map<std::string, std::string> given_options(const CLI::App& verb);

/// This build, those options that are not of no consequence, scene and mesh, one "name value" a line: what a checkpoint
/// depends on.
std::string key_of_run(const CLI::App& verb, std::span<const std::string_view> of_no_consequence, const Scene& scene,
                       const MeshOptions& mesh);

}  // namespace exitance
