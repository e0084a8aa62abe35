// Reference solutions: right where the answer is known, with an error figure that holds.

#include "src/reference/reference_solution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "src/scene/input_error.h"
#include "src/scene/reader.h"
#include "tests/output/scratch_folder.h"
#include "tests/places.h"
#include "tests/reference/half_shadow.h"
#include "tests/reference/pointwise_error.h"
#include "tests/reference/small_shadow.h"

namespace exitance {
namespace {

ReferenceOptions wanted(double error) {
  ReferenceOptions options;
  options.error = error;
  return options;
}

ReferenceSolution solve(const Scene& scene, const ReferenceOptions& options) {
  const PolygonSoup soup = make_soup(scene);
  return solve_reference(scene, soup, options);
}

TEST(ReferenceSolutionTest, AFurnaceIsConstant) {
  const ReferenceSolution s = solve(read_scene(source_file("data/furnace_cube.toml")), wanted(1e-9));
  EXPECT_EQ(s.end, ReferenceEnd::reached);
  EXPECT_LE(s.record.error.total, 1e-9);
  for (const double B : s.record.B) EXPECT_NEAR(B, 2, 1e-9);
  for (const double H : s.record.H) EXPECT_NEAR(H, 2, 2e-9);
}

/// Refines to the error and expects that at every level the estimate holds and is not more than `most` times too large.
void expect_error_holds(const Scene& scene, const Truth& truth, int halvings, double error, double most) {
  const PolygonSoup soup = make_soup(scene);
  const ReferenceSolution s = solve_reference(scene, soup, wanted(error), [&](const ReferenceSolution& level) {
    const SolutionRecord& record = level.record;
    const double missed = pointwise_error(record.mesh, record.degree, record.B, truth, halvings);
    EXPECT_LE(missed, record.error.total) << "level " << level.levels.size();
    EXPECT_GE(most * missed, record.error.total) << "level " << level.levels.size();
  });
  EXPECT_LE(s.record.error.total, error);
  EXPECT_GE(s.levels.size(), 2u);
}

void expect_error_holds(double edge, double angle, double error) {
  SCOPED_TRACE(testing::Message() << "edge " << edge << ", turned by " << angle);
  const Truth truth = [=](std::uint32_t surface, const Vec3& point) {
    const Vec3 p = turned_about_z(point, -angle);
    return surface == 0 ? half_shadow_B(edge, p.x, p.y) : surface == 1 ? 1 : 0;
  };
  expect_error_holds(half_shadow(edge, angle), truth, 0, error, 60);
}

TEST(ReferenceSolutionTest, TheErrorHoldsWithoutShadows) {
  expect_error_holds(-9, 0, 1e-6);
}

TEST(ReferenceSolutionTest, TheErrorHoldsInAPenumbra) {
  for (const double angle : {0.0, 0.3}) {
    expect_error_holds(0.5, angle, 1e-5);   // all of the floor
    expect_error_holds(0.65, angle, 1e-5);  // it ends in the floor
  }
}

/// An element of the first mesh is 0.25 wide: it sees little of a shadow in its mean, or of one between its points.
TEST(ReferenceSolutionTest, TheErrorHoldsWhereShadowsAreSmallAgainstTheFirstMesh) {
  for (const SmallSheet& sheet : {SmallSheet{0.62, 0.31, 0.06, 0.01}, {0.62, 0.31, 0.02, 0.003}}) {
    SCOPED_TRACE(testing::Message() << "sheet of " << sheet.edge << " at " << sheet.x);
    const Truth truth = [&](std::uint32_t surface, const Vec3& p) {
      return surface == 0 ? small_shadow_B(sheet, p.x, p.y) : surface == 1 ? 1 : 0;
    };
    expect_error_holds(small_shadow(sheet), truth, 6, 2e-3, 10);
  }
}

TEST(ReferenceSolutionTest, WithoutLightThereIsNoError) {
  Scene scene = half_shadow(0.5);
  for (Material& material : scene.materials) material.E = {0};
  const ReferenceSolution s = solve(scene, wanted(1e-6));
  EXPECT_EQ(s.record.error.total, 0);
  for (const double B : s.record.B) EXPECT_EQ(B, 0);
}

TEST(ReferenceSolutionTest, GoesOnFromItsCheckpointWithTheSameBits) {
  const Scene scene = half_shadow(0.65, 0.3);
  const PolygonSoup soup = make_soup(scene);
  const ReferenceSolution whole = solve_reference(scene, soup, wanted(1e-4));
  const ScratchFolder scratch;
  ReferenceOptions options = wanted(1e-4);
  options.checkpoint = scratch / "parts";
  options.block_seconds = 0;
  ReferenceSolution resumed;
  int starts = 0;
  for (bool done = false; !done; ++starts) {
    ASSERT_LT(starts, 1000);
    const auto left = std::make_shared<std::atomic<int>>(20);
    options.stop = [left] { return *left <= 0; };
    options.progress = [left](double, std::string_view) { --*left; };
    try {
      resumed = solve_reference(scene, soup, options);
      done = resumed.end == ReferenceEnd::reached;
    } catch (const LimitError&) {  // nothing finished yet
    }
  }
  EXPECT_GT(starts, 2);
  EXPECT_EQ(resumed.record.B, whole.record.B);
  EXPECT_EQ(resumed.record.H, whole.record.H);
  EXPECT_EQ(resumed.record.error.total, whole.record.error.total);
  EXPECT_TRUE(std::ranges::equal(resumed.record.mesh.points, whole.record.mesh.points));
  EXPECT_GT(resumed.levels[0].resumed_rows, 0u);
}

TEST(ReferenceSolutionTest, LimitsEndItWithWhatThereIsOrRefuse) {
  const Scene scene = half_shadow(0.65);
  ReferenceOptions options = wanted(1e-9);
  options.memory_limit = 1000;
  EXPECT_THROW(solve(scene, options), LimitError);
  options.memory_limit = 1 << 20;
  const ReferenceSolution s = solve(scene, options);
  EXPECT_EQ(s.end, ReferenceEnd::memory);
  EXPECT_GT(s.bytes_needed, options.memory_limit);
  EXPECT_FALSE(s.levels.empty());
  EXPECT_GT(s.record.error.total, 1e-9);
  options.stop = [] { return true; };
  EXPECT_THROW(solve(scene, options), LimitError);
  EXPECT_THROW(solve(scene, wanted(0)), std::invalid_argument);
}

TEST(ReferenceSolutionTest, ToleranceIsThatOfTheDecade) {
  EXPECT_EQ(pair_options_for(1e-3).tolerance, pair_options_for(9e-3).tolerance);
  EXPECT_LT(pair_options_for(9e-4).tolerance, pair_options_for(1e-3).tolerance);
}

TEST(ReferenceSolutionTest, NothingWithAnAreaIsRefused) {
  Scene scene = half_shadow(0.5);
  for (Surface& surface : scene.surfaces) surface.obstruction_only = true;
  EXPECT_THROW(solve(scene, wanted(1e-3)), InputError);
}

}  // namespace
}  // namespace exitance
