#pragma once
// The scene that a verb works on, and how it is read.

#include <CLI/CLI.hpp>
#include <string>

#include "src/scene/scene_file.h"

namespace exitance {

class SceneOptions {
 public:
  /// Adds SCENE, --emission, --flip and --two-sided. The object must live as long as the verb.
  void add_to(CLI::App& verb);

  /// keep_faults: see ReadOptions. Throws InputError.
  Scene read(bool keep_faults = false) const;

  /// The scene with what its file tells of its events and links: nothing, where it is no scene file.
  DynamicScene read_dynamic() const;

 private:
  std::string path_, emission_ = "exitance";
  bool flip_ = false, two_sided_ = false;
};

}  // namespace exitance
