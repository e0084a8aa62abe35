#pragma once
// What every matrix of form factors must keep to: no row sums to more than 1, no entry exceeds min(1, A_j / A_i).

#include <cstdint>
#include <optional>
#include <span>

#include "src/form_factor/form_factor_matrix.h"

namespace exitance {

/// Where something is most: of which row (and column), how much, and how much errors allow.
struct MatrixDefect {
  std::uint32_t row = 0, column = 0;
  double amount = 0, allowed = 0;

  bool holds() const { return amount <= allowed; }
  /// How much of what is allowed is used up; more than 1 does not hold.
  double share() const { return amount == 0 ? 0 : amount / allowed; }
};

struct MatrixCheck {
  std::uint32_t empty_rows = 0;          ///< their sum is exactly 0: buried in a contact, or seeing nothing
  double largest_sum = 0;                ///< of a row
  std::optional<MatrixDefect> excess;    ///< worst Σ_j F_ij − 1 against the row's errors; none without entries
  std::optional<MatrixDefect> closure;   ///< worst |Σ_j F_ij − 1| likewise, of the rows that are not empty
  std::optional<MatrixDefect> entry;     ///< worst F_ij − min(1, A_j / A_i) against its error
  double largest_defect = 0;             ///< |Σ_j F_ij − 1| of the rows that are not empty,
  std::uint32_t largest_defect_row = 0;  ///< and where
  double largest_error = 0;              ///< of an entry
};

/// "Worst" is what uses up most of its errors. Rounding of sums and of areas (relative error 2^-45) is allowed for. The
/// matrix is square; area: of each row, > 0.
MatrixCheck check_matrix(const FormFactorMatrix& matrix, std::span<const double> area);

}  // namespace exitance
