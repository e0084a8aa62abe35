// Questions that were once answered wrong, by us or by plain doubles, each with the oracle's answer as `truth`; and the
// sum over a closed room around each.

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

std::vector<std::filesystem::path> corpus() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(source_file("tests/corpus")))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

class Corpus : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(Corpus, IsAnsweredRight) {
  const auto cases = json_in(GetParam()).at("cases");
  const Outcome outcome = run("cases " + GetParam().string() + " --tolerance 1e-13");
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  const auto results = nlohmann::json::parse(outcome.out).at("results");
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

INSTANTIATE_TEST_SUITE_P(Files, Corpus, testing::ValuesIn(corpus()),
                         [](const auto& one) { return one.param.stem().string(); });

}  // namespace
}  // namespace exitance
