#include "src/output/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

TEST(Report, HasEveryPromisedKeyWithItsValue) {
  Report report;
  report.patches = 6;
  report.elements = 24;
  report.iterations = 17;
  report.residual = 1e-16;
  report.error_bound = 0.1;
  report.energy_balance_defect = 2e-15;
  report.closure_max_defect = 3e-15;
  report.covered_points = 4;
  report.pairs = {1, 2, 3, 5};
  report.seconds = {0.5, 1.5, 2.5, 3.5, 8};
  report.peak_memory_bytes = 123456789012;
  report.B_min = 2;
  report.B_max = 1.0 / 3;
  report.unit = "W/m^2";
  report.receivers = "points";
  report.warnings = {"a face is bent", "caf\xe9.obj is no UTF-8"};
  report.predicate_stages = {{"double", 10}, {"exact", 1}};
  report.manifest = build_manifest();
  report.threads = 2;
  report.seed = 99;
  report.scene_hash = "abc";
  report.options = {{"method", "gather"}};
  const ScratchFolder folder;
  write_report(folder / "result.json", report);
  const auto json = nlohmann::json::parse(contents(folder / "result.json"));
  EXPECT_EQ(json.at("patches"), 6);
  EXPECT_EQ(json.at("elements"), 24);
  EXPECT_EQ(json.at("iterations"), 17);
  EXPECT_EQ(json.at("residual"), 1e-16);
  EXPECT_EQ(json.at("error_bound"), 0.1);
  EXPECT_EQ(json.at("energy_balance_defect"), 2e-15);
  EXPECT_EQ(json.at("closure_max_defect"), 3e-15);
  EXPECT_EQ(json.at("covered_points"), 4);
  EXPECT_TRUE(json.at("reciprocity_max_defect").is_null());
  EXPECT_EQ(json.at("pairs"), (nlohmann::json{{"facing_away", 1}, {"open", 2}, {"blocked", 3}, {"partial", 5}}));
  EXPECT_EQ(json.at("seconds"),
            (nlohmann::json{{"load", 0.5}, {"form_factors", 1.5}, {"solve", 2.5}, {"output", 3.5}, {"total", 8.0}}));
  EXPECT_EQ(json.at("peak_memory_bytes"), 123456789012);
  EXPECT_EQ(json.at("B_min"), 2);
  EXPECT_EQ(json.at("B_max"), 1.0 / 3);
  EXPECT_EQ(json.at("warnings").size(), 2u);
  EXPECT_EQ(json.at("receivers"), "points");
  EXPECT_EQ(json.at("unit"), "W/m^2");
  EXPECT_EQ(json.at("predicate_stages").at("double"), 10);
  const auto& manifest = json.at("manifest");
  EXPECT_EQ(manifest.at("threads"), 2);
  EXPECT_EQ(manifest.at("seed"), 99);
  EXPECT_EQ(manifest.at("scene_hash"), "abc");
  EXPECT_EQ(manifest.at("options").at("method"), "gather");
}

TEST(Report, OpenScenesHaveNoClosureAndUnprovenBoundsAreNull) {
  Report report;
  report.error_bound = std::numeric_limits<double>::infinity();
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_TRUE(json.at("closure_max_defect").is_null());
  EXPECT_TRUE(json.at("error_bound").is_null());
}

TEST(Manifest, NamesVersionsOfEverything) {
  const Manifest manifest = build_manifest();
  const auto looks_like_a_version = testing::MatchesRegex("[0-9]+\\.[0-9]+(\\.[0-9]+)?");
  EXPECT_THAT(manifest.version, looks_like_a_version);
  EXPECT_THAT(manifest.commit, testing::AnyOf("unknown", testing::MatchesRegex("[0-9a-f]+(-modified)?")));
  EXPECT_THAT(manifest.compiler, testing::Not(testing::IsEmpty()));
  for (const char* name : {"CGAL", "Eigen", "Boost", "OpenMesh", "TBB", "Embree", "HDF5"}) {
    ASSERT_TRUE(manifest.libraries.contains(name)) << name;
    EXPECT_THAT(manifest.libraries.at(name), looks_like_a_version) << name;
  }
}

}  // namespace
}  // namespace exitance
