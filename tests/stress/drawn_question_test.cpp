#include "src/stress/drawn_question.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "src/stress/visibility_oracle.h"

namespace exitance {
namespace {

template <class Visit>
void for_each_question(int of_each, const Visit& visit) {
  for (const QuestionFamily& family : question_families()) {
    for (const Departure& departure : departures()) {
      for (int k = 0; k < of_each; ++k) {
        const std::string name = family.name + "/" + departure.name + "/" + std::to_string(k);
        Random random(name);
        visit(name, family, departure, draw_question(family, departure, random));
      }
    }
  }
}

TEST(QuestionFamilies, DrawTheSameFromTheSameNumbers) {
  for_each_question(2, [](const std::string& name, const auto& family, const auto& departure, const auto& drawn) {
    Random random(name);
    const Question again = draw_question(family, departure, random).question;
    EXPECT_EQ(again.point, drawn.question.point) << name;
    EXPECT_EQ(again.source.outer, drawn.question.source.outer) << name;
    ASSERT_EQ(again.occluders.size(), drawn.question.occluders.size()) << name;
    for (std::size_t o = 0; o < again.occluders.size(); ++o)
      EXPECT_EQ(again.occluders[o].faces[0].outer, drawn.question.occluders[o].faces[0].outer) << name;
  });
}

TEST(QuestionFamilies, SolidsAreClosedWhereverTheyAreMoved) {
  int solids = 0;
  for_each_question(6, [&](const std::string& name, const auto&, const auto&, const DrawnQuestion& drawn) {
    for (const Obstacle& obstacle : scaled_near_one(drawn.question).question.occluders) {
      if (!obstacle.solid) continue;
      const std::vector<Role> roles(obstacle.faces.size(), Role::solid_face);
      EXPECT_EQ(PolygonSoup(obstacle.faces, roles).shells().size(), 1u) << name << " " << drawn.placement;
      ++solids;
    }
  });
  EXPECT_GT(solids, 300);
}

TEST(QuestionFamilies, EveryPlacementIsReached) {
  std::set<std::string> kinds;
  for_each_question(8, [&](const auto&, const auto&, const auto&, const DrawnQuestion& drawn) {
    kinds.insert(drawn.placement.substr(0, drawn.placement.find('_')));
  });
  EXPECT_EQ(kinds, (std::set<std::string>{"lattice", "tilted", "turned", "rotated", "denormal"}));
}

TEST(QuestionFamilies, SomeTilesHideTheSourceExactly) {
  const auto families = question_families();
  const auto cover = std::ranges::find(families, "cover", &QuestionFamily::name);
  int hidden = 0, slits = 0;
  for (int k = 0; k < 60; ++k) {
    Random random("tiles " + std::to_string(k));
    const OracleAnswer truth =
        oracle_form_factor(draw_question(*cover, departures()[k % 2 == 0 ? 0 : 1], random).question);
    hidden += truth.visible_area == 0;
    slits += truth.F > 0 && truth.F < 1e-9L;
  }
  EXPECT_GT(hidden, 5);
  EXPECT_GT(slits, 5) << "where rounding parts what touches";
}

}  // namespace
}  // namespace exitance
