#include "src/form_factor/row_closing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "src/form_factor/matrix_check.h"

namespace exitance {
namespace {

FormFactorMatrix dense(const std::vector<std::vector<double>>& rows, double error = 0) {
  FormFactorMatrix matrix;
  matrix.columns = static_cast<std::uint32_t>(rows.size());
  for (const auto& row : rows) {
    for (std::uint32_t j = 0; j < row.size(); ++j) {
      if (row[j] == 0) continue;
      matrix.column.push_back(j);
      matrix.F.push_back(row[j]);
      matrix.F_error.push_back(error);
    }
    matrix.row_first.push_back(matrix.column.size());
  }
  return matrix;
}

TEST(RowClosing, KeepsReciprocityAndZeros) {
  // A random reciprocal matrix whose rows miss 1 by 1e-3, about.
  constexpr int kPatches = 30;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> about_one(0.9, 1.1), defect(-1e-3, 1e-3);
  std::vector<double> area(kPatches);
  for (double& a : area) a = about_one(random);
  const double all = std::accumulate(area.begin(), area.end(), 0.0);
  std::vector<std::vector<double>> F(kPatches, std::vector<double>(kPatches));
  for (std::size_t i = 0; i < kPatches; ++i) {
    for (std::size_t j = i; j < kPatches; ++j) {
      const double exchange = area[i] * area[j] / all * (1 + defect(random));  // as in a sphere, but for the defect
      F[i][j] = exchange / area[i];
      F[j][i] = exchange / area[j];
    }
  }
  const FormFactorMatrix matrix = dense(F);
  const auto closed = close_rows(matrix);
  ASSERT_TRUE(closed);
  double largest = 0;
  for (std::size_t i = 0; i < kPatches; ++i) {
    const auto row = closed->matrix.row(i);
    EXPECT_NEAR(std::accumulate(row.begin(), row.end(), 0.0), 1, 1e-12);
    for (std::size_t j = 0; j < kPatches; ++j) {
      EXPECT_NEAR(area[i] * row[j], area[j] * closed->matrix.row(j)[i], 1e-15);
      EXPECT_EQ(closed->matrix.row_error(i)[j], std::fabs(row[j] - F[i][j]));
      largest = std::max(largest, std::fabs(row[j] - F[i][j]));
    }
  }
  EXPECT_EQ(closed->largest_change, largest);
  EXPECT_GT(largest, 0);
  EXPECT_EQ(std::fabs(closed->matrix.row(closed->row)[closed->column] - F[closed->row][closed->column]), largest);
}

TEST(RowClosing, LeavesClosedAndEmptyRowsAlone) {
  const FormFactorMatrix matrix = dense({{0, 0.5, 0, 0.5}, {0.5, 0, 0, 0.5}, {0, 0, 0, 0}, {0.5, 0.5, 0, 0}}, 1e-9);
  const auto closed = close_rows(matrix);
  ASSERT_TRUE(closed);
  EXPECT_EQ(closed->matrix.F, matrix.F);
  EXPECT_EQ(closed->matrix.F_error, matrix.F_error);
  EXPECT_EQ(closed->matrix.row_first, matrix.row_first);
  EXPECT_EQ(closed->largest_change, 0);
}

TEST(RowClosing, GivesUpWhereNothingCloses) {
  // Two patches of areas 2 and 1 that see only each other: 2 · 1 can never be 1 · 1.
  EXPECT_FALSE(close_rows(dense({{0, 0.5}, {1, 0}})));
}

TEST(MatrixCheck, FindsTheWorstOfEachKind) {
  const std::vector<double> area{1, 2, 1};
  const MatrixCheck good = check_matrix(dense({{0, 0.6, 0.4}, {0.3, 0, 0.3}, {0.4, 0.6, 0}}, 1e-9), area);
  EXPECT_TRUE(good.excess->holds());
  EXPECT_TRUE(good.entry->holds());
  EXPECT_EQ(good.empty_rows, 0u);
  EXPECT_DOUBLE_EQ(good.largest_sum, 1);
  EXPECT_EQ(good.largest_error, 1e-9);
  EXPECT_FALSE(good.closure->holds());  // row 1 sums to 0.6 only
  EXPECT_EQ(good.closure->row, 1u);
  EXPECT_NEAR(good.largest_defect, 0.4, 1e-15);
  EXPECT_EQ(good.largest_defect_row, 1u);

  const MatrixCheck excess = check_matrix(dense({{0, 0.7, 0.4}, {0.35, 0, 0.3}, {0, 0, 0}}, 1e-9), area);
  EXPECT_FALSE(excess.excess->holds());
  EXPECT_EQ(excess.excess->row, 0u);
  EXPECT_NEAR(excess.excess->amount, 0.1, 1e-15);
  EXPECT_NEAR(excess.excess->allowed, 2e-9, 1e-12);
  EXPECT_EQ(excess.empty_rows, 1u);

  // From 2 m² to 1 m² at most a half.
  const MatrixCheck entry = check_matrix(dense({{0, 0.9, 0}, {0.6, 0, 0}, {0, 0, 0}}, 1e-9), area);
  EXPECT_FALSE(entry.entry->holds());
  EXPECT_EQ(entry.entry->row, 1u);
  EXPECT_EQ(entry.entry->column, 0u);
  EXPECT_NEAR(entry.entry->amount, 0.1, 1e-15);

  const MatrixCheck none = check_matrix(dense({{0, 0}, {0, 0}}), std::vector<double>{1, 1});
  EXPECT_FALSE(none.excess || none.closure || none.entry);
  EXPECT_EQ(none.empty_rows, 2u);
}

}  // namespace
}  // namespace exitance
