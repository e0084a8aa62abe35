#include "src/stress/stress_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "src/stress/point_contender.h"
#include "src/stress/verdict.h"

namespace exitance {
namespace {

StressOptions asking(std::vector<std::string> names, std::uint64_t count) {
  StressOptions options;
  options.count = count;
  for (const std::string& name : names) options.contenders.push_back(point_contender_named(name));
  return options;
}

TEST(StressRun, FindsNothingWrongOfTheExactContender) {
  const StressReport report = run_stress(asking({"exact"}, 174));
  const StressTally total = report.total("exact");
  EXPECT_EQ(total.questions, 174u);
  EXPECT_EQ(total.none + total.some + total.all, 174u);
  EXPECT_GT(total.none, 0u);
  EXPECT_GT(total.all, 0u);
  EXPECT_EQ(total.wrong, 0u);
  EXPECT_EQ(total.broken(), 0u);
  EXPECT_LE(total.worst_error, 1e-13);
  EXPECT_LE(total.worst_relative_error, 1e-10);
  EXPECT_LE(total.worst_margin, 2e-13) << "an error within a margin that is wide enough proves nothing";
  EXPECT_GT(total.worst_margin, 0.0);
  EXPECT_TRUE(report.failures.empty());
  EXPECT_EQ(report.found, 0u);
  for (const PropertyTally& property : total.properties) EXPECT_GT(property.tried, 0u);
  EXPECT_GT(total.stages.exact, 0u);
}

TEST(Judge, WhatIsNoNumberIsWrong) {
  constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
  const OracleAnswer truth{0.25L, 1, 0.5L, false};
  Opinion right, unsaid, unproven;
  right.F = unproven.F = 0.25;
  unsaid.F = unproven.margin = kNoNumber;
  unsaid.margin = 1;
  EXPECT_FALSE(judge(right, truth).is_wrong);
  EXPECT_TRUE(judge(unsaid, truth).is_wrong);
  EXPECT_TRUE(std::isinf(judge(unsaid, truth).error)) << "the worst of some would not show a NaN";
  EXPECT_TRUE(std::isinf(judge(unsaid, truth).relative_error));
  EXPECT_TRUE(judge(unproven, truth).is_wrong);
}

/// Answers, and takes all that is seen for hidden where that is next to nothing; its bound claims the contrary.
Contender careless() {
  const auto exact = point_contender_named("exact");
  return {"careless",
          [exact](const Question& q, std::uint64_t seed) {
            Opinion opinion = exact.ask(q, seed);
            if (opinion.F < 1e-7) opinion = {0, opinion.margin, Visibility::blocked, {}, 0};
            return opinion;
          },
          true, false};
}

TEST(StressRun, FindsACarelessContender) {
  StressOptions options = asking({}, 180);
  options.families = {"gap"};
  options.contenders = {careless()};
  options.failures_kept = 3;
  const StressReport report = run_stress(options);
  EXPECT_GT(report.total("careless").wrong, 5u);
  ASSERT_EQ(report.failures.size(), 3u);
  EXPECT_EQ(report.found, report.total("careless").wrong) << "kept or not";
  for (const StressFailure& failure : report.failures) {
    EXPECT_EQ(failure.what, "answer");
    EXPECT_EQ(failure.F, 0);
    const Question& question = failure.asked.at(0);
    EXPECT_TRUE(judge(careless().ask(question, 0), oracle_form_factor(question)).is_wrong) << "replays";
    EXPECT_LE(question.occluders.size(), 4u);
  }
}

TEST(StressRun, SmallFailuresOfPlainDoublesReplay) {
  StressOptions options = asking({"plain-double"}, 60);
  options.families = {"coplanar_contact", "duplicate"};
  const StressReport report = run_stress(options);
  ASSERT_FALSE(report.failures.empty());
  for (const StressFailure& failure : report.failures) {
    if (failure.what != "answer") continue;
    const Question& question = failure.asked.at(0);
    const Opinion plain = point_contender_named("plain-double").ask(question, 0);
    EXPECT_TRUE(judge(plain, oracle_form_factor(question)).is_wrong) << failure.question;
  }
}

TEST(StressRun, IsTheSameForAnyNumberOfThreads) {
  const auto by = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return run_stress(asking({"exact", "plain-double", "rays:16"}, 58));
  };
  const StressReport one = by(1), three = by(3);
  ASSERT_EQ(one.rows.size(), three.rows.size());
  for (std::size_t r = 0; r < one.rows.size(); ++r) {
    const StressTally &a = one.rows[r].tally, &b = three.rows[r].tally;
    EXPECT_EQ(a.wrong, b.wrong);
    EXPECT_EQ(a.worst_error, b.worst_error);
    EXPECT_EQ(a.stages.exact, b.stages.exact);
    EXPECT_EQ(a.broken(), b.broken());
    for (std::size_t p = 0; p < a.properties.size(); ++p)
      EXPECT_EQ(a.properties[p].worst_defect, b.properties[p].worst_defect);
  }
  ASSERT_EQ(one.failures.size(), three.failures.size());
  for (std::size_t k = 0; k < one.failures.size(); ++k) {
    EXPECT_EQ(one.failures[k].question, three.failures[k].question);
    EXPECT_EQ(one.failures[k].F, three.failures[k].F);
  }
}

TEST(StressRun, GoesOnWhereAnotherEnded) {
  StressOptions options = asking({"exact"}, 24);
  options.oracle = false;
  options.families = {"horizon", "near"};
  const StressTally whole = run_stress(options).total("exact");
  options.count = 12;
  StressTally parts = run_stress(options).total("exact");
  options.first = 12;
  parts.add(run_stress(options).total("exact"));
  EXPECT_EQ(whole.stages.filter, parts.stages.filter);
  EXPECT_EQ(whole.tried(), parts.tried());
}

/// Throws where more than one thing stands between, or, if `late`, only when it is asked again.
Contender throwing(bool late) {
  const auto exact = point_contender_named("exact");
  const auto asked = std::make_shared<std::atomic<int>>(0);
  return {"throwing",
          [exact, asked, late](const Question& q, std::uint64_t seed) {
            if (late ? (*asked)++ > 0 : q.occluders.size() > 1) throw std::runtime_error("too much stands between");
            return exact.ask(q, seed);
          },
          true, true};
}

TEST(StressRun, AnExceptionIsAFailureOfItsContender) {
  StressOptions options = asking({"exact"}, 29);
  options.contenders.push_back(throwing(false));
  options.properties = false;
  const StressReport report = run_stress(options);
  EXPECT_EQ(report.questions, 29u);
  EXPECT_EQ(report.total("exact").wrong, 0u);
  const StressTally total = report.total("throwing");
  EXPECT_GT(total.wrong, 0u);
  EXPECT_LT(total.wrong, 29u) << "the others are answered";
  ASSERT_EQ(report.failures.size(), total.wrong);
  for (const StressFailure& failure : report.failures) {
    EXPECT_EQ(failure.exception, "too much stands between");
    EXPECT_TRUE(std::isnan(failure.F));
    EXPECT_TRUE(failure.truth.has_value());
    EXPECT_EQ(failure.asked.at(0).occluders.size(), 2u) << "made small";
  }
}

TEST(StressRun, AnExceptionBreaksAProperty) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  StressOptions options = asking({}, 1);
  options.contenders = {throwing(true)};
  options.families = {"duplicate"};
  options.failures_kept = 0;
  const StressTally total = run_stress(options).total("throwing");
  EXPECT_EQ(total.wrong, 0u);
  EXPECT_GT(total.broken(), 5u) << "of all properties but closure";
}

TEST(StressRun, StopsMakingFailuresSmall) {
  StressOptions options = asking({}, 60);
  options.families = {"gap"};
  options.contenders = {careless()};
  options.failures_kept = 3;
  const StressReport whole = run_stress(options);
  ASSERT_FALSE(whole.failures.empty());
  std::atomic<bool> stopped = false;
  options.progress = [&](double done, std::string_view) { stopped = done == 1; };
  options.stop = [&] { return stopped.load(); };
  const StressReport report = run_stress(options);
  EXPECT_FALSE(report.complete);
  EXPECT_EQ(report.questions, 60u);
  ASSERT_EQ(report.failures.size(), whole.failures.size());
  std::size_t larger = 0;
  for (std::size_t k = 0; k < whole.failures.size(); ++k) {
    EXPECT_EQ(report.failures[k].question, whole.failures[k].question);
    larger += report.failures[k].asked[0].occluders.size() > whole.failures[k].asked[0].occluders.size();
  }
  EXPECT_GT(larger, 0u);
}

TEST(StressRun, RefusesAFamilyThatThereIsNot) {
  StressOptions options = asking({"exact"}, 1);
  options.families = {"gap", "gaps"};
  try {
    run_stress(options);
    ADD_FAILURE();
  } catch (const std::invalid_argument& refused) {
    EXPECT_THAT(refused.what(), testing::StartsWith("gaps: there is no such family"));
    for (const QuestionFamily& family : question_families())
      EXPECT_THAT(refused.what(), testing::HasSubstr(family.name));
  }
}

TEST(StressRun, GoesOnWhereItWasEnded) {
  StressOptions options = asking({"plain-double"}, 1100);
  options.families = {"duplicate"};
  options.oracle = false;
  const StressReport whole = run_stress(options);
  ASSERT_FALSE(whole.failures.empty());

  std::optional<StressState> kept;
  options.save = [&](const StressState& state) { kept = state; };
  options.save_every = 0;
  options.stop = [&] { return kept.has_value(); };
  const StressReport ended = run_stress(options);
  EXPECT_FALSE(ended.complete);
  ASSERT_GT(ended.questions, 0u);
  ASSERT_LT(ended.questions, 1100u);

  options.stop = {};
  options.resumed = kept;
  const StressReport resumed = run_stress(options);
  EXPECT_TRUE(resumed.complete);
  EXPECT_EQ(resumed.resumed, ended.questions);
  EXPECT_EQ(resumed.questions, 1100u);
  ASSERT_EQ(resumed.rows.size(), whole.rows.size());
  for (std::size_t k = 0; k < whole.rows.size(); ++k) {
    EXPECT_EQ(resumed.rows[k].tally.questions, whole.rows[k].tally.questions);
    EXPECT_EQ(resumed.rows[k].tally.broken(), whole.rows[k].tally.broken());
    EXPECT_EQ(resumed.rows[k].tally.stages.filter, whole.rows[k].tally.stages.filter);
  }
  ASSERT_EQ(resumed.failures.size(), whole.failures.size());
  for (std::size_t k = 0; k < whole.failures.size(); ++k)
    EXPECT_EQ(resumed.failures[k].question, whole.failures[k].question);

  options.count = ended.questions - 1;
  EXPECT_THROW(run_stress(options), std::invalid_argument) << "more was asked than is wanted";
  options.count = 1100;
  options.families = {"duplicate", "gap"};
  EXPECT_THROW(run_stress(options), std::invalid_argument) << "of another run";
}

}  // namespace
}  // namespace exitance
