#pragma once
// What stands in the shafts between a receiver and a source: open, blocked, partial.

#include "src/stress/verdict.h"

namespace exitance {

/// What is said of a shaft, or of one thing in it.
enum class ShaftClass : std::uint8_t {
  outside,  ///< of a thing: does not enter; of a shaft: open
  partial,
  blocking,  ///< of a shaft: one thing blocks every line
  away,      ///< of a shaft: the ends do not face each other
  torn       ///< of a thing: the search does not say what the test of it alone says
};

/// Asks Shaft about up to four pairs of facets. Opinion::classes: of each shaft what is said of it and then, unless it
/// is away, of each item of the soup's index. Opinion::visibility: what is said of all shafts, `partial` where that
/// differs.
Opinion ask_shafts(const Question& question);

/// What may be said, by ShaftOracle: exactly one class, but for solids that no plane of their own separates from the
/// ends, where partial may stand for blocking. Besides, twelve exact lines are looked along in each shaft: it is not
/// open where one of them is blocked, and not blocked where one of them is free. Takes milliseconds.
Truth shaft_truth(const Question& question);

}  // namespace exitance
