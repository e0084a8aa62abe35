#pragma once
// exitance cases: a file of single questions.

#include <CLI/CLI.hpp>

namespace exitance {

/// Adds the verb. It throws InputError on a file that cannot be used, and ends with CLI::RuntimeError(3) where single
/// cases were bad; their answers say so and the others are answered.
void add_cases(CLI::App& app);

}  // namespace exitance
