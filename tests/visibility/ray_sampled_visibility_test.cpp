#include "src/visibility/ray_sampled_visibility.h"

#include <gtest/gtest.h>
#include <immintrin.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numeric>

#include "src/form_factor/area_rows.h"
#include "src/form_factor/pair_rows.h"
#include "src/form_factor/point_rows.h"
#include "src/form_factor/sampled_area_rows.h"
#include "src/scene/reader.h"
#include "src/visibility/exact_visibility.h"
#include "tests/places.h"

namespace exitance {
namespace {

/// Nothing lies in the plane of anything else, of which rays know nothing.
struct Room {
  explicit Room(std::uint32_t elements = 1)
      : mesh(make_patch_mesh(scene, soup, {.patch_size = 1, .elements_per_edge = elements})) {}

  Scene scene = read_scene(source_file("data/box_on_floor.toml"), {});
  PolygonSoup soup = make_soup(scene);
  PatchMesh mesh;
};

const Room& room() {
  static const Room made;
  return made;
}

std::vector<double> dense(const FormFactorMatrix& F) {
  std::vector<double> values(F.rows() * F.columns);
  for (std::size_t i = 0; i < F.rows(); ++i) {
    for (std::size_t k = 0; k < F.row(i).size(); ++k) values[i * F.columns + F.row_columns(i)[k]] = F.row(i)[k];
  }
  return values;
}

PointRows rows_of(const MeshVisibility& visibility) {
  return point_rows(visibility, 0, visibility.mesh().elements.size());
}

/// Root of the mean square of all differences.
double rms(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]) / static_cast<double>(a.size());
  return std::sqrt(sum);
}

const std::vector<double>& exact() {
  static const std::vector<double> F = dense(rows_of(ExactVisibility(room().mesh, room().soup)).F);
  return F;
}

std::vector<double> sampled(const RayOptions& options) {
  return dense(rows_of(RaySampledVisibility(room().mesh, room().soup, options)).F);
}

TEST(RaySampledVisibility, RowsApproachExactOnes) {
  const double few = rms(sampled({.rays = 16, .estimator = Estimator::kernel}), exact());
  const double many = rms(sampled({.rays = 1024, .estimator = Estimator::kernel}), exact());
  EXPECT_LT(few, 0.01);
  EXPECT_LT(many, few / 8) << "64 times the rays: at least as independent ones";
  EXPECT_LT(rms(sampled({.rays = 1 << 14, .estimator = Estimator::hemisphere}), exact()), 1e-3);
  EXPECT_GT(rms(sampled({.rays = 1024, .estimator = Estimator::fraction}), exact()), 3 * many) << "biased";
  EXPECT_GT(rms(sampled({.estimator = Estimator::centre}), exact()), few);
}

TEST(RaySampledVisibility, HemispheresAreUnbiased) {
  const RaySampledVisibility rays(room().mesh, room().soup,
                                  {.rays = 1 << 16, .sampler = Sampler::random, .estimator = Estimator::hemisphere});
  const auto observer = rays.observer();
  double squares = 0, count = 0;
  for (const std::size_t e : {0u, 17u, 40u}) {
    std::vector<double> row(room().mesh.patches.size());
    const PointRow seen = observer->row(e);
    for (std::size_t k = 0; k < seen.F.size(); ++k) row[seen.column[k]] = seen.F[k];
    for (std::size_t p = 0; p < row.size(); ++p) {
      const double F = exact()[e * row.size() + p];
      if (F < 1e-3) continue;
      const double z = (row[p] - F) / std::sqrt(F * (1 - F) / (1 << 16));
      EXPECT_LT(std::fabs(z), 4.5);
      squares += z * z;
      ++count;
    }
  }
  ASSERT_GT(count, 20);
  EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2 / count));
}

TEST(RaySampledVisibility, AnEntryIsThatOfTheRow) {
  for (const Estimator estimator : {Estimator::kernel, Estimator::hemisphere, Estimator::centre}) {
    const RaySampledVisibility rays(room().mesh, room().soup, {.rays = 256, .estimator = estimator});
    const auto observer = rays.observer();
    const PointRow row = observer->row(7);
    for (std::size_t k = 0; k < row.column.size(); ++k) EXPECT_EQ(observer->entry(7, row.column[k]).F, row.F[k]);
  }
}

TEST(RaySampledVisibility, RaysAndErrorsAreCounted) {
  const PointRows kernel = rows_of(RaySampledVisibility(room().mesh, room().soup, {.rays = 64, .replicates = 2}));
  const PairCounts& pairs = kernel.statistics.pairs;
  EXPECT_EQ(kernel.statistics.sampled, pairs.open + pairs.blocked + pairs.partial);
  EXPECT_GE(kernel.statistics.rays, 128 * kernel.statistics.sampled);
  EXPECT_GT(kernel.statistics.standard_error_sum, 0);
  const PointRows centre = rows_of(RaySampledVisibility(room().mesh, room().soup, {.estimator = Estimator::centre}));
  EXPECT_EQ(centre.statistics.sampled, 0u);
}

TEST(RaySampledVisibility, AreasAreAveragedOver) {
  const Room& r = room();
  const std::vector<double> truth = dense(area_rows(r.mesh, r.soup, {.pairs = {.tolerance = 1e-6}}, 1).F);
  double previous = 0.1;
  for (const std::uint32_t n : {16u, 1024u}) {
    const double error =
        rms(dense(sampled_area_rows(r.mesh, r.soup, ExchangeScene::Unit::element, {.rays = n}).F), truth);
    EXPECT_LT(error, previous / 6);
    previous = error;
  }
  const RayOptions hemisphere{.rays = 1 << 14, .estimator = Estimator::hemisphere};
  EXPECT_LT(rms(dense(sampled_area_rows(r.mesh, r.soup, ExchangeScene::Unit::element, hemisphere).F), truth), 1e-3);
}

TEST(RaySampledVisibility, APatchIsAsItsElements) {
  const Room r(2);
  const RayOptions options{.rays = 1 << 14, .estimator = Estimator::hemisphere};
  const SampledAreaRows elements = sampled_area_rows(r.mesh, r.soup, ExchangeScene::Unit::element, options),
                        patches = sampled_area_rows(r.mesh, r.soup, ExchangeScene::Unit::patch, options);
  ASSERT_GT(r.mesh.elements.size(), r.mesh.patches.size());
  ASSERT_EQ(patches.F.rows(), r.mesh.patches.size());
  std::vector<std::uint32_t> first;
  std::vector<double> area;
  for (const Patch& p : r.mesh.patches) first.push_back(p.element_first);
  for (const Element& e : r.mesh.elements) area.push_back(e.area);
  first.push_back(static_cast<std::uint32_t>(area.size()));
  EXPECT_LT(rms(dense(average_rows(elements.F, first, area)), dense(patches.F)), 1e-3);
}

TEST(RaySampledVisibility, EveryPairOfPatchesHasItsStandardError) {
  const Room& r = room();
  PairOptions exactly;
  exactly.tolerance = 1e-6;
  const ExchangeScene exchange(r.soup, r.mesh);
  std::vector<std::uint32_t> all(exchange.size());
  std::iota(all.begin(), all.end(), 0u);
  PairStatistics statistics;
  const PairRows known = pair_rows(exchange, all, exactly, statistics);
  const std::vector<double> truth = dense(matrix_of(std::span(&known, 1), static_cast<std::uint32_t>(all.size())));
  for (const Estimator estimator : {Estimator::kernel, Estimator::hemisphere}) {
    const RayOptions options{.rays = 1024, .replicates = 16, .sampler = Sampler::random, .estimator = estimator};
    const SampledAreaRows rows = sampled_area_rows(r.mesh, r.soup, ExchangeScene::Unit::patch, options);
    ASSERT_EQ(rows.standard_error.size(), rows.F.F.size());
    double sum = 0, squares = 0;
    int count = 0, beyond_4 = 0;
    for (std::size_t i = 0; i < rows.F.rows(); ++i) {
      for (std::uint64_t k = rows.F.row_first[i]; k < rows.F.row_first[i + 1]; ++k) {
        const double error = rows.standard_error[k];
        sum += error;
        if (error == 0) continue;
        const double apart = (rows.F.F[k] - truth[i * rows.F.columns + rows.F.column[k]]) / error;
        squares += apart * apart;
        ++count;
        beyond_4 += std::fabs(apart) > 4;
      }
    }
    EXPECT_NEAR(sum, rows.statistics.standard_error_sum, 1e-12 * sum);
    EXPECT_NEAR(std::sqrt(squares / count), 1, 0.15) << "random points: errors are as large as they say";
    EXPECT_LE(beyond_4, count / 100);
  }
  EXPECT_TRUE(sampled_area_rows(r.mesh, r.soup, ExchangeScene::Unit::element, {.rays = 4}).standard_error.empty());
}

TEST(RaySampledVisibility, AnyNumberOfThreadsGivesTheSameBits) {
  for (const Estimator estimator : {Estimator::kernel, Estimator::hemisphere}) {
    const RayOptions options{.rays = 64, .estimator = estimator};
    std::vector<std::vector<double>> points, areas;
    std::vector<double> errors;
    for (const std::size_t threads : {1u, 2u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const PointRows rows = rows_of(RaySampledVisibility(room().mesh, room().soup, options));
      points.push_back(rows.F.F);
      errors.push_back(rows.statistics.standard_error_sum);
      areas.push_back(sampled_area_rows(room().mesh, room().soup, ExchangeScene::Unit::element, options).F.F);
    }
    EXPECT_EQ(points[0], points[1]);
    EXPECT_EQ(areas[0], areas[1]);
    EXPECT_EQ(errors[0], errors[1]);
  }
}

// Rays and exact predicates in turns, in the same threads: neither is to notice the other.
TEST(RaySampledVisibility, LeavesExactVisibilityAlone) {
  const std::vector<double> before = exact();
  sampled({.rays = 64});
  sampled({.rays = 64, .estimator = Estimator::hemisphere});
  const PointRows after = rows_of(ExactVisibility(room().mesh, room().soup));
  EXPECT_EQ(dense(after.F), before);
  EXPECT_LT(after.statistics.closure_max_defect, 1e-12);
  EXPECT_EQ(_mm_getcsr() & (_MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON), 0u);
}

}  // namespace
}  // namespace exitance
