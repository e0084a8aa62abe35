#pragma once
// What a stress run knows so far, kept in a file from which the same command goes on.

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "src/stress/stress_run.h"

namespace exitance {

/// key: everything the answers depend on, by name.
using StressKey = std::map<std::string, std::string>;

/// None where there is no file. Throws InputError where it is of a run with another key, or no such file.
std::optional<StressState> read_stress_state(const std::filesystem::path& file, const StressKey& key);

/// Whole or not at all. Throws InputError when it cannot be written.
void write_stress_state(const std::filesystem::path& file, const StressKey& key, const StressState& state);

}  // namespace exitance
