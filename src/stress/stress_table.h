#pragma once
// A stress run as a table and as a picture.

#include <filesystem>
#include <string>
#include <vector>

#include "src/stress/stress_run.h"

namespace exitance {

/// Comma-separated, a row a family, departure and contender, under a header.
std::string stress_csv(const StressReport& report);

/// A panel a contender, a field a family and departure: coloured by the worst error of F, or the worst defect of a
/// property where that is larger, with the number of wrong answers and broken properties printed on it. Throws
/// InputError when the file cannot be written.
void write_stress_map(const std::filesystem::path& path, const StressReport& report,
                      const std::vector<std::string>& contenders, const std::string& note);

}  // namespace exitance
