// Solutions in files.

#include "src/reference/solution_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "src/output/archive.h"
#include "src/reference/refined_mesh.h"
#include "tests/output/damage.h"
#include "tests/reference/half_shadow.h"

namespace exitance {
namespace {

using testing::HasSubstr;

SolutionRecord some_record() {
  const Scene scene = half_shadow(0.6, 0.3);
  const PolygonSoup soup = make_soup(scene);
  RefinedMesh refined(scene, soup, {.elements_per_edge = 4});
  refined.split(std::vector<std::uint32_t>{0});
  SolutionRecord record{.scene = "half shadow", .scene_hash = "hash", .unit = "W/m^2", .bands = 2};
  record.mesh = refined.mesh();
  record.degree = 3;
  for (std::size_t k = 0; k < 2 * record.mesh.elements.size(); ++k) {
    record.B.push_back(std::sqrt(static_cast<double>(k)));
    record.H.push_back(std::cbrt(static_cast<double>(k)));
  }
  record.error = {0.3, 0.1, 0.15, 0.05};
  record.manifest = "{\"version\": \"1\"}";
  return record;
}

TEST(SolutionRecordTest, ComesBackBitForBit) {
  const ScratchFolder scratch;
  const SolutionRecord record = some_record();
  write_solution_archive(scratch / "a.h5", record);
  const SolutionRecord read = read_solution(scratch / "a.h5");
  EXPECT_EQ(read.source, (scratch / "a.h5").string());
  EXPECT_EQ(read.scene, record.scene);
  EXPECT_EQ(read.scene_hash, record.scene_hash);
  EXPECT_EQ(read.unit, record.unit);
  EXPECT_EQ(read.bands, record.bands);
  EXPECT_EQ(read.degree, record.degree);
  EXPECT_EQ(read.B, record.B);
  EXPECT_EQ(read.H, record.H);
  EXPECT_EQ(read.error.total, 0.3);
  EXPECT_EQ(read.error.solver, 0.05);
  EXPECT_EQ(read.manifest, record.manifest);
  EXPECT_TRUE(std::ranges::equal(read.mesh.points, record.mesh.points));
  ASSERT_EQ(read.mesh.elements.size(), record.mesh.elements.size());
  for (std::size_t e = 0; e < read.mesh.elements.size(); ++e) {
    EXPECT_EQ(read.mesh.elements[e].area, record.mesh.elements[e].area);
    EXPECT_EQ(read.mesh.elements[e].normal, record.mesh.elements[e].normal);
    EXPECT_EQ(read.mesh.elements[e].patch, record.mesh.elements[e].patch);
    EXPECT_EQ(read.mesh.elements[e].loop_first, record.mesh.elements[e].loop_first);
  }
}

TEST(SolutionRecordTest, DamageIsNoticed) {
  const ScratchFolder scratch;
  write_solution_archive(scratch / "a.h5", some_record());
  const std::string bytes = contents(scratch / "a.h5");
  put(scratch / "short.h5", bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(read_solution(scratch / "short.h5"), DamagedFile);
  put(scratch / "text.h5", "no archive");
  EXPECT_THROW(read_solution(scratch / "text.h5"), DamagedFile);
  EXPECT_THROW(read_solution(scratch / "none.h5"), InputError);
  std::size_t noticed = 0;
  for (std::size_t at = 0; at < bytes.size(); at += bytes.size() / 64) {
    put(scratch / "flipped.h5", flipped(bytes, at));
    try {
      const SolutionRecord read = read_solution(scratch / "flipped.h5");
      EXPECT_EQ(read.B, some_record().B) << at;  // a byte that nothing depends on
    } catch (const InputError&) {
      ++noticed;
    }
  }
  EXPECT_GT(noticed, 30u);
}

TEST(SolutionRecordTest, ElementsWithinElementsWithoutEndAreRefused) {
  const ScratchFolder scratch;
  put(scratch / "result.json", R"({"scene": "", "unit": "", "bands": 1, "manifest": {"scene_hash": ""}})");
  std::string text = "<?xml version=\"1.0\"?>";
  for (int depth = 0; depth < 1'000'000; ++depth) text += "<a>";
  put(scratch / "solution.vtp", text);
  try {
    read_solution(scratch / "solution.vtp");
    FAIL();
  } catch (const InputError& refused) {
    EXPECT_THAT(refused.what(), HasSubstr("has more than 1000 tags"));
  }
}

TEST(SolutionRecordTest, ListsThatMakeNoMeshAreRefused) {
  const ScratchFolder scratch;
  const std::vector<double> points{0, 0, 0, 1, 0, 0, 1, 1, 0}, none, error{0, 0, 0, 0}, normal{0, 0, 1};
  const std::vector<std::uint32_t> one{1}, zero{0}, corners{3, 3};
  ArchiveWriter file(scratch / "a.h5", "exitance solution 1");
  for (const char* text : {"scene", "scene_hash", "unit", "manifest"}) file.write(text, std::string_view("x"));
  for (const char* name : {"bands", "degree", "patch_elements"}) file.write(name, std::span(one));
  for (const char* name : {"patch_surface", "patch_facet"}) file.write(name, std::span(zero));
  file.write("piece_corners", std::span(corners));  // of two pieces, but points of one
  file.write("points", std::span(points));
  file.write("patch_normal", std::span(normal));
  file.write("error", std::span(error));
  file.write("B", std::span(none));
  file.write("H", std::span(none));
  file.publish();
  try {
    read_solution(scratch / "a.h5");
    FAIL();
  } catch (const DamagedFile& damaged) {
    EXPECT_THAT(damaged.what(), HasSubstr("make no mesh"));
  }
}

TEST(SolutionRecordTest, WhatDoesNotFitIsNotWritten) {
  const ScratchFolder scratch;
  SolutionRecord record = some_record();
  record.B.pop_back();
  EXPECT_THROW(write_solution_archive(scratch / "a.h5", record), std::invalid_argument);
  record = some_record();
  PatchPiece whole = record.mesh.pieces[1];
  whole.loop_count = 0;
  record.mesh.pieces.set(1, whole);
  EXPECT_THROW(write_solution_archive(scratch / "a.h5", record), std::invalid_argument);
  EXPECT_EQ(scratch.files(), 0u);
}

TEST(SolutionRecordTest, LuminanceNeedsAllValues) {
  EXPECT_EQ(luminance(std::vector<double>{1, 2, 3, 4}, 2, 2), (std::vector<double>{3, 7}));
  EXPECT_THROW(luminance(std::vector<double>{1, 2, 3}, 2, 2), std::invalid_argument);
  EXPECT_THROW(luminance(std::vector<double>{}, 0, 0), std::invalid_argument);
}

}  // namespace
}  // namespace exitance
