#include "src/reference/matrix_comparison.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

namespace exitance {
namespace {

EntryErrors errors_of(std::vector<double> apart) {
  EntryErrors errors{.pairs = apart.size()};
  if (apart.empty()) return errors;
  for (const double a : apart) {
    errors.largest = std::max(errors.largest, a);
    errors.rms += a * a;
  }
  errors.rms = std::sqrt(errors.rms / static_cast<double>(apart.size()));
  const auto place = apart.begin() + static_cast<std::ptrdiff_t>(apart.size() - 1 - apart.size() / 1000);
  std::ranges::nth_element(apart, place);
  errors.largest_of_999 = *place;
  return errors;
}

/// Entries of a row, or their errors, in all of its columns.
void fill(std::span<const double> entries, const FormFactorMatrix& F, std::size_t row, std::vector<double>& values) {
  values.assign(F.columns, 0);
  for (std::size_t k = 0; k < entries.size(); ++k) values[F.row_columns(row)[k]] = entries[k];
}

}  // namespace

MatrixTruth truth_of(const std::vector<PairRows>& rows, std::uint32_t patches) {
  MatrixTruth truth{matrix_of(rows, patches), std::vector(std::size_t{patches} * patches, PairClass::facing_away)};
  for (const PairRows& part : rows) {
    for (std::size_t r = 0; r < part.row.size(); ++r) {
      for (std::uint64_t k = part.row_first[r]; k < part.row_first[r + 1]; ++k) {
        const std::size_t i = part.row[r], j = part.column[k];
        truth.kind[i * patches + j] = truth.kind[j * patches + i] = class_of(part.mark[k]);
      }
    }
  }
  return truth;
}

MatrixComparison compare(const MatrixTruth& truth, const FormFactorMatrix& F, std::size_t worst,
                         std::span<const double> standard_error) {
  const std::size_t n = truth.patches();
  if (F.rows() != n || F.columns != n) throw std::invalid_argument("compare: matrices of different sizes");
  const bool claims = !standard_error.empty();
  if (claims && standard_error.size() != F.F.size())
    throw std::invalid_argument("compare: standard errors are not those of the matrix");
  std::uint64_t beyond = 0;
  MatrixComparison result;
  std::array<std::vector<double>, 4> apart;
  std::vector<double> facing, of_truth, error_of_truth, of_F, claimed;
  const auto less_wrong = [](const WorstPair& a, const WorstPair& b) {
    return std::fabs(a.F - a.truth) > std::fabs(b.F - b.truth);  // the front of the heap is the least wrong
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    fill(truth.F.row(i), truth.F, i, of_truth);
    fill(truth.F.row_error(i), truth.F, i, error_of_truth);
    fill(F.row(i), F, i, of_F);
    if (claims) fill(standard_error.subspan(F.row_first[i], F.row(i).size()), F, i, claimed);
    for (std::uint32_t j = 0; j < n; ++j) {
      WorstPair pair{i, j, of_F[j], of_truth[j], error_of_truth[j], {}};
      if (claims) pair.standard_error = claimed[j];
      const double error = std::fabs(pair.F - pair.truth);
      const PairClass kind = truth.kind[i * n + j];
      apart[static_cast<std::size_t>(kind)].push_back(error);
      if (kind != PairClass::facing_away) {
        facing.push_back(error);
        beyond += claims && error > 3 * claimed[j] + pair.truth_error;
      }
      if (!(error > 0) || worst == 0) continue;
      if (result.worst.size() == worst) {
        if (!less_wrong(pair, result.worst.front())) continue;
        std::ranges::pop_heap(result.worst, less_wrong);
        result.worst.pop_back();
      }
      result.worst.push_back(pair);
      std::ranges::push_heap(result.worst, less_wrong);
    }
  }
  std::ranges::sort_heap(result.worst, less_wrong);
  for (std::size_t k = 0; k < apart.size(); ++k) result.of_class[k] = errors_of(std::move(apart[k]));
  if (claims && !facing.empty())
    result.beyond_3_standard_errors = static_cast<double>(beyond) / static_cast<double>(facing.size());
  result.facing = errors_of(std::move(facing));
  return result;
}

}  // namespace exitance
