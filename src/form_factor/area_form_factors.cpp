#include "src/form_factor/area_form_factors.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace exitance {
namespace {

/// Both integrals start with so many points, and go on with twice as many as before.
constexpr std::uint64_t kFirstPoints = 250;
/// An integral costs up to some 10 µs a point.
constexpr std::uint64_t kScenePoints = 5'000'000, kFewestPoints = 2'000, kMostPoints = 100'000;

double area_of(const PolygonSoup& soup, std::uint32_t polygon) {
  double area = 0;
  std::vector<Vec3> loop;
  for (std::uint32_t f = soup.first_facet(polygon); f < soup.first_facet(polygon + 1); ++f) {
    loop.clear();
    for (const Corner& c : soup.corners(soup.facets()[f])) loop.push_back(soup.vertices()[c.vertex]);
    area += norm(area_vector(loop));
  }
  return area;
}

}  // namespace

AreaScene::AreaScene(std::span<const Polygon> polygons, std::span<const Role> roles)
    : soup_(polygons, roles), open_(polygons, std::vector<Role>(polygons.size(), Role::unoccluding)) {
  for (std::uint32_t p = 0; p < polygons.size(); ++p) area_.push_back(area_of(soup_, p));
}

PairFormFactor pair_form_factor(const AreaScene& scene, AreaViews& views, std::uint32_t i, std::uint32_t j,
                                double tolerance, std::uint64_t points) {
  AreaMean there(scene.soup(), i, j), back(scene.soup(), j, i);
  if (there.sees_nothing() || back.sees_nothing()) return {};
  const double A_i = scene.area(i), A_j = scene.area(j);
  // One integral serves both directions; the smaller polygon's form factor has the larger error. Rounding of the
  // quotients and of the areas stays outside.
  const double needed = tolerance * std::min(A_i, A_j);
  AreaMean *better = &there, *worse = &back;
  if (A_j < A_i) std::swap(better, worse);
  for (std::uint64_t n = kFirstPoints;; n = std::min(2 * n, points)) {
    better->refine(views, needed, n);
    worse->refine(views, needed, n);
    if (worse->error() < better->error()) std::swap(better, worse);
    if (better->error() <= needed || n == points) break;
  }
  const double exchange = better->integral(), other = worse->integral();
  double error = better->error();
  const double disagreement = std::fabs(exchange - other);
  if (disagreement > error + worse->error()) error = disagreement;

  PairFormFactor result;
  const auto ratio = [&](double area, double& F, double& F_error) {
    F = exchange / area;
    F_error = error / area + 16 * kRoundoff * F;
  };
  ratio(A_i, result.F, result.F_error);
  ratio(A_j, result.F_reverse, result.F_reverse_error);
  result.reached = std::max(result.F_error, result.F_reverse_error) <= tolerance;
  return result;
}

std::uint64_t points_per_integral(std::uint64_t pairs) {
  return std::clamp(kScenePoints / std::max<std::uint64_t>(1, pairs), kFewestPoints, kMostPoints);
}

AreaFormFactors area_form_factors(const AreaScene& scene, double tolerance) {
  AreaFormFactors result;
  const std::size_t n = scene.soup().polygon_count();
  result.n = n;
  result.F.assign(n * n, 0);
  result.F_error.assign(n * n, 0);
  for (std::uint32_t p = 0; p < n; ++p) result.area.push_back(scene.area(p));

  struct Pair {
    std::uint32_t i, j;
  };
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = i + 1; j < n; ++j) pairs.push_back({i, j});
  }
  const std::uint64_t points = points_per_integral(pairs.size());
  std::vector<std::uint8_t> reached(pairs.size(), 1);
  tbb::enumerable_thread_specific<AreaViews> all_views([&] { return scene.views(); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs.size(), 1), [&](const auto& some) {
    AreaViews& views = all_views.local();
    for (std::size_t k = some.begin(); k < some.end(); ++k) {
      const auto [i, j] = pairs[k];
      const PairFormFactor f = pair_form_factor(scene, views, i, j, tolerance, points);
      result.F[i * n + j] = f.F;
      result.F[j * n + i] = f.F_reverse;
      result.F_error[i * n + j] = f.F_error;
      result.F_error[j * n + i] = f.F_reverse_error;
      reached[k] = f.reached;
    }
  });
  result.reached = std::all_of(reached.begin(), reached.end(), [](std::uint8_t r) { return r != 0; });
  return result;
}

}  // namespace exitance
