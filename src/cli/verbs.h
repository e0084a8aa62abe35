#pragma once
// The verbs of the program. Each function adds one: its options, and a callback that does the work.

#include <CLI/CLI.hpp>

namespace exitance {

/// How the program ends. A callback that does not end well throws CLI::RuntimeError with one of these; InputError is
/// bad_input and LimitError limit_reached by themselves (main.cpp).
enum ExitCode : int { done = 0, check_failed = 1, usage = 2, bad_input = 3, limit_reached = 4 };

void add_check(CLI::App& app);
void add_compare(CLI::App& app);
void add_diff(CLI::App& app);
void add_dynamic(CLI::App& app);
void add_formfactor(CLI::App& app);
void add_generate(CLI::App& app);
void add_reference(CLI::App& app);
void add_solve(CLI::App& app);
void add_stress(CLI::App& app);

}  // namespace exitance
