#pragma once
// The options of a verb, for the manifest of its results.

#include <CLI/CLI.hpp>
#include <map>
#include <string>

namespace exitance {

/// All options but --help, by name without dashes, as given or by default.
std::map<std::string, std::string> given_options(const CLI::App& verb);

}  // namespace exitance
