#include "src/links/quad_code.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace exitance {
namespace {

using End = LinkCode::End;

TEST(QuadCode, TellsThePathOfBothEnds) {
  LinkCode code;
  std::mt19937_64 random(1);
  std::vector<std::pair<End, unsigned>> path;
  for (unsigned k = 0; k < LinkCode::kMostSteps; ++k) {
    path.emplace_back(random() % 2 ? End::source : End::receiver, static_cast<unsigned>(random() % 4));
    code = code.descend(path.back().first, path.back().second);
    ASSERT_EQ(code.steps(), k + 1);
    for (unsigned i = 0; i <= k; ++i) {
      EXPECT_EQ(code.end(i), path[i].first);
      EXPECT_EQ(code.child(i), path[i].second);
    }
  }
}

// The order of codes against a depth-first walk through a tree that is divided at random.
TEST(QuadCode, OrdersDepthFirst) {
  std::mt19937_64 random(2);
  std::vector<LinkCode> walked;
  const auto walk = [&](auto& self, LinkCode code) -> void {
    walked.push_back(code);
    if (code.steps() == LinkCode::kMostSteps || random() % 10 < 7) return;
    const End end = random() % 2 ? End::source : End::receiver;
    for (unsigned k = 0; k < 4; ++k) self(self, code.descend(end, k));
  };
  while (walked.size() < 2000) {
    walked.clear();
    walk(walk, LinkCode());
  }
  EXPECT_TRUE(std::ranges::is_sorted(walked));
  EXPECT_EQ(std::ranges::adjacent_find(walked), walked.end());
  for (std::size_t i = 0; i < walked.size(); i += 7) {
    std::size_t last = i + 1;
    while (last < walked.size() && walked[last].steps() > walked[i].steps()) ++last;
    for (std::size_t j = 0; j < walked.size(); ++j)
      ASSERT_EQ(walked[i].holds(walked[j]), i <= j && j < last) << i << ", " << j;
  }
}

}  // namespace
}  // namespace exitance
