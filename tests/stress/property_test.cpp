// Every property finds a contender that breaks it.

#include "src/stress/property.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/stress/point_contender.h"
#include "src/stress/stage.h"

namespace exitance {
namespace {

/// A ceiling behind a sheet, a bent sheet, and a box.
Question room() {
  Random random("room");
  Question question{Stage(random, 0).question, {}};
  question.occluders = {sheet(rectangle(8, -2, -1, 1, 2)), sheet({{1, 1, 6}, {3, 1, 6}, {3, 4, 7}, {1, 3, 6}}),
                        box({-4, -4, 4}, {-2, -3, 7})};
  return question;
}

Opinion right(const Question& question) {
  return point_contender_named("exact").ask(question, 0);
}

std::size_t vertices(const Question& question) {
  std::size_t count = 0;
  for (const Obstacle& o : question.occluders) {
    for (const Polygon& face : o.faces) count += face.outer.size();
  }
  return count;
}

/// What a wrong contender depends on though it must not.
double wrong_by(const std::string& property, const Question& q) {
  const auto& occluders = q.occluders;
  const auto& first = occluders[0].faces[0].outer;
  if (property == "permuted") return first[0].x + first[0].z;
  if (property == "split" || property == "duplicated" || property == "triangulated") return double(vertices(q));
  if (property == "reversed") return area_vector(first).z;
  if (property == "as_sheets") return double(std::ranges::count(occluders, true, &Obstacle::solid));
  if (property == "scaled") return std::log2(norm(q.source.outer[1] - q.source.outer[0]));
  if (property == "translated") return q.point.x + q.point.y + q.point.z;
  if (property == "renumbered") return q.source.outer[0].x + 3 * q.source.outer[0].y;
  if (property == "added") return double(occluders.size());
  if (property == "pieces") return 1;
  return 0;
}

class EveryProperty : public testing::TestWithParam<std::size_t> {};

TEST_P(EveryProperty, HoldsForTheExactContenderAndFindsAWrongOne) {
  const Property& property = point_properties()[GetParam()];
  const Question question = room();
  int applied = 0, broken = 0;
  for (int k = 0; k < 12; ++k) {
    const std::string name = property.name + std::to_string(k);
    Random random(name), again(name);
    const auto trial = try_property(property, question, right(question), right, random);
    if (!trial) continue;
    ++applied;
    EXPECT_TRUE(trial->holds()) << property.name << ": " << trial->defect << " > " << trial->allowed;
    const auto wrong = [&](const Question& q) {
      Opinion opinion = right(q);
      opinion.F += 1e-9 * wrong_by(property.name, q);
      return opinion;
    };
    broken += !try_property(property, question, wrong(question), wrong, again)->holds();
  }
  EXPECT_GT(applied, 0);
  EXPECT_GT(broken, 0) << property.name;
}

TEST_P(EveryProperty, DoesNotHoldBetweenAnswersThatAreNoNumbers) {
  const Property& property = point_properties()[GetParam()];
  const Question question = room();
  const auto no_number = [](const Question& q) {
    Opinion opinion = right(q);
    opinion.F = std::numeric_limits<double>::quiet_NaN();
    return opinion;
  };
  const auto no_margin = [](const Question& q) {
    Opinion opinion = right(q);
    opinion.margin = std::numeric_limits<double>::quiet_NaN();
    return opinion;
  };
  int applied = 0;
  for (int k = 0; k < 12; ++k) {
    for (const Ask& ask : {Ask(no_number), Ask(no_margin)}) {
      Random random(property.name + std::to_string(k));
      const auto trial = try_property(property, question, right(question), ask, random);
      if (!trial) continue;
      ++applied;
      EXPECT_FALSE(trial->holds());
      EXPECT_FALSE(std::isnan(trial->defect)) << "the worst of some would not show it";
    }
  }
  EXPECT_GT(applied, 0);
}

INSTANTIATE_TEST_SUITE_P(Properties, EveryProperty, testing::Range(std::size_t{0}, point_properties().size()),
                         [](const auto& one) { return point_properties()[one.param].name; });

TEST(Closure, HoldsInARoomOfPatches) {
  const PropertyTrial trial = try_closure(room());
  EXPECT_TRUE(trial.holds()) << trial.defect;
  EXPECT_LT(trial.allowed, 1e-12);
}

TEST(PointContenders, AreKnownByName) {
  EXPECT_EQ(point_contender_named("rays:64").name, "rays:64");
  for (const char* wrong :
       {"", "rays", "rays:", "rays:0", "rays:-1", "rays:6x", "rays:64:slow", "rays:99999999", "Exact"})
    EXPECT_THROW(point_contender_named(wrong), std::invalid_argument) << wrong;
}

TEST(PointContenders, AgreeOnARoom) {
  const Question question = room();
  const double F = right(question).F;
  for (const char* name : {"plain-double", "cgal-epeck", "rays:1024", "rays:1024:fast"}) {
    const Opinion opinion = point_contender_named(name).ask(question, 1);
    EXPECT_NEAR(opinion.F, F, opinion.margin + 1e-15) << name;
    EXPECT_LT(opinion.margin, 0.03) << name;
  }
}

}  // namespace
}  // namespace exitance
