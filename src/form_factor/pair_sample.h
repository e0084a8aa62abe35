#pragma once
// Pairs that are integrated again, over both of their patches, to see whether a run's form factors hold.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "src/form_factor/pair_rows.h"

namespace exitance {

/// A difference that should not be, next to what errors allow. Both in form factors of the smaller patch.
struct PairDefect {
  std::uint32_t i = 0, j = 0;  ///< patches
  double amount = 0, allowed = 0;

  bool holds() const { return amount <= allowed; }
  /// How much of what is allowed is used up; more than 1 does not hold.
  double share() const { return amount == 0 ? 0 : amount / allowed; }
};

/// One defect a pair, in the order of the sample.
struct PairSample {
  /// |A_i F_ij − what is found by integrating over i, or over j|, whichever uses up more of its errors. One of them is
  /// the run's own way, the other is independent of it.
  std::vector<PairDefect> reciprocity;
  /// By how much the pair exchanges more than it would with nothing in between; below 0 where it is less.
  std::vector<PairDefect> beyond_unobstructed;
  bool complete = true;  ///< false: options.stop ended the work, and both are empty
};

/// Integrates up to `count` pairs of different patches again, chosen at random among those of the rows that are
/// partial. In parallel; the same for any number of threads and any division of the rows into parts. `points` limits
/// what each integral may take; one that is stopped by it has a larger error, which is allowed for.
PairSample sample_pairs(const ExchangeScene& scene, std::span<const PairRows> rows, const PairOptions& options,
                        std::size_t count, std::uint64_t seed);

}  // namespace exitance
