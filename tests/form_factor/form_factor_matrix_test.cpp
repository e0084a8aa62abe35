#include "src/form_factor/form_factor_matrix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace exitance {
namespace {

using testing::ElementsAre;

// Three elements × four patches; the second row is empty.
FormFactorMatrix example() {
  FormFactorMatrix m;
  m.columns = 4;
  m.row_first = {0, 2, 2, 4};
  m.column = {1, 3, 0, 1};
  m.F = {0.5, 0.25, 0.125, 0.25};
  m.F_error = {1e-3, 2e-3, 4e-3, 8e-3};
  return m;
}

TEST(RowSums, OfEveryRow) {
  EXPECT_THAT(row_sums(example()), ElementsAre(0.75, 0.0, 0.375));
}

TEST(AverageRows, WeighsByArea) {
  // Patch 0 has elements 0 and 1 (areas 3 and 1), patch 1 has element 2.
  const FormFactorMatrix mean =
      average_rows(example(), std::vector<std::uint32_t>{0, 2, 3}, std::vector<double>{3, 1, 5});
  EXPECT_THAT(mean.row_first, ElementsAre(0, 2, 4));
  EXPECT_THAT(mean.column, ElementsAre(1, 3, 0, 1));
  EXPECT_THAT(mean.F, ElementsAre(0.375, 0.1875, 0.125, 0.25));
  EXPECT_EQ(mean.columns, 4u);
  ASSERT_EQ(mean.F_error.size(), 4u);
  EXPECT_GE(mean.F_error[0], 0.75e-3);
  EXPECT_NEAR(mean.F_error[0], 0.75e-3, 1e-15);
}

TEST(AverageRows, ColumnsOfDifferentElementsAreMergedInOrder) {
  const FormFactorMatrix mean = average_rows(example(), std::vector<std::uint32_t>{0, 3}, std::vector<double>{1, 2, 1});
  EXPECT_THAT(mean.column, ElementsAre(0, 1, 3));
  EXPECT_THAT(mean.F, ElementsAre(0.03125, 0.1875, 0.0625));
}

TEST(AverageRows, PatchesWithoutAreaHaveEmptyRows) {
  const FormFactorMatrix mean =
      average_rows(example(), std::vector<std::uint32_t>{0, 0, 1, 3}, std::vector<double>{0, 1, 1});
  EXPECT_THAT(mean.row_first, ElementsAre(0, 0, 0, 2));
}

TEST(AverageRows, SizesThatDoNotFitAreRefused) {
  const std::vector<double> areas{1, 1, 1};
  EXPECT_THROW(average_rows(example(), std::vector<std::uint32_t>{0, 2}, areas), std::invalid_argument);
  EXPECT_THROW(average_rows(example(), std::vector<std::uint32_t>{0, 2, 1, 3}, areas), std::invalid_argument);
  EXPECT_THROW(average_rows(example(), std::vector<std::uint32_t>{0, 3}, std::vector<double>{1, 1}),
               std::invalid_argument);
}

TEST(Transpose, TwiceIsTheSame) {
  const FormFactorMatrix once = transpose(example());
  EXPECT_EQ(once.columns, 3u);
  EXPECT_THAT(once.row_first, ElementsAre(0, 1, 3, 3, 4));
  EXPECT_THAT(once.column, ElementsAre(2, 0, 2, 0));
  EXPECT_THAT(once.F, ElementsAre(0.125, 0.5, 0.25, 0.25));
  const FormFactorMatrix twice = transpose(once);
  EXPECT_EQ(twice.row_first, example().row_first);
  EXPECT_EQ(twice.column, example().column);
  EXPECT_EQ(twice.F, example().F);
  EXPECT_EQ(twice.F_error, example().F_error);
}

TEST(MatrixBytes, CountsWhatTheVectorsHold) {
  const FormFactorMatrix m = example();
  const std::uint64_t held = m.row_first.size() * sizeof(m.row_first[0]) + m.column.size() * sizeof(m.column[0]) +
                             m.F.size() * sizeof(m.F[0]) + m.F_error.size() * sizeof(m.F_error[0]);
  EXPECT_EQ(matrix_bytes(3, 4, 4.0 / 12), held);
  EXPECT_EQ(matrix_bytes(60000, 60000, 1), 60001u * 8 + 60000ull * 60000 * 20);
  EXPECT_EQ(matrix_bytes(1ull << 40, 1ull << 40, 1), std::numeric_limits<std::uint64_t>::max());
}

}  // namespace
}  // namespace exitance
