// Reference solutions: right where the answer is known, with an error figure that holds.

#include "src/reference/reference_solution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "src/form_factor/area_cell.h"
#include "src/reference/comparison.h"
#include "src/reference/patch_polynomials.h"
#include "src/scene/input_error.h"
#include "src/scene/reader.h"
#include "tests/output/scratch_folder.h"
#include "tests/reference/half_shadow.h"

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

/// The norm of equation 7 of what the floor's solution misses of the closed form, as functions.
double true_error(const SolutionRecord& record, double edge, double angle) {
  const PatchMesh& mesh = record.mesh;
  const PatchPolynomials polynomials(mesh, record.degree);
  const std::vector<double> coefficients = polynomials.fit(record.B, 1);
  std::vector<double> terms(polynomials.terms());
  std::vector<WeightedPoint> points;
  double missed = 0, all = 0;
  for (std::uint32_t e = 0; e < mesh.elements.size(); ++e) {
    const std::uint32_t patch = mesh.elements[e].patch;
    const std::uint32_t surface = mesh.patches[patch].surface;
    const double shift = record.B[e] - polynomials.mean(e, coefficients, 1, 0);
    for (const AreaCell& cell : cells_of(mesh.loop(mesh.elements[e]))) {
      gauss_points(cell, 12, points);
      for (const WeightedPoint& x : points) {
        polynomials.terms_at(patch, x.point, terms);
        double value = shift;
        for (std::size_t t = 0; t < terms.size(); ++t) value += terms[t] * coefficients[patch * terms.size() + t];
        const Vec3 p = turned_about_z(x.point, -angle);
        const double truth = surface == 0 ? half_shadow_B(edge, p.x, p.y) : surface == 1 ? 1 : 0;
        missed += x.weight * (value - truth) * (value - truth);
        all += x.weight * truth * truth;
      }
    }
  }
  return std::sqrt(missed / all);
}

TEST(ReferenceSolutionTest, AFurnaceIsConstant) {
  const ReferenceSolution s = solve(read_scene(EXITANCE_SOURCE_DIR "/data/furnace_cube.toml"), wanted(1e-9));
  EXPECT_EQ(s.end, ReferenceEnd::reached);
  EXPECT_LE(s.record.error.total, 1e-9);
  for (const double B : s.record.B) EXPECT_NEAR(B, 2, 1e-9);
  for (const double H : s.record.H) EXPECT_NEAR(H, 2, 2e-9);
}

/// Refines to the error and expects that at every level the estimate holds and is not more than 60 times too large.
void expect_error_holds(double edge, double angle, double error) {
  const Scene scene = half_shadow(edge, angle);
  const PolygonSoup soup = make_soup(scene);
  const ReferenceSolution s = solve_reference(scene, soup, wanted(error), [&](const ReferenceSolution& level) {
    const double missed = true_error(level.record, edge, angle), estimated = level.record.error.total;
    EXPECT_LE(missed, estimated) << edge << ' ' << angle << ", level " << level.levels.size();
    EXPECT_GE(60 * missed, estimated) << edge << ' ' << angle << ", level " << level.levels.size();
  });
  EXPECT_LE(s.record.error.total, error);
  EXPECT_GE(s.levels.size(), 2u);
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
