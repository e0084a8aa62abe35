#pragma once
// Which numbers an option takes.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>

namespace exitance {

/// More threads than this are asked for by mistake only, and cost memory before any of them works.
inline constexpr std::uint64_t kMostThreads = 1024;

/// Checks for options. Each refuses what is no number, NaN, infinity, what overflows or vanishes in a double, and what
/// lies outside the range, with a message that tells the range.
CLI::Validator positive_number();
CLI::Validator number_between(double lowest, double highest = std::numeric_limits<double>::max());
/// Decimal digits only.
CLI::Validator whole_number_between(std::uint64_t lowest,
                                    std::uint64_t highest = std::numeric_limits<std::uint64_t>::max());

}  // namespace exitance
