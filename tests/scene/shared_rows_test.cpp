#include "src/scene/shared_rows.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace exitance {
namespace {

TEST(SharedRows, ACopyChangesAlone) {
  SharedRows<int> rows;
  for (int k = 0; k < 1000; ++k) rows.push_back(k);
  SharedRows<int> copy = rows;
  copy[500] = -1;
  copy.resize(1500);
  copy[1400] = 7;
  const SharedRows<int>&a = rows, &b = copy;
  ASSERT_EQ(a.size(), 1000u);
  ASSERT_EQ(b.size(), 1500u);
  for (std::size_t k = 0; k < 1500; ++k) {
    if (k < 1000) {
      EXPECT_EQ(a[k], static_cast<int>(k));
    }
    EXPECT_EQ(b[k], k == 500 ? -1 : k == 1400 ? 7 : k < 1000 ? static_cast<int>(k) : 0);
  }
  EXPECT_EQ(&a[0], &b[0]) << "pages that are the same are shared";
  EXPECT_NE(&a[500], &b[500]);
}

TEST(SharedRows, AreWalkedThrough) {
  SharedRows<int> rows;
  rows.resize(300);
  for (int& row : rows) row = 2;
  const SharedRows<int> same = rows;
  EXPECT_EQ(std::accumulate(same.begin(), same.end(), 0), 600);
  EXPECT_EQ(same.back(), 2);
}

TEST(SharedList, CopiesGrowApart) {
  SharedList<int> list;
  for (int k = 0; k < 10; ++k) list.push_back(k);
  const std::vector<int> more{10, 11, 12};
  list.append(more.begin(), more.end());
  SharedList<int> one = list, other = list;
  one.push_back(100);
  other.push_back(200);
  other.set(0, -1);
  EXPECT_EQ(list.size(), 13u);
  EXPECT_EQ(one.back(), 100);
  EXPECT_EQ(other.back(), 200);
  EXPECT_EQ(list[0], 0);
  EXPECT_EQ(one[0], 0);
  EXPECT_EQ(other[0], -1);
  EXPECT_EQ(list.back(), 12);
}

/// An item of the list itself may be the one that makes it move.
TEST(SharedList, TakesItsOwnItems) {
  SharedList<std::vector<int>> list;
  list.push_back({1, 2, 3});
  for (int k = 0; k < 100; ++k) list.push_back(list[0]);
  EXPECT_EQ(list.back(), (std::vector<int>{1, 2, 3}));
}

}  // namespace
}  // namespace exitance
