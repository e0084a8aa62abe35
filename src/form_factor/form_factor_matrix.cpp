#include "src/form_factor/form_factor_matrix.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace exitance {
namespace {

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

// A row spread out over all columns; only what was touched is cleared again.
struct WideRow {
  std::vector<double> F, F_error;
  std::vector<std::uint32_t> touched;
  std::vector<bool> is_touched;

  explicit WideRow(std::size_t columns) : F(columns), F_error(columns), is_touched(columns) {}

  void add(double weight, std::span<const std::uint32_t> columns, std::span<const double> values,
           std::span<const double> errors) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const std::uint32_t q = columns[k];
      if (!is_touched[q]) {
        is_touched[q] = true;
        touched.push_back(q);
      }
      F[q] += weight * values[k];
      F_error[q] += weight * errors[k];
    }
  }

  void clear() {
    for (const std::uint32_t q : touched) {
      F[q] = F_error[q] = 0;
      is_touched[q] = false;
    }
    touched.clear();
  }
};

void check_sizes(const FormFactorMatrix& elements, std::span<const std::uint32_t> element_first,
                 std::span<const double> element_area) {
  const bool fits = !element_first.empty() && element_first.front() == 0 && element_first.back() == elements.rows() &&
                    std::is_sorted(element_first.begin(), element_first.end()) &&
                    element_area.size() == elements.rows();
  if (!fits) throw std::invalid_argument("average_rows: elements of the patches and rows of the matrix do not match");
}

}  // namespace

std::vector<double> row_sums(const FormFactorMatrix& matrix) {
  std::vector<double> sums(matrix.rows());
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    const auto row = matrix.row(i);
    sums[i] = std::accumulate(row.begin(), row.end(), 0.0);
  }
  return sums;
}

FormFactorMatrix average_rows(const FormFactorMatrix& elements, std::span<const std::uint32_t> element_first,
                              std::span<const double> element_area) {
  check_sizes(elements, element_first, element_area);
  const std::size_t patches = element_first.size() - 1;

  // First the pattern (how many columns each patch's row has), then the values into their final place, so that the
  // entries are never held twice.
  tbb::enumerable_thread_specific<WideRow> scratch(elements.columns);
  const auto averaged = [&](std::size_t p) -> WideRow& {
    WideRow& wide = scratch.local();
    wide.clear();
    double area = 0;
    for (std::uint32_t e = element_first[p]; e < element_first[p + 1]; ++e) area += element_area[e];
    if (!(area > 0)) return wide;
    for (std::uint32_t e = element_first[p]; e < element_first[p + 1]; ++e) {
      wide.add(element_area[e] / area, elements.row_columns(e), elements.row(e), elements.row_error(e));
    }
    std::sort(wide.touched.begin(), wide.touched.end());
    return wide;
  };

  FormFactorMatrix result;
  result.columns = elements.columns;
  result.row_first.assign(patches + 1, 0);
  const tbb::blocked_range<std::size_t> all(0, patches, 16);
  tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& some) {
    for (std::size_t p = some.begin(); p < some.end(); ++p) result.row_first[p + 1] = averaged(p).touched.size();
  });
  std::partial_sum(result.row_first.begin(), result.row_first.end(), result.row_first.begin());
  result.column.resize(result.row_first.back());
  result.F.resize(result.row_first.back());
  result.F_error.resize(result.row_first.back());
  tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& some) {
    for (std::size_t p = some.begin(); p < some.end(); ++p) {
      const WideRow& wide = averaged(p);
      // k summed terms, and k roundings of the area, a quotient and a product in each: below (2 k + 4) u of the mean.
      const double rounding = (2.0 * (element_first[p + 1] - element_first[p]) + 4) * kUnitRoundoff;
      std::uint64_t k = result.row_first[p];
      for (const std::uint32_t q : wide.touched) {
        result.column[k] = q;
        result.F[k] = wide.F[q];
        result.F_error[k] = wide.F_error[q] * (1 + rounding) + rounding * wide.F[q];
        ++k;
      }
    }
  });
  return result;
}

FormFactorMatrix transpose(const FormFactorMatrix& matrix) {
  FormFactorMatrix result;
  result.columns = static_cast<std::uint32_t>(matrix.rows());
  result.row_first.assign(std::size_t{matrix.columns} + 1, 0);
  for (const std::uint32_t q : matrix.column) ++result.row_first[q + 1];
  std::partial_sum(result.row_first.begin(), result.row_first.end(), result.row_first.begin());
  result.column.resize(matrix.column.size());
  result.F.resize(matrix.column.size());
  result.F_error.resize(matrix.column.size());
  std::vector<std::uint64_t> next(result.row_first.begin(), result.row_first.end() - 1);
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    for (std::uint64_t k = matrix.row_first[i]; k < matrix.row_first[i + 1]; ++k) {
      const std::uint64_t at = next[matrix.column[k]]++;
      result.column[at] = static_cast<std::uint32_t>(i);
      result.F[at] = matrix.F[k];
      result.F_error[at] = matrix.F_error[k];
    }
  }
  return result;
}

std::uint64_t matrix_bytes(std::uint64_t rows, std::uint64_t columns, double density) {
  constexpr double per_entry = sizeof(std::uint32_t) + 2 * sizeof(double);
  const double bytes = static_cast<double>(rows + 1) * sizeof(std::uint64_t) +
                       static_cast<double>(rows) * static_cast<double>(columns) * density * per_entry;
  constexpr double limit = 18446744073709551615.0;
  return bytes < limit ? static_cast<std::uint64_t>(bytes) : std::numeric_limits<std::uint64_t>::max();
}

}  // namespace exitance
