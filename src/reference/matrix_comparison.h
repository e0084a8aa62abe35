#pragma once
// A form-factor matrix against the truth: how wrong it is, by class of pair, and where most.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "src/form_factor/form_factor_matrix.h"
#include "src/form_factor/pair_rows.h"

namespace exitance {

/// What is known of all ordered pairs of patches.
struct MatrixTruth {
  FormFactorMatrix F;           ///< patches × patches
  std::vector<PairClass> kind;  ///< of pair (i, j) at [i · patches + j]

  std::size_t patches() const { return F.rows(); }
};

/// Every row must be there once.
MatrixTruth truth_of(const std::vector<PairRows>& rows, std::uint32_t patches);

/// |F − truth| of some pairs.
struct EntryErrors {
  std::uint64_t pairs = 0;
  double largest = 0;
  double largest_of_999 = 0;  ///< the largest when the worst thousandth is left out
  double rms = 0;
};

struct WorstPair {
  std::uint32_t i = 0, j = 0;
  double F = 0, truth = 0;
  double truth_error = 0;                     ///< of what is taken for true
  std::optional<double> standard_error = {};  ///< that is claimed of F
};

struct MatrixComparison {
  std::array<EntryErrors, 4> of_class;  ///< by PairClass of the truth
  EntryErrors facing;                   ///< of all pairs that do not face away
  std::vector<WorstPair> worst;         ///< largest |F − truth| first, of all pairs; without those that are right
  /// Share of the pairs that do not face away whose |F − truth| is more than three standard errors and the truth's own
  /// error; none without standard errors.
  std::optional<double> beyond_3_standard_errors;
};

/// Both are patches × patches, or std::invalid_argument. worst: so many pairs at most. standard_error: one for each
/// entry of F, or none at all; what has no entry claims to be 0 without error.
MatrixComparison compare(const MatrixTruth& truth, const FormFactorMatrix& F, std::size_t worst,
                         std::span<const double> standard_error = {});

}  // namespace exitance
