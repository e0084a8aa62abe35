// Questions of shafts, shadows and pairs: nothing is wrong of the library's answers, and what is wrong is found.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "geometry/shadow_volume.h"
#include "src/stress/pair_oracle.h"
#include "src/stress/pair_question.h"
#include "src/stress/shadow_question.h"
#include "src/stress/shaft_question.h"
#include "src/stress/stage.h"
#include "src/stress/stress_run.h"
#include "src/stress/visibility_oracle.h"

namespace exitance {
namespace {

/// Unit squares opposite at a distance of 1, and what stands between.
Question squares(std::vector<Obstacle> occluders) {
  Question question;
  question.normal = {0, 0, 1};
  question.receiver = {rectangle(0, 0, 0, 1, 1), {}};
  question.source = {reversed(rectangle(1, 0, 0, 1, 1)), {}};
  question.occluders = std::move(occluders);
  return question;
}

StressOptions asking(const std::string& kind, const std::string& contender, std::uint64_t count) {
  StressOptions options;
  options.kind = &question_kind_named(kind);
  options.count = count;
  options.contenders = {options.kind->contender_named(contender)};
  return options;
}

void expect_nothing_wrong(const StressReport& report, const std::string& contender) {
  const StressTally total = report.total(contender);
  EXPECT_EQ(total.wrong, 0u);
  EXPECT_EQ(total.broken(), 0u);
  EXPECT_GT(total.all, 0u);
  EXPECT_GT(total.some, 0u);
  for (const StressFailure& failure : report.failures) ADD_FAILURE() << failure.what << " of " << failure.question;
}

TEST(AreaQuestions, NothingIsWrongOfShafts) {
  const StressReport report = run_stress(asking("shafts", "exact", 87));
  expect_nothing_wrong(report, "exact");
  EXPECT_GT(report.total("exact").none, 0u);
  EXPECT_EQ(report.total("exact").unjudged, 0u);
  for (const PropertyTally& property : report.total("exact").properties) EXPECT_GT(property.tried, 0u);
}

TEST(AreaQuestions, NothingIsWrongOfShadows) {
  const StressReport report = run_stress(asking("shadows", "exact", 29));
  expect_nothing_wrong(report, "exact");
  EXPECT_EQ(report.total("exact").unjudged, 0u);
}

TEST(AreaQuestions, NothingIsWrongOfPairs) {
  StressOptions options = asking("pairs", "one-way", 6);
  options.families = {"gap"};
  options.properties = false;
  const StressTally total = run_stress(options).total("one-way");
  EXPECT_EQ(total.questions, 6u);
  EXPECT_EQ(total.wrong + total.unjudged, 0u);
  EXPECT_LT(total.worst_margin, 1e-3);
}

/// Solids behind a source, whose tops share its plane but for rounding.
TEST(AreaQuestions, WhatRisesInFrontOfASourceByRoundingIsCutOffOnce) {
  const QuestionFamily& family = *std::ranges::find(question_families(), "coplanar_contact", &QuestionFamily::name);
  const std::string name = "6/coplanar_contact/ulp/2";
  Random random(name), of_receiver(name + "/receiver");
  const Question question = near_one(draw_area_question(family, departures()[1], random, of_receiver).question);
  const Loop& receiver = question.receiver.outer;
  const Vec3 u = receiver[1] - receiver[0], v = receiver[3] - receiver[0];
  PointQuestion at = question;
  at.normal = cross(u, v);
  long double mean = 0;
  constexpr int kSide = 8;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      at.point = receiver[0] + (i + 0.5) / kSide * u + (j + 0.5) / kSide * v;
      mean += oracle_form_factor(at).F / (kSide * kSide);
    }
  }
  const PairOracleAnswer pair = oracle_pair_form_factors(question, Care::sampled);
  EXPECT_LE(pair.error, 6e-4L);
  EXPECT_LE(std::fabs(pair.F - mean), pair.error + 2e-4L) << "which the points may be off";
}

/// Says of each class that it is another.
Contender confused(const std::string& kind, ShaftClass from, ShaftClass to) {
  const Contender exact = question_kind_named(kind).contender_named("exact");
  return {"confused",
          [=](const Question& q, std::uint64_t seed) {
            Opinion opinion = exact.ask(q, seed);
            std::ranges::replace(opinion.classes, static_cast<std::uint8_t>(from), static_cast<std::uint8_t>(to));
            return opinion;
          },
          true, false};
}

TEST(AreaQuestions, FalseClassesOfShaftsAreFound) {
  for (const auto& [from, to] : {std::pair{ShaftClass::outside, ShaftClass::partial},
                                 {ShaftClass::partial, ShaftClass::outside},
                                 {ShaftClass::partial, ShaftClass::blocking}}) {
    StressOptions options = asking("shafts", "exact", 29);
    options.contenders = {confused("shafts", from, to)};
    options.failures_kept = 1;
    const StressReport report = run_stress(options);
    EXPECT_GT(report.total("confused").wrong, 5u) << static_cast<int>(from);
    ASSERT_EQ(report.failures.size(), 1u);
    const Question& question = report.failures[0].asked.at(0);
    EXPECT_TRUE(shaft_truth(question).judge(options.contenders[0].ask(question, 0)).is_wrong) << "replays";
  }
}

// Of shafts: of each its own class and, where its ends face each other, one of each thing.
TEST(AreaQuestions, ClassesThatWereJudgedAreCounted) {
  std::atomic<std::uint64_t> said = 0;
  StressOptions options = asking("shafts", "exact", 29);
  options.properties = false;
  const auto exact = options.contenders[0].ask;
  options.contenders[0].ask = [&](const Question& q, std::uint64_t seed) {
    Opinion opinion = exact(q, seed);
    said += opinion.classes.size();
    return opinion;
  };
  const StressTally total = run_stress(options).total("exact");
  EXPECT_EQ(total.classes, said);
  EXPECT_GT(total.classes, 2 * total.questions);
  options.oracle = false;
  EXPECT_EQ(run_stress(options).total("exact").classes, 0u);

  const Question free = squares({}), behind = [] {
    Question q = squares({sheet(rectangle(2, 0, 0, 1, 1)), sheet(rectangle(0.5, 0, 0, 1, 1))});
    std::ranges::reverse(q.source.outer);  // looks away
    return q;
  }();
  EXPECT_EQ(ask_shafts(free).classes, (std::vector<std::uint8_t>{0, 0, 0})) << "open; neither end enters";
  EXPECT_EQ(ask_shafts(behind).classes, (std::vector<std::uint8_t>{static_cast<std::uint8_t>(ShaftClass::away)}));
}

TEST(AreaQuestions, MissedAndFalseShadowsAreFound) {
  for (const Shade said : {Shade::outside, Shade::umbra}) {
    StressOptions options = asking("shadows", "exact", 6);
    options.families = {"cover"};
    options.contenders = {confused("shadows", static_cast<ShaftClass>(Shade::penumbra), static_cast<ShaftClass>(said))};
    options.failures_kept = 0;
    EXPECT_GT(run_stress(options).total("confused").wrong, 0u) << static_cast<int>(said);
  }
}

/// Shafts and shadows: each property holds of right answers, and not where a form of the question is answered
/// otherwise.
TEST(AreaQuestions, EveryPropertyFindsAWrongAnswer) {
  const Question question = squares({sheet(rectangle(0.5, 0.25, 0.25, 0.5, 0.75)),
                                     sheet({{0.5, 0, 0.25}, {1, 0, 0.25}, {1, 0.5, 0.375}, {0.5, 0.25, 0.25}}),
                                     box({0.5, 0.5, 0.5}, {0.75, 0.75, 0.75})});
  for (const char* kind : {"shafts", "shadows"}) {
    const Contender exact = question_kind_named(kind).contender_named("exact");
    const auto right = [&](const Question& q) { return exact.ask(q, 0); };
    const auto wrong = [&](const Question& q) {
      Opinion opinion = right(q);
      opinion.visibility = opinion.visibility == Visibility::open ? Visibility::partial : Visibility::open;
      opinion.classes.push_back(0);
      return opinion;
    };
    for (const Property& property : question_kind_named(kind).properties()) {
      int applied = 0, broken = 0;
      for (int k = 0; k < 12; ++k) {
        const std::string name = property.name + std::to_string(k);
        Random random(name), again(name);
        const auto trial = try_property(property, question, right(question), right, random);
        if (!trial) continue;
        ++applied;
        EXPECT_TRUE(trial->holds()) << kind << ": " << property.name;
        broken += !try_property(property, question, right(question), wrong, again)->holds();
      }
      EXPECT_GT(applied, 0) << kind << ": " << property.name;
      EXPECT_EQ(broken, applied) << kind << ": " << property.name;
    }
  }
}

TEST(AreaQuestions, AnExceptionOfTheOracleIsCounted) {
  QuestionKind kind = question_kind_named("shafts");
  kind.truth = [](const Question& q) -> Truth {
    if (q.occluders.size() > 1) throw std::runtime_error("too much stands between");
    return shaft_truth(q);
  };
  StressOptions options = asking("shafts", "exact", 29);
  options.kind = &kind;
  options.properties = false;
  const StressReport report = run_stress(options);
  EXPECT_EQ(report.questions, 29u);
  const StressTally total = report.total("exact");
  EXPECT_GT(total.unjudged, 0u);
  EXPECT_EQ(total.unjudged + total.none + total.some + total.all, 29u);
  EXPECT_EQ(total.wrong, 0u);
  ASSERT_EQ(report.unjudged.size(), total.unjudged);
  EXPECT_EQ(report.unjudged[0].exception, "too much stands between");
}

TEST(AreaQuestions, HaveTheScenesOfPointsAndAReceiver) {
  for (const QuestionFamily& family : question_families()) {
    Random random(family.name), again(family.name), of_receiver("receiver");
    const Question point = draw_question(family, departures()[0], random).question;
    const Question area = draw_area_question(family, departures()[0], again, of_receiver).question;
    EXPECT_TRUE(point.receiver.outer.empty());
    EXPECT_GE(area.receiver.outer.size(), 3u);
    EXPECT_EQ(area.source.outer, point.source.outer) << family.name;
    EXPECT_EQ(area.occluders.size(), point.occluders.size()) << family.name;
  }
}

// --- The oracle of pairs -------------------------------------------------------------------------------------------

/// Everything turned, and rounded.
Question turned(Question question) {
  Random random("turned");
  const Placement place = random_rotation("turned", {5, -3, 7}, 1, random);
  question.receiver = place(question.receiver);
  question.source = place(question.source);
  for (Obstacle& obstacle : question.occluders) {
    for (Polygon& face : obstacle.faces) face = place(face);
  }
  return question;
}

void expect_form_factor(const Question& question, long double F, Care care, const char* what) {
  const PairOracleAnswer answer = oracle_pair_form_factors(question, care);
  EXPECT_LE(std::fabs(answer.F - F), answer.error + 1e-14L) << what;
  EXPECT_LT(answer.error, care == Care::full ? 1e-7L : 3e-3L) << what;
}

constexpr long double kSquares = 0.199824895698387351L;  // opposite unit squares

/// Shapiro's test: a half-size plate at 3/4 of the distance.
Question plate() {
  return squares({sheet(rectangle(0.75, 0.25, 0.25, 0.75, 0.75))});
}

TEST(AreaQuestions, ErrorsOfPairsAreFound) {
  const Question question = plate();
  const auto right = [](const Question& q) { return ask_pair(q, true); };
  const auto careless = [&](const Question& q) {  // not of F back: it breaks the swap, too
    Opinion opinion = right(q);
    opinion.F *= 1.01;
    return opinion;
  };
  const Truth truth = pair_truth(question);
  EXPECT_FALSE(truth.judge(right(question)).is_wrong);
  EXPECT_TRUE(truth.judge(careless(question)).is_wrong);
  // By less than what samples may miss.
  const PairOracleAnswer sampled = oracle_pair_form_factors(question, Care::sampled);
  Opinion slightly = right(question);
  slightly.margin = slightly.reverse_margin = 1e-9;
  EXPECT_FALSE(truth.judge(slightly).is_wrong);
  slightly.F += 2e-4;
  EXPECT_LT(2e-4L, sampled.error);
  EXPECT_TRUE(truth.judge(slightly).is_wrong);
  const Property& swap = pair_properties().back();
  ASSERT_EQ(swap.name, "swapped");
  Random random("swap");
  EXPECT_TRUE(try_property(swap, question, right(question), right, random)->holds());
  EXPECT_FALSE(try_property(swap, question, careless(question), careless, random)->holds());
}

TEST(PairOracle, KnowsPublishedValues) {
  for (const Care care : {Care::sampled, Care::full}) {
    expect_form_factor(squares({}), kSquares, care, "nothing between");
    expect_form_factor(plate(), 0.115620602132415L, care, "a plate");
    expect_form_factor(turned(plate()), 0.115620602132415L, care, "a plate, turned");
    expect_form_factor(squares({sheet(rectangle(0.5, -1, -1, 2, 2))}), 0, care, "all hidden");
  }
}

/// Half of the receiver is left, which by symmetry is half of the form factor.
TEST(PairOracle, SettlesContacts) {
  const Question on_it = squares({box({0.5, 0, 0}, {1, 1, 0x1p-40})});
  const Care care = Care::sampled;
  expect_form_factor(squares({sheet(rectangle(0, 0.5, 0, 1, 1))}), kSquares / 2, Care::full, "a rug");
  expect_form_factor(squares({sheet(rectangle(0, 0.5, 0, 1, 0.5)), sheet(rectangle(0, 0.5, 0.5, 1, 1))}), kSquares / 2,
                     care, "two rugs");
  expect_form_factor(on_it, kSquares / 2, care, "a thin box on the receiver");
  expect_form_factor(turned(on_it), kSquares / 2, care, "a thin box on the receiver, turned");
  expect_form_factor(squares({box({0.5, 0, -1}, {1, 1, 0})}), kSquares, care, "a box behind the receiver");
}

TEST(PairOracle, SaysWhatItCannotTell) {
  Question question = squares({});
  for (Vec3& v : question.source.outer) v.z = 0x1p-50;
  EXPECT_THROW(oracle_pair_form_factors(question, Care::sampled), OutOfReach);
}

}  // namespace
}  // namespace exitance
