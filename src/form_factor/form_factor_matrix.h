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

}  // namespace exitance
