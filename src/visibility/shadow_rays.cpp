#include "src/visibility/shadow_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "src/visibility/fan_map.h"
#include "src/visibility/seed.h"
#include "src/visibility/weighted_share.h"

namespace exitance {
namespace {

/// Rays worked on together.
constexpr std::size_t kBatch = 64;

/// One end moved off its surface and the other, and what the ray between them counts.
struct WeightedRay {
  Vec3 from, to;
  double weight;
};

struct Batch {
  std::size_t count = 0;
  std::array<Vec3, kBatch> from, to;
  std::array<double, kBatch> weight;
  std::array<std::uint8_t, kBatch> visible;

  std::span<const Vec3> starts() const { return {from.data(), count}; }
  std::span<const Vec3> ends() const { return {to.data(), count}; }
  std::span<std::uint8_t> arrivals() { return {visible.data(), count}; }
};

/// The corners of a source relative to a point.
ConvexLoop corners_from(const PolygonSoup& soup, const Source& source, const Vec3& origin) {
  ConvexLoop loop;
  if (source.loop.empty()) {
    for (const Corner& c : soup.corners(soup.facets()[source.facet])) loop.push_back(c.at - origin);
  } else {
    for (const Vec3& v : source.loop) loop.push_back(v - origin);
  }
  return loop;
}

/// The part of a source above the horizon, relative to the point of view, clockwise or counter-clockwise.
ConvexLoop above_horizon(const Receiver& receiver, const PolygonSoup& soup, const Source& source) {
  return part_above(receiver.normal, corners_from(soup, source, receiver.point));
}

/// By how much the ends of a question's rays are moved off their surfaces.
struct Shift {
  Vec3 of_start, of_end;
};

Shift shift_of(const Receiver& receiver, const Plane& plane, double offset) {
  const double side = dot(plane.normal, receiver.point - plane.origin) >= 0 ? 1 : -1;
  return {offset * normalized(receiver.normal), side * offset * normalized(plane.normal)};
}

Vec3 normal_of(const ConvexLoop& loop) {
  Vec3 sum;
  for (std::size_t k = 2; k < loop.size(); ++k) sum = sum + cross(loop[k - 1] - loop[0], loop[k] - loop[0]);
  return normalized(sum);
}

/// One ray, all or nothing.
SampledFormFactor by_one_ray(double unoccluded, bool arrives) {
  return {.F = arrives ? unoccluded : 0,
          .standard_error = std::numeric_limits<double>::infinity(),
          .F_unoccluded = unoccluded,
          .rays = 1,
          .arrived = arrives};
}

}  // namespace

std::uint64_t& SampledFormFactor::count_in(PairCounts& pairs) const {
  if (F_unoccluded == 0) return pairs.facing_away;
  return arrived == rays ? pairs.open : arrived == 0 ? pairs.blocked : pairs.partial;
}

void SampledSum::add(const SampledFormFactor& f, double times) {
  sum_.F += times * f.F;
  sum_.F_unoccluded += times * f.F_unoccluded;
  sum_.rays += f.rays;
  sum_.arrived += f.arrived;
  variance_ += times * f.standard_error * times * f.standard_error;
}

SampledFormFactor SampledSum::value() const {
  SampledFormFactor sum = sum_;
  sum.standard_error = std::sqrt(variance_);
  return sum;
}

ShadowRays::ShadowRays(const PolygonSoup& soup, const RayOptions& options)
    : soup_(&soup),
      options_((check(options), options)),
      on_source_(options.sampler, options.rays),
      on_both_(options.sampler, options.rays),
      caster_(soup, options) {
  if (options.estimator == Estimator::hemisphere)
    throw std::invalid_argument("rays of a hemisphere are not cast to one source");
  if (options.contacts) contacts_.emplace(soup);
}

bool ShadowRays::covered(const Receiver& receiver) const {
  return contacts_ && receiver.facet != kNone && contacts_->covered(receiver.facet, receiver.point);
}

ShadowRays::Rays ShadowRays::shadow_rays(const Receiver& receiver, const Source& source, std::uint64_t seed) const {
  const ConvexLoop loop = above_horizon(receiver, *soup_, source);
  const Shift shift = shift_of(receiver, soup_->facets()[source.facet].plane, caster_.offset());
  Rays rays{receiver.point + shift.of_start, {}};
  if (loop.size() < 3) return rays;
  const FanMap on_source(loop);
  std::vector<SamplePoints<2>::Point> points(on_source_.size());
  on_source_.take(nth_seed(seed, 0), 0, points);
  const Vec3 to_origin = receiver.point + shift.of_end;
  for (const auto& [u, v] : points) rays.to.push_back(to_origin + on_source(u, v));
  return rays;
}

/// All replicates: ray_of(point) for every sample point, cast(batch) for many of them together.
template <std::size_t D, class RayOf, class Cast>
SampledFormFactor ShadowRays::sample(const SamplePoints<D>& samples, double unoccluded, std::uint64_t seed,
                                     const RayOf& ray_of, const Cast& cast) const {
  std::array<typename SamplePoints<D>::Point, kBatch> points;
  Batch batch;
  WeightedShare share;
  for (std::uint32_t replicate = 0; replicate < options_.replicates; ++replicate) {
    for (std::uint32_t first = 0; first < options_.rays; first += kBatch) {
      batch.count = std::min<std::size_t>(kBatch, options_.rays - first);
      samples.take(nth_seed(seed, replicate), first, {points.data(), batch.count});
      for (std::size_t k = 0; k < batch.count; ++k) {
        const WeightedRay ray = ray_of(points[k]);
        batch.from[k] = ray.from;
        batch.to[k] = ray.to;
        batch.weight[k] = ray.weight;
      }
      cast(batch);
      for (std::size_t k = 0; k < batch.count; ++k) share.add(batch.weight[k], batch.visible[k] != 0);
    }
    share.end_replicate();
  }
  return {.F = unoccluded * share.value(),
          .standard_error = unoccluded * share.standard_error(),
          .F_unoccluded = unoccluded,
          .rays = std::uint64_t{options_.rays} * options_.replicates,
          .arrived = share.arrived()};
}

SampledFormFactor ShadowRays::form_factor(const Receiver& receiver, const Source& source, std::uint64_t seed) const {
  const ConvexLoop loop = above_horizon(receiver, *soup_, source);
  if (loop.size() < 3) return {};
  const FanMap on_source(loop);
  const double unoccluded = std::fabs(lambert(loop, normalized(receiver.normal)));
  if (!(on_source.twice_area() > 0) || unoccluded == 0) return {};
  const Shift shift = shift_of(receiver, soup_->facets()[source.facet].plane, caster_.offset());
  const Vec3 from = receiver.point + shift.of_start, to_origin = receiver.point + shift.of_end;
  const bool may_be_overlaid = contacts_ && contacts_->may_be_overlaid(source.facet);

  const auto cast_all = [&](Batch& batch) {
    cast(from, batch.ends(), batch.arrivals());
    for (std::size_t k = 0; may_be_overlaid && k < batch.count; ++k)
      batch.visible[k] &= !contacts_->overlaid(source.facet, batch.to[k] - shift.of_end);
  };
  if (options_.estimator == Estimator::centre) {
    Batch one;
    one.count = 1;
    one.to[0] = to_origin + on_source.centre();
    cast_all(one);
    return by_one_ray(unoccluded, one.visible[0] != 0);
  }
  return sample(
      on_source_, unoccluded, seed,
      [&](const SamplePoints<2>::Point& at) {
        const Vec3 w = on_source(at[0], at[1]);
        const double r2 = dot(w, w);
        // The source's cosine is its plane's distance, the same for all, over r.
        const double weight =
            options_.estimator == Estimator::kernel ? std::fmax(dot(receiver.normal, w), 0.0) / (r2 * r2) : 1.0;
        return WeightedRay{from, to_origin + w, weight};
      },
      cast_all);
}

SampledFormFactor ShadowRays::exchange(const Source& i, const Source& j, double unoccluded, std::uint64_t seed) const {
  const ConvexLoop loop_i = corners_from(*soup_, i, {}), loop_j = corners_from(*soup_, j, {});
  const Vec3 n_i = normal_of(loop_i), n_j = normal_of(loop_j), origin = loop_i[0];
  const ConvexLoop of_j = part_above(n_i, corners_from(*soup_, j, origin));
  ConvexLoop of_i = part_above(n_j, corners_from(*soup_, i, loop_j[0]));
  for (Vec3& v : of_i) v = v + (loop_j[0] - origin);
  if (of_i.size() < 3 || of_j.size() < 3 || !(unoccluded > 0)) return {};
  const FanMap on_i(of_i), on_j(of_j);
  if (!(on_i.twice_area() > 0 && on_j.twice_area() > 0)) return {};
  const Vec3 off_i = caster_.offset() * n_i, off_j = caster_.offset() * n_j;
  const Vec3 from_origin = origin + off_i, to_origin = origin + off_j;
  const Contacts::Pair contacts = contacts_ ? contacts_->pair(i.facet, j.facet) : Contacts::Pair{};

  const auto cast_all = [&](Batch& batch) {
    caster_.cast(batch.starts(), batch.ends(), batch.arrivals());
    for (std::size_t k = 0; contacts.exist() && k < batch.count; ++k)
      batch.visible[k] &= batch.visible[k] != 0 && !contacts.cover(batch.from[k] - off_i, batch.to[k] - off_j);
  };
  if (options_.estimator == Estimator::centre) {
    Batch one;
    one.count = 1;
    one.from[0] = from_origin + on_i.centre();
    one.to[0] = to_origin + on_j.centre();
    cast_all(one);
    return by_one_ray(unoccluded, one.visible[0] != 0);
  }
  return sample(
      on_both_, unoccluded, seed,
      [&](const SamplePoints<4>::Point& at) {
        const Vec3 x = on_i(at[0], at[1]), y = on_j(at[2], at[3]), w = y - x;
        const double r2 = dot(w, w);
        double weight = 1;
        if (options_.estimator == Estimator::kernel)
          weight = r2 > 0 ? std::fmax(dot(n_i, w), 0.0) * std::fmax(-dot(n_j, w), 0.0) / (r2 * r2) : 0.0;
        return WeightedRay{from_origin + x, to_origin + y, weight};
      },
      cast_all);
}

}  // namespace exitance
