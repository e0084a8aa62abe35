// Questions that were once answered wrong, by us or by plain doubles, each with the oracle's answer as `truth`. Of
// points also the sum over a closed room around each; of pairs (pairs_*.json) the truth has a `truth_error`.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "src/cli/case_reader.h"
#include "src/stress/property.h"
#include "tests/cli/program.h"
#include "tests/places.h"

namespace exitance {
namespace {

std::vector<std::filesystem::path> corpus(bool of_pairs) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(source_file("tests/corpus"))) {
    if (entry.path().extension() == ".json" && entry.path().stem().string().starts_with("pairs_") == of_pairs)
      files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

std::string name_of(const testing::TestParamInfo<std::filesystem::path>& one) {
  return one.param.stem().string();
}

nlohmann::json answers_to(const std::filesystem::path& file, const std::string& tolerance) {
  const Outcome outcome = run("cases " + file.string() + " --tolerance " + tolerance);
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  return nlohmann::json::parse(outcome.out).at("results");
}

class PairCorpus : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(PairCorpus, IsAnsweredRight) {
  const auto cases = json_in(GetParam()).at("cases");
  for (const double tolerance : {1e-6, 1e-9, 1e-11}) {
    const auto results = answers_to(GetParam(), std::to_string(tolerance * 1e12) + "e-12");
    ASSERT_EQ(results.size(), cases.size());
    for (std::size_t k = 0; k < cases.size(); ++k) {
      const double truth = cases[k].at("truth"), truth_error = cases[k].at("truth_error"), F = results[k].at("F"),
                   error = results[k].at("F_error");
      EXPECT_LE(std::fabs(F - truth), error + truth_error) << cases[k].at("id") << ", tolerance " << tolerance;
      EXPECT_LE(error, tolerance) << cases[k].at("id");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, PairCorpus, testing::ValuesIn(corpus(true)), name_of);

class Corpus : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(Corpus, IsAnsweredRight) {
  const auto cases = json_in(GetParam()).at("cases");
  const auto results = answers_to(GetParam(), "1e-13");
  ASSERT_EQ(results.size(), cases.size());
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const double truth = cases[k].at("truth"), F = results[k].at("F"), error = results[k].at("F_error");
    EXPECT_LE(std::fabs(F - truth), error + 0x1p-53 * truth) << cases[k].at("id");
    EXPECT_LE(error, 1e-13) << cases[k].at("id");
    if (truth == 0) {
      EXPECT_EQ(F, 0) << cases[k].at("id");
    }
    const PropertyTrial closure = try_closure(read_point_question(cases[k]));
    EXPECT_TRUE(closure.holds()) << cases[k].at("id") << ": front and back miss 1 by " << closure.defect;
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Corpus, testing::ValuesIn(corpus(false)), name_of);

}  // namespace
}  // namespace exitance
