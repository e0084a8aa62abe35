#include "src/form_factor/row_closing.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace exitance {
namespace {

constexpr double kClosed = 1e-13;
constexpr int kTimes = 1000;

/// Σ_j F_ij d_j
double scaled_sum(const FormFactorMatrix& matrix, std::size_t i, const std::vector<double>& d) {
  double sum = 0;
  for (std::size_t k = 0; k < matrix.row(i).size(); ++k) sum += matrix.row(i)[k] * d[matrix.row_columns(i)[k]];
  return sum;
}

std::optional<std::vector<double>> scaling(const FormFactorMatrix& matrix) {
  std::vector<double> d(matrix.rows(), 1), sums(matrix.rows());
  for (int time = 0; time < kTimes; ++time) {
    double defect = 0;
    for (std::size_t i = 0; i < d.size(); ++i) {
      sums[i] = scaled_sum(matrix, i, d);
      if (sums[i] > 0) defect = std::max(defect, std::fabs(d[i] * sums[i] - 1));
    }
    if (defect <= kClosed) return d;
    for (std::size_t i = 0; i < d.size(); ++i) {
      if (sums[i] > 0) d[i] = std::sqrt(d[i] / sums[i]);
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<ClosedRows> close_rows(const FormFactorMatrix& matrix) {
  const std::optional<std::vector<double>> d = scaling(matrix);
  if (!d) return std::nullopt;
  ClosedRows closed{.matrix = matrix};
  for (std::uint32_t i = 0; i < matrix.rows(); ++i) {
    for (std::uint64_t k = matrix.row_first[i]; k < matrix.row_first[i + 1]; ++k) {
      const double factor = (*d)[i] * (*d)[matrix.column[k]], change = std::fabs(matrix.F[k] * factor - matrix.F[k]);
      closed.matrix.F[k] = matrix.F[k] * factor;
      closed.matrix.F_error[k] += change;
      if (std::fabs(factor - 1) > std::fabs(closed.largest_factor - 1)) closed.largest_factor = factor;
      if (change <= closed.largest_change) continue;
      closed.largest_change = change;
      closed.row = i;
      closed.column = matrix.column[k];
    }
  }
  return closed;
}

}  // namespace exitance
