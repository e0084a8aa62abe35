#pragma once
// Rows of form factors between patches, every pair once: row i holds the pairs of patch i with itself and those after
// it.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "src/form_factor/form_factor_matrix.h"
#include "src/form_factor/pair_form_factor.h"

namespace exitance {

/// Finished rows, as compressed as a FormFactorMatrix.
struct PairRows {
  std::vector<std::uint32_t> row;           ///< their numbers, in any order
  std::vector<std::uint64_t> row_first{0};  ///< size rows + 1
  std::vector<std::uint32_t> column;        ///< of each pair
  std::vector<double> F, F_error, F_reverse, F_reverse_error;
  std::vector<std::uint8_t> mark;  ///< what else its run wants to know of a pair: its class, whether it was reached
};

/// A pair's mark: its class, and whether it reached its tolerance.
std::uint8_t mark_of(const PairFormFactor& pair);
PairClass class_of(std::uint8_t mark);
bool reached_of(std::uint8_t mark);

/// What became of pairs, by class.
struct PairStatistics {
  std::array<std::uint64_t, 4> pairs{};
  std::array<double, 4> seconds{};  ///< of one thread's time
  std::uint64_t points = 0;         ///< that were looked from
  std::uint64_t unreached = 0;

  PairStatistics& operator+=(const PairStatistics& other);
};

/// Rows of some patches: in each the pairs (i, j), j ≥ i, ascending, but for those that face away. In parallel; any
/// number of threads gives the same bits. Adds to the statistics. Where options.stop ends the work, only the rows that
/// were finished are there.
PairRows pair_rows(const ExchangeScene& scene, std::span<const std::uint32_t> rows, const PairOptions& options,
                   PairStatistics& statistics);

/// Puts more rows behind those that are there.
void append(PairRows& rows, const PairRows& more);

/// How many pairs of so many patches belong to each class; those in no row face away. Every row must be there once.
std::array<std::uint64_t, 4> pairs_by_class(std::span<const PairRows> rows, std::uint64_t patches);

/// Share of all pairs of patches that do not face away, about, from a sample of up to 65,536 of them: rows keep those.
double expected_pair_density(const ExchangeScene& scene);

/// Most memory [bytes] that the rows of so many patches, and the matrix made of them, take at a time when that share of
/// the pairs is kept. Saturates at 2^63.
std::uint64_t pair_rows_bytes(std::uint64_t patches, double density);

/// The whole matrix of so many patches; entries that are 0 without error are left out. Every row must be there once.
FormFactorMatrix matrix_of(std::span<const PairRows> rows, std::uint32_t patches);

}  // namespace exitance
