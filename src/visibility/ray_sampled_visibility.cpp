#include "src/visibility/ray_sampled_visibility.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "src/visibility/hemisphere_rays.h"
#include "src/visibility/seed.h"
#include "src/visibility/shadow_rays.h"

namespace exitance {
namespace {

class ShadowRayObserver final : public Observer {
 public:
  ShadowRayObserver(const PatchMesh& mesh, const PolygonSoup& soup, const ShadowRays& rays)
      : mesh_(mesh), soup_(soup), rays_(rays) {}

  PointRow row(std::size_t element) override {
    PointRow row;
    if (is_covered(element)) {
      row.statistics.covered_points = 1;
      return row;
    }
    double sum = 0;
    for (std::uint32_t p = 0; p < mesh_.patches.size(); ++p) {
      const SampledFormFactor f = to_patch(element, p);
      ++f.count_in(row.statistics.pairs);
      if (f.F_unoccluded == 0) continue;
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
    if (is_covered(element)) return {};
    const SampledFormFactor f = to_patch(element, static_cast<std::uint32_t>(patch));
    return {.F = f.F, .error = f.F_unoccluded > 0 ? kBoundOfAny : 0, .side = Side::front};
  }

 private:
  Receiver receiver(std::size_t element) const {
    const Element& e = mesh_.elements[element];
    return {e.sample, e.normal, e.facet};
  }
  bool is_covered(std::size_t element) const { return rays_.covered(receiver(element)); }

  /// The sum of the patch's pieces that turn their front to the sample point.
  SampledFormFactor to_patch(std::size_t element, std::uint32_t patch) const {
    const Element& e = mesh_.elements[element];
    SampledSum sum;
    std::uint64_t seed = question_seed(rays_.options().seed, element, patch);
    for (const PatchPiece& piece : mesh_.pieces_of(mesh_.patches[patch])) {
      seed = mixed(seed);
      const Plane& plane = soup_.facets()[piece.facet].plane;
      if (piece.facet == e.facet || !(dot(plane.normal, e.sample - plane.origin) > 0)) continue;
      sum.add(rays_.form_factor(receiver(element), {piece.facet, mesh_.loop(piece)}, seed));
    }
    return sum.value();
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
    row.statistics.rays = hits.rays - hits.covered;
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

}  // namespace exitance
