#pragma once
// Form factors scaled so that rows sum to 1, for programs that need it. They are no longer what was computed.

#include <cstdint>
#include <optional>

#include "src/form_factor/form_factor_matrix.h"

namespace exitance {

struct ClosedRows {
  FormFactorMatrix matrix;            ///< errors grow by what was changed
  double largest_change = 0;          ///< |F − F before|
  std::uint32_t row = 0, column = 0;  ///< where it is
  double largest_factor = 1;          ///< what an entry was multiplied with, farthest from 1
};

/// d_i F_ij d_j with the one number d_i > 0 a patch for which all rows sum to 1 within 1e-13: what was reciprocal stays
/// so, and a 0 stays 0. Rows without entries stay empty. Found by d_i ← √(d_i / Σ_j F_ij d_j) over and over (Knight,
/// Ruiz and Uçar 2014). None where that has not settled after 1,000 times, as for rows that see one another only but
/// are of different areas. The matrix is square.
std::optional<ClosedRows> close_rows(const FormFactorMatrix& matrix);

}  // namespace exitance
