#pragma once
// What produced a result.

#include <map>
#include <string>

namespace exitance {

/// Of this build: versions as "1.2.3".
struct Manifest {
  std::string version;
  std::string commit;  ///< "unknown" when built outside a git checkout
  std::string compiler;
  std::map<std::string, std::string> libraries;  ///< by name
};

Manifest build_manifest();

/// Of this build, one "name value" a line, for the keys of what is kept to go on with: another build may give other
/// bits.
std::string build_key();

}  // namespace exitance
