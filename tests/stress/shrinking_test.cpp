#include "src/stress/shrinking.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "src/stress/stage.h"

namespace exitance {
namespace {

TEST(Shrinking, LeavesOnlyWhatFails) {
  Random random("shrinking");
  Question question{Stage(random, 0).question, {}};
  question.point = {0.1, 0.2, 0.3};
  question.occluders = {sheet(rectangle(4, 0, 0, 1, 1)), box({1, 1, 5}, {2, 2, 6}),
                        sheet({{0, 0, 8}, {1.2345, 0, 8}, {2, 1, 8}, {1, 2, 8}, {0, 1, 8}})};
  std::size_t asked = 0;
  const auto fails = [&](const Question& q) {
    ++asked;
    for (const Obstacle& o : q.occluders) {
      for (const Polygon& face : o.faces) {
        for (const Vec3& v : face.outer) {
          if (v.x > 1.2 && v.x < 1.3) return true;
        }
      }
    }
    return false;
  };
  const Question small = shrink(question, fails);
  ASSERT_EQ(small.occluders.size(), 1u);
  EXPECT_EQ(small.occluders[0].faces[0].outer.size(), 3u);
  const auto& corners = small.occluders[0].faces[0].outer;
  EXPECT_EQ(std::ranges::count(corners, 1.25, &Vec3::x), 1) << "few bits";
  EXPECT_EQ(small.source.outer.size(), 3u);
  EXPECT_TRUE(fails(small));
  EXPECT_LE(asked, 2001u);
}

TEST(Shrinking, LeavesSolidsWhole) {
  Random random("solids");
  Question question{Stage(random, 0).question, {}};
  question.occluders = {box({1, 1, 5}, {2, 2, 6}), box({3, 3, 5}, {4, 4, 6})};
  const Question small = shrink(question, [](const Question& q) { return !q.occluders.empty(); });
  ASSERT_EQ(small.occluders.size(), 1u);
  EXPECT_EQ(small.occluders[0].faces.size(), 6u);
}

TEST(Shrinking, EndsAfterSoManyTries) {
  Random random("tries");
  Question question{Stage(random, 0).question, {}};
  question.occluders = {sheet(rectangle(4, 0, 0, 1, 1)), sheet(rectangle(5, 0, 0, 1, 1)),
                        sheet(rectangle(6, 0, 0, 1, 1))};
  std::size_t asked = 0;
  shrink(
      question, [&](const Question&) { return ++asked > 0; }, 2);
  EXPECT_EQ(asked, 2u);
}

}  // namespace
}  // namespace exitance
