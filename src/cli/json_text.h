#pragma once
// JSON files, with numbers that are none.

#include <nlohmann/json.hpp>
#include <string>

namespace exitance {

/// Reads a JSON file. NaN, Infinity and -Infinity, which other programs write though JSON has no words for them, and
/// numbers too large for a double all become an infinity, so that whoever uses the number can refuse it by its name and
/// the rest of the file is read. Throws InputError with file and line on anything else that is not JSON, on lists
/// and objects more than 100 deep, and when the file cannot be read.
nlohmann::json read_json(const std::string& path);

}  // namespace exitance
