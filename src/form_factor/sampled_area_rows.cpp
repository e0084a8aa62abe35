#include "src/form_factor/sampled_area_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/contour_form_factor.h"
#include "src/form_factor/area_rows.h"
#include "src/form_factor/pair_rows.h"
#include "src/form_factor/row_blocks.h"
#include "src/visibility/hemisphere_rays.h"
#include "src/visibility/seed.h"
#include "src/visibility/shadow_rays.h"

namespace exitance {
namespace {

constexpr std::size_t kBlock = 32;

struct ExchangeRow {
  PairRows pairs;
  std::vector<double> standard_error, reverse_standard_error;  // one for each F and F_reverse
  PointRowStatistics statistics;
};

/// Pairs (i, j), j ≥ i.
class ExchangeRows {
 public:
  ExchangeRows(const PatchMesh& mesh, const PolygonSoup& soup, ExchangeScene::Unit unit, const RayOptions& options)
      : scene_(soup, mesh, unit), rays_(soup, options) {}

  std::size_t size() const { return scene_.size(); }

  ExchangeRow row(std::size_t i) const {
    ExchangeRow row;
    for (std::size_t j = i; j < scene_.size(); ++j) {
      const SampledFormFactor f = exchange(i, j);
      const std::uint64_t times = i == j ? 1 : 2;
      f.count_in(row.statistics.pairs) += times;
      if (f.F_unoccluded == 0) continue;
      row.statistics.rays += f.rays;
      const double A_i = scene_.area(i), A_j = scene_.area(j);
      if (std::isfinite(f.standard_error)) {
        row.statistics.sampled += times;
        row.statistics.standard_error_sum += f.standard_error / A_i + (i == j ? 0 : f.standard_error / A_j);
      }
      row.pairs.column.push_back(static_cast<std::uint32_t>(j));
      row.pairs.F.push_back(f.F / A_i);
      row.pairs.F_reverse.push_back(f.F / A_j);
      row.pairs.F_error.push_back(kBoundOfAny);
      row.pairs.F_reverse_error.push_back(kBoundOfAny);
      row.pairs.mark.push_back(0);
      row.standard_error.push_back(f.standard_error / A_i);
      row.reverse_standard_error.push_back(f.standard_error / A_j);
    }
    row.pairs.row.push_back(static_cast<std::uint32_t>(i));
    row.pairs.row_first.push_back(row.pairs.column.size());
    return row;
  }

 private:
  SampledFormFactor exchange(std::size_t i, std::size_t j) const {
    SampledSum sum;
    std::uint64_t seed = question_seed(rays_.options().seed, i, j);
    const auto a = scene_.pieces(i), b = scene_.pieces(j);
    for (std::size_t k = 0; k < a.size(); ++k) {
      for (std::size_t l = i == j ? k + 1 : 0; l < b.size(); ++l) {
        seed = mixed(seed);
        const double unoccluded = unobstructed_exchange(a[k].radiator, b[l].radiator).integral;
        // Of a bent element, what goes there and what comes back.
        sum.add(rays_.exchange(a[k].source, b[l].source, unoccluded, seed), i == j ? 2 : 1);
      }
    }
    return sum.value();
  }

  ExchangeScene scene_;
  ShadowRays rays_;
};

SampledAreaRows by_shadow_rays(const PatchMesh& mesh, const PolygonSoup& soup, ExchangeScene::Unit unit,
                               const RayOptions& options, const Progress& progress) {
  const ExchangeRows rows(mesh, soup, unit, options);
  SampledAreaRows result;
  PairRows all;
  std::vector<double> error, reverse_error;
  for_each_row(
      rows.size(), kBlock, [&](std::size_t i) { return rows.row(i); },
      [&](const ExchangeRow& row) {
        append(all, row.pairs);
        result.statistics += row.statistics;
        if (unit == ExchangeScene::Unit::element) return;
        error.insert(error.end(), row.standard_error.begin(), row.standard_error.end());
        reverse_error.insert(reverse_error.end(), row.reverse_standard_error.begin(), row.reverse_standard_error.end());
      },
      [&](std::size_t done) {
        const double left = 1 - static_cast<double>(done) / static_cast<double>(rows.size());
        if (progress) progress(1 - left * left, "form factors");
      });
  const auto n = static_cast<std::uint32_t>(rows.size());
  result.F = matrix_of(std::span(&all, 1), n);
  if (unit == ExchangeScene::Unit::element) {
    result.F = sum_to_patches(result.F, mesh);
    return result;
  }
  all.F = std::move(error);
  all.F_reverse = std::move(reverse_error);
  result.standard_error = matrix_of(std::span(&all, 1), n).F;  // in the same places
  return result;
}

/// The pieces of element or patch k.
std::span<const PatchPiece> pieces_of(const PatchMesh& mesh, ExchangeScene::Unit unit, std::size_t k) {
  return unit == ExchangeScene::Unit::element ? mesh.pieces_of(mesh.elements[k]) : mesh.pieces_of(mesh.patches[k]);
}

SampledAreaRows by_hemispheres(const PatchMesh& mesh, const PolygonSoup& soup, ExchangeScene::Unit unit,
                               const RayOptions& options, const Progress& progress) {
  const HemisphereRays rays(mesh, soup, options);
  const std::size_t n = unit == ExchangeScene::Unit::element ? mesh.elements.size() : mesh.patches.size();
  SampledAreaRows result;
  result.F.columns = static_cast<std::uint32_t>(mesh.patches.size());
  for_each_row(
      n, kBlock,
      [&](std::size_t k) { return rays.from_area(pieces_of(mesh, unit, k), question_seed(options.seed, k, 0)); },
      [&](const HemisphereHits& hits) {
        for (const auto& [patch, count] : hits.front) {
          result.F.column.push_back(patch);
          result.F.F.push_back(hits.share(count));
          result.F.F_error.push_back(kBoundOfAny);
          const double error = hits.standard_error(count);
          if (unit == ExchangeScene::Unit::patch) result.standard_error.push_back(error);
          result.statistics.standard_error_sum += error;
        }
        result.F.row_first.push_back(result.F.F.size());
        result.statistics.rays += hits.rays - hits.covered;
        result.statistics.sampled += hits.front.size();
        result.statistics.pairs.partial += hits.front.size();
        result.statistics.pairs.facing_away += mesh.patches.size() - hits.front.size();
      },
      [&](std::size_t done) {
        if (progress) progress(static_cast<double>(done) / static_cast<double>(n), "form factors");
      });
  return result;
}

}  // namespace

SampledAreaRows sampled_area_rows(const PatchMesh& mesh, const PolygonSoup& soup, ExchangeScene::Unit receivers,
                                  const RayOptions& options, const Progress& progress) {
  SampledAreaRows result = options.estimator == Estimator::hemisphere
                               ? by_hemispheres(mesh, soup, receivers, options, progress)
                               : by_shadow_rays(mesh, soup, receivers, options, progress);
  const std::vector<double> sums = row_sums(result.F);
  const Contacts contacts(soup);
  for (std::size_t k = 0; k < sums.size(); ++k) {
    if (may_be_covered(soup, contacts, pieces_of(mesh, receivers, k))) {
      ++result.statistics.covered_points;
    } else {
      result.statistics.closure_max_defect = std::max(result.statistics.closure_max_defect, std::fabs(sums[k] - 1));
    }
  }
  return result;
}

}  // namespace exitance
