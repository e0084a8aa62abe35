#include "src/form_factor/form_factor_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "src/scene/scene.h"

namespace exitance {
namespace {

using testing::ElementsAre;

FormFactorMatrix dense(const std::vector<std::vector<double>>& rows, double error) {
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

TEST(FormFactorGroups, AreCountedInTheOrderOfTheirFirst) {
  const FormFactorGroups groups = make_groups(std::vector<std::uint32_t>{kNoGroup, 7, 2, kNoGroup, 7, 2, 2});
  EXPECT_EQ(groups.count, 4u);
  EXPECT_THAT(groups.group_of, ElementsAre(0, 1, 2, 3, 1, 2, 2));
  EXPECT_EQ(make_groups({}).count, 0u);
}

// A cube's faces, of which the left one was cut in halves: together they are the face again.
TEST(FormFactorGroups, HalvesOfAFaceAreTheFace) {
  constexpr double f = 0.2, half = f / 2;
  const FormFactorMatrix cut = dense({{0, f, half, half}, {f, 0, half, half}, {f, f, 0, 0}, {f, f, 0, 0}}, 1e-9);
  const FormFactorMatrix whole = combine(cut, std::vector<double>{1, 1, 0.5, 0.5},
                                         make_groups(std::vector<std::uint32_t>{kNoGroup, kNoGroup, 0, 0}));
  EXPECT_EQ(whole.columns, 3u);
  EXPECT_THAT(whole.row_first, ElementsAre(0, 2, 4, 6));
  EXPECT_THAT(whole.column, ElementsAre(1, 2, 0, 2, 0, 1));
  EXPECT_EQ(whole.F[0], f);
  EXPECT_EQ(whole.F_error[0], 1e-9);  // of one row and one column, as it was
  for (const double F : whole.F) EXPECT_DOUBLE_EQ(F, f);
  EXPECT_NEAR(whole.F_error[1], 2e-9, 1e-15);
  EXPECT_NEAR(whole.F_error[5], 1e-9, 1e-15);
  for (const double error : whole.F_error) EXPECT_GE(error, 1e-9);
}

TEST(FormFactorGroups, RowsWeighByTheirAreaAndMembersMaySeeEachOther) {
  const FormFactorMatrix matrix = dense({{0, 0.5, 0.25}, {0.125, 0, 0.5}, {0, 0, 0}}, 0);
  const FormFactorMatrix all =
      combine(matrix, std::vector<double>{1, 4, 8}, make_groups(std::vector<std::uint32_t>{3, 3, 5}));
  ASSERT_EQ(all.F.size(), 2u);
  EXPECT_THAT(all.column, ElementsAre(0, 1));
  EXPECT_DOUBLE_EQ(all.F[0], (1 * 0.5 + 4 * 0.125) / 5);
  EXPECT_DOUBLE_EQ(all.F[1], (1 * 0.25 + 4 * 0.5) / 5);
  EXPECT_EQ(all.row_first.back(), 2u);
}

TEST(FormFactorGroups, WithoutGroupsNothingChanges) {
  const FormFactorMatrix matrix = dense({{0, 0.3, 0.1}, {0.7, 0, 0.5}, {0.1, 1e-17, 0}}, 1e-13);
  const FormFactorMatrix same =
      combine(matrix, std::vector<double>{0.1, 0.3, 7}, make_groups(std::vector<std::uint32_t>(3, kNoGroup)));
  EXPECT_EQ(same.F, matrix.F);
  EXPECT_EQ(same.F_error, matrix.F_error);
  EXPECT_EQ(same.column, matrix.column);
  EXPECT_EQ(same.row_first, matrix.row_first);
}

TEST(FormFactorGroups, SizesThatDoNotFitAreRefused) {
  const FormFactorMatrix matrix = dense({{0, 1}, {1, 0}}, 0);
  const FormFactorGroups two = make_groups(std::vector<std::uint32_t>{0, 1});
  EXPECT_THROW(combine(matrix, std::vector<double>{1}, two), std::invalid_argument);
  EXPECT_THROW(combine(matrix, std::vector<double>{1, 1}, make_groups(std::vector<std::uint32_t>{0})),
               std::invalid_argument);
}

}  // namespace
}  // namespace exitance
