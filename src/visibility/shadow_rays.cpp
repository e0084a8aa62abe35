#include "src/visibility/shadow_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "src/visibility/fan_map.h"
#include "src/visibility/weighted_share.h"

namespace exitance {
namespace {

/// Rays worked on together.
constexpr std::uint32_t kBatch = 64;

/// The part of a source above the horizon, relative to the point of view, clockwise or counter-clockwise.
ConvexLoop above_horizon(const Receiver& receiver, const PolygonSoup& soup, const Source& source) {
  ConvexLoop whole;
  if (source.loop.empty()) {
    for (const Corner& c : soup.corners(soup.facets()[source.facet])) whole.push_back(c.at - receiver.point);
  } else {
    for (const Vec3& v : source.loop) whole.push_back(v - receiver.point);
  }
  return part_above(receiver.normal, whole);
}

/// Lambert's form factor of a loop relative to the point of view, above the horizon (its sign: which way it runs).
double lambert(const ConvexLoop& loop, const Vec3& unit_normal) {
  double sum = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 &p = loop[k], &q = loop[(k + 1) % loop.size()];
    const Vec3 c = cross(p, q);
    const double s = norm(c);
    if (s > 0) sum += std::atan2(s, dot(p, q)) * dot(unit_normal, c) / s;
  }
  return sum / (2 * std::numbers::pi);
}

/// Both ends of a question, moved off their surfaces.
struct Ends {
  Vec3 from;
  Vec3 to_origin;  ///< add a point of the loop to get a ray's target
};

Ends moved_ends(const Receiver& receiver, const Plane& plane, double offset) {
  const double side = dot(plane.normal, receiver.point - plane.origin) >= 0 ? 1 : -1;
  return {receiver.point + offset * normalized(receiver.normal),
          receiver.point + side * offset * normalized(plane.normal)};
}

std::uint64_t seed_of(std::uint64_t seed, std::uint32_t replicate) {
  return seed + replicate * 0xd1342543de82ef95u;
}

/// Twice the area times the normal.
Vec3 area_vector(std::span<const Vec3> loop) {
  Vec3 sum;
  for (std::size_t k = 2; k < loop.size(); ++k) sum = sum + cross(loop[k - 1] - loop[0], loop[k] - loop[0]);
  return sum;
}

/// What of a loop lies in front of a plane through `origin`, relative to it.
ConvexLoop in_front(std::span<const Vec3> loop, const Vec3& origin, const Vec3& normal) {
  ConvexLoop relative;
  for (const Vec3& v : loop) relative.push_back(v - origin);
  return part_above(normal, relative);
}

}  // namespace

ShadowRays::ShadowRays(const PolygonSoup& soup, const RayOptions& options)
    : soup_(&soup),
      options_((check(options), options)),
      on_source_(options.sampler, options.rays),
      on_both_(options.sampler, options.rays),
      caster_(soup, options) {
  if (options.estimator == Estimator::hemisphere)
    throw std::invalid_argument("rays of a hemisphere are not cast to one source");
}

ShadowRays::Rays ShadowRays::shadow_rays(const Receiver& receiver, const Source& source, std::uint64_t seed) const {
  const ConvexLoop loop = above_horizon(receiver, *soup_, source);
  const Ends ends = moved_ends(receiver, soup_->facets()[source.facet].plane, caster_.offset());
  Rays rays{ends.from, {}};
  if (loop.size() < 3) return rays;
  const FanMap on_source(loop);
  std::vector<SamplePoints<2>::Point> points(on_source_.size());
  on_source_.take(seed_of(seed, 0), 0, points);
  for (const auto& [u, v] : points) rays.to.push_back(ends.to_origin + on_source(u, v));
  return rays;
}

SampledFormFactor ShadowRays::form_factor(const Receiver& receiver, const Source& source, std::uint64_t seed) const {
  const ConvexLoop loop = above_horizon(receiver, *soup_, source);
  if (loop.size() < 3) return {};
  const FanMap on_source(loop);
  SampledFormFactor result{.F_unoccluded = std::fabs(lambert(loop, normalized(receiver.normal)))};
  if (!(on_source.twice_area() > 0) || result.F_unoccluded == 0) return {};
  const Ends ends = moved_ends(receiver, soup_->facets()[source.facet].plane, caster_.offset());

  std::array<Vec3, kBatch> to;
  std::array<std::uint8_t, kBatch> visible;
  if (options_.estimator == Estimator::centre) {
    to[0] = ends.to_origin + on_source.centre();
    cast(ends.from, {to.data(), 1}, {visible.data(), 1});
    result.F = visible[0] * result.F_unoccluded;
    result.standard_error = std::numeric_limits<double>::infinity();
    result.rays = 1;
    result.arrived = visible[0];
    return result;
  }

  std::array<SamplePoints<2>::Point, kBatch> points;
  std::array<double, kBatch> weight;
  WeightedShare share;
  for (std::uint32_t replicate = 0; replicate < options_.replicates; ++replicate) {
    for (std::uint32_t first = 0; first < options_.rays; first += kBatch) {
      const std::size_t count = std::min(kBatch, options_.rays - first);
      on_source_.take(seed_of(seed, replicate), first, {points.data(), count});
      for (std::size_t k = 0; k < count; ++k) {
        const Vec3 w = on_source(points[k][0], points[k][1]);
        const double r2 = dot(w, w);
        // The source's cosine is its plane's distance, the same for all, over r.
        weight[k] = options_.estimator == Estimator::kernel ? std::fmax(dot(receiver.normal, w), 0.0) / (r2 * r2) : 1.0;
        to[k] = ends.to_origin + w;
      }
      cast(ends.from, {to.data(), count}, {visible.data(), count});
      for (std::size_t k = 0; k < count; ++k) share.add(weight[k], visible[k] != 0);
    }
    share.end_replicate();
  }
  result.F = result.F_unoccluded * share.value();
  result.standard_error = result.F_unoccluded * share.standard_error();
  result.rays = std::uint64_t{options_.rays} * options_.replicates;
  result.arrived = share.arrived();
  return result;
}

SampledFormFactor ShadowRays::exchange(std::span<const Vec3> loop_i, std::span<const Vec3> loop_j, double unoccluded,
                                       std::uint64_t seed) const {
  const Vec3 n_i = normalized(area_vector(loop_i)), n_j = normalized(area_vector(loop_j)), origin = loop_i[0];
  const ConvexLoop of_j = in_front(loop_j, origin, n_i);
  ConvexLoop of_i = in_front(loop_i, loop_j[0], n_j);
  for (Vec3& v : of_i) v = v + (loop_j[0] - origin);
  SampledFormFactor result{.F_unoccluded = unoccluded};
  if (of_i.size() < 3 || of_j.size() < 3 || !(unoccluded > 0)) return {};
  const FanMap on_i(of_i), on_j(of_j);
  if (!(on_i.twice_area() > 0 && on_j.twice_area() > 0)) return {};
  const Vec3 from_origin = origin + caster_.offset() * n_i, to_origin = origin + caster_.offset() * n_j;

  std::array<Vec3, kBatch> from, to;
  std::array<std::uint8_t, kBatch> visible;
  if (options_.estimator == Estimator::centre) {
    from[0] = from_origin + on_i.centre();
    to[0] = to_origin + on_j.centre();
    caster_.cast({from.data(), 1}, {to.data(), 1}, {visible.data(), 1});
    result.F = visible[0] * unoccluded;
    result.standard_error = std::numeric_limits<double>::infinity();
    result.rays = 1;
    result.arrived = visible[0];
    return result;
  }

  std::array<SamplePoints<4>::Point, kBatch> points;
  std::array<double, kBatch> weight;
  WeightedShare share;
  for (std::uint32_t replicate = 0; replicate < options_.replicates; ++replicate) {
    for (std::uint32_t first = 0; first < options_.rays; first += kBatch) {
      const std::size_t count = std::min(kBatch, options_.rays - first);
      on_both_.take(seed_of(seed, replicate), first, {points.data(), count});
      for (std::size_t k = 0; k < count; ++k) {
        const Vec3 x = on_i(points[k][0], points[k][1]), y = on_j(points[k][2], points[k][3]), w = y - x;
        const double r2 = dot(w, w);
        weight[k] = 1;
        if (options_.estimator == Estimator::kernel)
          weight[k] = r2 > 0 ? std::fmax(dot(n_i, w), 0.0) * std::fmax(-dot(n_j, w), 0.0) / (r2 * r2) : 0.0;
        from[k] = from_origin + x;
        to[k] = to_origin + y;
      }
      caster_.cast({from.data(), count}, {to.data(), count}, {visible.data(), count});
      for (std::size_t k = 0; k < count; ++k) share.add(weight[k], visible[k] != 0);
    }
    share.end_replicate();
  }
  result.F = unoccluded * share.value();
  result.standard_error = unoccluded * share.standard_error();
  result.rays = std::uint64_t{options_.rays} * options_.replicates;
  result.arrived = share.arrived();
  return result;
}

}  // namespace exitance
