#pragma once
// Where tests, experiments and bench find what they run and read. Only places.cpp knows, so that all else compiles
// alike in every folder and its objects come from the compiler's cache.

#include <string>

namespace exitance {

/// The built program `exitance`.
std::string program();

/// A file or folder of the source tree, such as "data/hall.toml".
std::string source_file(const std::string& name);

}  // namespace exitance
