#pragma once
// Rows of form factors, compressed: from each receiver to every patch it sees something of.

#include <cstdint>
#include <span>
#include <vector>

namespace exitance {

/// One row a receiver (an element, or a patch where rows were averaged), one column a patch. Columns ascend in a row.
struct FormFactorMatrix {
  std::vector<std::uint64_t> row_first{0};  ///< size rows + 1
  std::vector<std::uint32_t> column;
  std::vector<double> F;
  std::vector<double> F_error;  ///< bound of |F − true|, one for each F
  std::uint32_t columns = 0;

  std::size_t rows() const { return row_first.size() - 1; }
  std::span<const std::uint32_t> row_columns(std::size_t i) const {
    return {column.data() + row_first[i], column.data() + row_first[i + 1]};
  }
  std::span<const double> row(std::size_t i) const { return {F.data() + row_first[i], F.data() + row_first[i + 1]}; }
  std::span<const double> row_error(std::size_t i) const {
    return {F_error.data() + row_first[i], F_error.data() + row_first[i + 1]};
  }
};

/// Σ_q F_iq of every row.
std::vector<double> row_sums(const FormFactorMatrix& matrix);

/// Rows of patches from rows of elements: F̄_pq = Σ_e a_e F_eq / Σ_e a_e over the elements of p, which are
/// element_first[p] … element_first[p + 1] − 1. Errors are averaged likewise and enlarged by the rounding of the mean.
/// A patch without elements, or of zero area, gets an empty row. element_first: patches + 1, ascending from 0 to the
/// number of rows; element_area: one a row, ≥ 0. Throws std::invalid_argument when the sizes do not fit.
FormFactorMatrix average_rows(const FormFactorMatrix& elements, std::span<const std::uint32_t> element_first,
                              std::span<const double> element_area);

/// Columns become rows: row q of the result holds what every receiver sees of patch q. Rows must number below 2^32.
FormFactorMatrix transpose(const FormFactorMatrix& matrix);

/// Memory [bytes] of a matrix in which the share `density` in [0, 1] of all entries is kept. Saturates at 2^64 − 1.
std::uint64_t matrix_bytes(std::uint64_t rows, std::uint64_t columns, double density);

}  // namespace exitance
