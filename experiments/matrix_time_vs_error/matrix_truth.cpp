#include "experiments/matrix_time_vs_error/matrix_truth.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "geometry/contour_form_factor.h"
#include "src/form_factor/matrix_check.h"
#include "src/form_factor/pair_run.h"
#include "src/form_factor/pair_sample.h"
#include "src/visibility/exact_visibility.h"
#include "src/visibility/fan_map.h"
#include "src/visibility/sample_points.h"
#include "src/visibility/seed.h"
#include "src/visibility/shadow_rays.h"

namespace exitance {
namespace {

constexpr std::uint32_t kSets = 16, kPointsOfASet = 2048;
constexpr std::uint64_t kMostPoints = 20'000;  // of an integral, before points that are spread evenly do better
constexpr std::size_t kVerifiedPairs = 40;

/// A value and how sure it is: standard error of the mean of the sets.
struct Estimate {
  double value = 0, standard_error = 0;
};

/// The exchange A_i F_ij [m²] by points of i. The integral of each piece is its area times a mean.
Estimate exchange_by_points(const ExchangeScene& exchange, std::size_t i, std::size_t j) {
  static const SamplePoints<2> points(Sampler::owen, kPointsOfASet);
  const PolygonSoup& soup = exchange.soup();
  Viewpoint view(soup);
  std::vector<double> of_set(kSets);
  std::vector<SamplePoints<2>::Point> taken(kPointsOfASet);
  std::uint64_t seed = question_seed(1, i, j);
  for (const ExchangeScene::Piece& a : exchange.pieces(i)) {
    ConvexLoop loop;
    for (const Vec3& v : a.radiator.facets()[0].loop) loop.push_back(v);
    const FanMap on_a(loop);
    const Vec3 normal = soup.facets()[a.source.facet].plane.normal;
    for (double& sum : of_set) {
      seed = mixed(seed);
      points.take(seed, 0, taken);
      for (const auto& [u, v] : taken) {
        view.look_from({on_a(u, v), normal, a.source.facet});
        for (const ExchangeScene::Piece& b : exchange.pieces(j)) {
          const PointFormFactor seen = view.form_factor(b.source, kPointTolerance);
          if (seen.side == Side::front) sum += seen.F * on_a.twice_area() / (2 * kPointsOfASet);
        }
      }
    }
  }
  Estimate mean;
  for (const double value : of_set) mean.value += value / kSets;
  for (const double value : of_set) mean.standard_error += (value - mean.value) * (value - mean.value);
  mean.standard_error = std::sqrt(mean.standard_error / (kSets * (kSets - 1)));
  return mean;
}

struct Pair {
  std::size_t part = 0, entry = 0;  ///< where it stands in the rows
  std::uint32_t i = 0, j = 0;
};

template <class Is>
std::vector<Pair> pairs_that(const std::vector<PairRows>& rows, const Is& is) {
  std::vector<Pair> pairs;
  for (std::size_t p = 0; p < rows.size(); ++p) {
    for (std::size_t r = 0; r < rows[p].row.size(); ++r) {
      for (std::size_t k = rows[p].row_first[r]; k < rows[p].row_first[r + 1]; ++k) {
        if (is(rows[p].mark[k])) pairs.push_back({p, k, rows[p].row[r], rows[p].column[k]});
      }
    }
  }
  return pairs;
}

/// Pairs that did not reach their tolerance are known better by points. Returns how many.
std::uint64_t improve(std::vector<PairRows>& rows, const ExchangeScene& exchange) {
  const std::vector<Pair> unreached = pairs_that(rows, [](std::uint8_t mark) { return !reached_of(mark); });
  tbb::parallel_for(std::size_t{0}, unreached.size(), [&](std::size_t k) {
    const auto& [part, entry, i, j] = unreached[k];
    PairRows& of = rows[part];
    // What a small patch sees of a large one varies less than what points of the large one see of it.
    const bool from_i = exchange.area(i) <= exchange.area(j);
    const Estimate known = exchange_by_points(exchange, from_i ? i : j, from_i ? j : i);
    const double A_i = exchange.area(i), A_j = exchange.area(j), error = 4 * known.standard_error;
    if (error >= of.F_error[entry] * A_i) return;
    of.F[entry] = known.value / A_i;
    of.F_error[entry] = error / A_i;
    of.F_reverse[entry] = known.value / A_j;
    of.F_reverse_error[entry] = error / A_j;
  });
  return unreached.size();
}

/// The exchange of a pair by 16 sets of 2,048 rays, and what it is without occluders.
struct ByRays {
  double exchange = 0, standard_error = 0, unoccluded = 0;
};

ByRays by_rays(const ShadowRays& rays, const ExchangeScene& exchange, const Pair& pair) {
  ByRays sum;
  double variance = 0;
  std::uint64_t seed = question_seed(2, pair.i, pair.j);
  for (const ExchangeScene::Piece& a : exchange.pieces(pair.i)) {
    for (const ExchangeScene::Piece& b : exchange.pieces(pair.j)) {
      seed = mixed(seed);
      const double open = unobstructed_exchange(a.radiator, b.radiator).integral;
      const SampledFormFactor f = rays.exchange(a.source, b.source, open, seed);
      sum.exchange += f.F;
      sum.unoccluded += open;
      variance += f.standard_error * f.standard_error;
    }
  }
  sum.standard_error = std::sqrt(variance);
  return sum;
}

void require(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error("the truth is not verified: " + what);
}

/// Rays know a pair to six standard errors, ten rays' share, and the bias of their offset, which twice the offset
/// changes by as much as the bias itself.
void require_what_rays_find(const std::vector<PairRows>& rows, const ExchangeScene& exchange) {
  const std::vector<Pair> partial =
      pairs_that(rows, [](std::uint8_t mark) { return class_of(mark) == PairClass::partial && reached_of(mark); });
  const RayOptions options{.rays = kPointsOfASet, .replicates = kSets, .sampler = Sampler::owen};
  RayOptions farther = options;
  farther.offset *= 2;
  const ShadowRays near(exchange.soup(), options), far(exchange.soup(), farther);
  const std::size_t step = std::max<std::size_t>(1, partial.size() / kVerifiedPairs);
  for (std::size_t k = 0; k < partial.size(); k += step) {
    const Pair& pair = partial[k];
    if (pair.i == pair.j) continue;
    const ByRays n = by_rays(near, exchange, pair), f = by_rays(far, exchange, pair);
    const double allowed = 6 * (n.standard_error + f.standard_error) + 3 * std::fabs(n.exchange - f.exchange) +
                           10.0 / (kSets * kPointsOfASet) * n.unoccluded,
                 A = exchange.area(pair.i), F = rows[pair.part].F[pair.entry],
                 F_error = rows[pair.part].F_error[pair.entry];
    require(std::fabs(A * F - n.exchange) <= allowed + A * F_error,
            fmt::format("F from {} to {} is {} ± {}, by rays {} ± {}", pair.i, pair.j, F, F_error, n.exchange / A,
                        allowed / A));
  }
}

}  // namespace

KnownMatrix known_matrix(const ExchangeScene& exchange, double tolerance) {
  const PairOptions options{.tolerance = tolerance, .points = kMostPoints};
  PairRun run = run_pairs(exchange, {.pairs = options}, nullptr);
  for (const PairDefect& defect : sample_pairs(exchange, run.rows, options, kVerifiedPairs, 1).reciprocity) {
    require(defect.holds(), fmt::format("{} and {} exchange {} more one way than the other; errors allow {}", defect.i,
                                        defect.j, defect.amount, defect.allowed));
  }
  KnownMatrix known;
  known.by_points = improve(run.rows, exchange);
  require_what_rays_find(run.rows, exchange);
  known.truth = truth_of(run.rows, static_cast<std::uint32_t>(exchange.size()));
  std::vector<double> area;
  for (std::size_t i = 0; i < exchange.size(); ++i) area.push_back(exchange.area(i));
  const MatrixCheck check = check_matrix(known.truth.F, area);
  if (check.excess)
    require(check.excess->holds(), fmt::format("row {} sums to 1 + {}", check.excess->row, check.excess->amount));
  if (check.entry) {
    require(check.entry->holds(),
            fmt::format("F from {} to {} is {} too much", check.entry->row, check.entry->column, check.entry->amount));
  }
  for (const double error : known.truth.F.F_error) {
    known.largest_error = std::max(known.largest_error, error);
    known.rms_error += error * error / static_cast<double>(known.truth.F.F_error.size());
  }
  known.rms_error = std::sqrt(known.rms_error);
  return known;
}

}  // namespace exitance
