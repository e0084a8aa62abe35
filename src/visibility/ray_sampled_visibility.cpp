#include "src/visibility/ray_sampled_visibility.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "src/visibility/hemisphere_rays.h"
#include "src/visibility/shadow_rays.h"

namespace exitance {
namespace {

/// No form factor is off by more.
constexpr double kBoundOfAny = 1;

class ShadowRayObserver final : public Observer {
 public:
  ShadowRayObserver(const PatchMesh& mesh, const PolygonSoup& soup, const ShadowRays& rays)
      : mesh_(mesh), soup_(soup), rays_(rays) {}

  PointRow row(std::size_t element) override {
    PointRow row;
    double sum = 0;
    for (std::uint32_t p = 0; p < mesh_.patches.size(); ++p) {
      const SampledFormFactor f = to_patch(element, p);
      if (f.F_unoccluded == 0) {
        ++row.statistics.pairs.facing_away;
        continue;
      }
      std::uint64_t& kind = f.arrived == f.rays ? row.statistics.pairs.open
                            : f.arrived == 0    ? row.statistics.pairs.blocked
                                                : row.statistics.pairs.partial;
      ++kind;
      row.statistics.rays += f.rays;
      if (std::isfinite(f.standard_error)) {
        ++row.statistics.sampled;
        row.statistics.standard_error_sum += f.standard_error;
      }
      sum += f.F;
      row.column.push_back(p);
      row.F.push_back(f.F);
      row.F_error.push_back(kBoundOfAny);
    }
    if (sum == 0) {
      row.statistics.covered_points = 1;
    } else {
      row.statistics.closure_max_defect = std::fabs(sum - 1);
    }
    return row;
  }

  PointFormFactor entry(std::size_t element, std::size_t patch) override {
    const SampledFormFactor f = to_patch(element, static_cast<std::uint32_t>(patch));
    return {.F = f.F, .error = f.F_unoccluded > 0 ? kBoundOfAny : 0, .side = Side::front};
  }

 private:
  /// The sum of the patch's pieces that turn their front to the sample point.
  SampledFormFactor to_patch(std::size_t element, std::uint32_t patch) const {
    const Element& e = mesh_.elements[element];
    SampledFormFactor sum;
    double variance = 0;
    std::uint64_t seed = question_seed(rays_.options().seed, element, patch);
    for (const PatchPiece& piece : mesh_.pieces_of(mesh_.patches[patch])) {
      seed = mixed(seed);
      const Plane& plane = soup_.facets()[piece.facet].plane;
      if (piece.facet == e.facet || !(dot(plane.normal, e.sample - plane.origin) > 0)) continue;
      const SampledFormFactor f =
          rays_.form_factor({e.sample, e.normal, e.facet}, {piece.facet, mesh_.loop(piece)}, seed);
      sum.F += f.F;
      sum.F_unoccluded += f.F_unoccluded;
      sum.rays += f.rays;
      sum.arrived += f.arrived;
      variance += f.standard_error * f.standard_error;
    }
    sum.standard_error = std::sqrt(variance);
    return sum;
  }

  const PatchMesh& mesh_;
  const PolygonSoup& soup_;
  const ShadowRays& rays_;
};

class HemisphereObserver final : public Observer {
 public:
  HemisphereObserver(const PatchMesh& mesh, const HemisphereRays& rays, std::uint64_t seed)
      : mesh_(mesh), rays_(rays), seed_(seed) {}

  PointRow row(std::size_t element) override {
    const HemisphereHits hits = look_from(element);
    PointRow row;
    for (const auto& [patch, count] : hits.front) {
      row.column.push_back(patch);
      row.F.push_back(hits.share(count));
      row.F_error.push_back(kBoundOfAny);
      row.statistics.standard_error_sum += hits.standard_error(count);
    }
    row.statistics.rays = hits.rays;
    row.statistics.sampled = row.statistics.pairs.partial = hits.front.size();
    row.statistics.pairs.facing_away = mesh_.patches.size() - hits.front.size();
    if (hits.front.empty()) {
      row.statistics.covered_points = 1;
    } else {
      row.statistics.closure_max_defect = hits.share(hits.missed);
    }
    return row;
  }

  PointFormFactor entry(std::size_t element, std::size_t patch) override {
    const HemisphereHits hits = look_from(element);
    for (const auto& [met, count] : hits.front) {
      if (met == patch) return {.F = hits.share(count), .error = kBoundOfAny, .side = Side::front};
    }
    return {};
  }

 private:
  HemisphereHits look_from(std::size_t element) const {
    return rays_.from_point(mesh_.elements[element], question_seed(seed_, element, 0));
  }

  const PatchMesh& mesh_;
  const HemisphereRays& rays_;
  std::uint64_t seed_;
};

}  // namespace

struct RaySampledVisibility::Rays {
  std::optional<ShadowRays> shadow;
  std::optional<HemisphereRays> hemisphere;
  std::uint64_t seed = 0;
};

RaySampledVisibility::RaySampledVisibility(const PatchMesh& mesh, const PolygonSoup& soup, const RayOptions& options)
    : mesh_(mesh), soup_(soup), rays_(std::make_unique<Rays>()) {
  rays_->seed = options.seed;
  if (options.estimator == Estimator::hemisphere) {
    rays_->hemisphere.emplace(mesh, soup, options);
  } else {
    rays_->shadow.emplace(soup, options);
  }
}

RaySampledVisibility::~RaySampledVisibility() = default;

std::unique_ptr<Observer> RaySampledVisibility::observer() const {
  if (rays_->hemisphere) return std::make_unique<HemisphereObserver>(mesh_, *rays_->hemisphere, rays_->seed);
  return std::make_unique<ShadowRayObserver>(mesh_, soup_, *rays_->shadow);
}

std::uint64_t question_seed(std::uint64_t seed, std::uint64_t receiver, std::uint64_t source) {
  return mixed(mixed(mixed(seed) ^ receiver) ^ source);
}

}  // namespace exitance
