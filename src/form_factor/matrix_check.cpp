#include "src/form_factor/matrix_check.h"

#include <algorithm>
#include <cmath>

namespace exitance {
namespace {

/// Of an area, or of a quotient of two.
constexpr double kAreaRounding = 0x1p-44;

/// Of equals the first.
void keep_worse(std::optional<MatrixDefect>& worst, const MatrixDefect& other) {
  if (!worst || other.share() > worst->share()) worst = other;
}

}  // namespace

MatrixCheck check_matrix(const FormFactorMatrix& matrix, std::span<const double> area) {
  MatrixCheck check;
  const std::vector<double> sums = row_sums(matrix);
  for (std::uint32_t i = 0; i < matrix.rows(); ++i) {
    const auto columns = matrix.row_columns(i);
    const auto F = matrix.row(i), F_error = matrix.row_error(i);
    double errors = kAreaRounding + static_cast<double>(F.size()) * 0x1p-52;
    for (std::size_t k = 0; k < F.size(); ++k) {
      errors += F_error[k];
      check.largest_error = std::max(check.largest_error, F_error[k]);
      const double limit = std::min(1.0, area[columns[k]] / area[i]);
      keep_worse(check.entry, {i, columns[k], F[k] - limit, F_error[k] + kAreaRounding * limit});
    }
    if (sums[i] == 0) {
      ++check.empty_rows;
      continue;
    }
    check.largest_sum = std::max(check.largest_sum, sums[i]);
    keep_worse(check.excess, {i, 0, sums[i] - 1, errors});
    const double defect = std::fabs(sums[i] - 1);
    keep_worse(check.closure, {i, 0, defect, errors});
    if (defect <= check.largest_defect) continue;
    check.largest_defect = defect;
    check.largest_defect_row = i;
  }
  return check;
}

}  // namespace exitance
