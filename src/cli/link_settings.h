#pragma once
// How a verb refines links.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "src/links/linked_radiosity.h"
#include "src/scene/scene_file.h"

namespace exitance {

class LinkSettings {
 public:
  /// Adds --eps, --min-area and --link-points. The object must live as long as the verb.
  void add_to(CLI::App& verb);
  /// Adds --clusters; without it there are none.
  void add_clusters_to(CLI::App& verb);
  /// Adds --eps1 and --b-eps.
  void add_update_to(CLI::App& verb);

  /// As given, else as the scene says, else by default; where clusters are linked and none says how to cut, into
  /// patches of twice the edge of the smallest area. patch_size: as given. The tolerance is the caller's. Throws
  /// CLI::ValidationError where eps1 is above eps.
  LinkOptions chosen(const DynamicScene& scene, std::optional<double> patch_size) const;

  /// Throws CLI::ValidationError where an option of links was given.
  void refuse_any(const char* needed) const;

 private:
  std::optional<double> eps2_, eps1_, B_eps_, smallest_area_;
  unsigned points_ = 2;
  std::string clusters_ = "off";
  std::vector<CLI::Option*> of_links_;
};

}  // namespace exitance
