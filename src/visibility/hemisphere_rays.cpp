#include "src/visibility/hemisphere_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "src/visibility/fan_map.h"
#include "src/visibility/seed.h"

namespace exitance {
namespace {

/// Directions around a normal.
class Frame {
 public:
  explicit Frame(const Vec3& unit_normal) : n_(unit_normal) {
    const Vec3 off = std::fabs(n_.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    s_ = normalized(cross(n_, off));
    t_ = cross(n_, s_);
  }

  /// Unit vector, as dense as cosθ / π: the unit square mapped to the disc (Shirley and Chiu 1997) below it.
  Vec3 direction(double u, double v) const {
    const double a = 2 * u - 1, b = 2 * v - 1;
    constexpr double kQuarter = std::numbers::pi / 4;
    double r = a, phi = 0;
    if (std::fabs(a) > std::fabs(b)) {
      phi = kQuarter * b / a;
    } else if (b != 0) {
      r = b;
      phi = 2 * kQuarter - kQuarter * a / b;
    }
    const double x = r * std::cos(phi), y = r * std::sin(phi);
    return x * s_ + y * t_ + std::sqrt(std::fmax(1 - x * x - y * y, 0.0)) * n_;
  }

 private:
  Vec3 n_, s_, t_;
};

struct Ray {
  Vec3 from, direction;
};

/// A piece of an element or a patch, for rays that start from it.
struct StartPiece {
  StartPiece(const PatchMesh& mesh, const PolygonSoup& soup, const PatchPiece& piece, double offset)
      : frame(normalized(soup.facets()[piece.facet].plane.normal)),
        facet(piece.facet),
        area(piece.area),
        moved(offset * normalized(soup.facets()[piece.facet].plane.normal)) {
    if (piece.loop_count == 0) {
      for (const Corner& c : soup.corners(soup.facets()[piece.facet])) loop.push_back(c.at);
    } else {
      for (const Vec3& v : mesh.loop(piece)) loop.push_back(v);
    }
  }

  Frame frame;
  ConvexLoop loop;
  std::uint32_t facet;
  double area;
  Vec3 moved;
};

}  // namespace

double HemisphereHits::standard_error(std::uint64_t hits) const {
  const double p = share(hits);
  return std::sqrt(p * (1 - p) / static_cast<double>(rays));
}

HemisphereRays::HemisphereRays(const PatchMesh& mesh, const PolygonSoup& soup, const RayOptions& options)
    : mesh_(mesh),
      soup_(soup),
      replicates_((check(options), options.replicates)),
      directions_(options.sampler, options.rays),
      points_and_directions_(options.sampler, options.rays),
      caster_(mesh, soup, options) {
  if (options.contacts) contacts_.emplace(soup);
}

template <std::size_t D, class RayOf>
HemisphereHits HemisphereRays::count(const SamplePoints<D>& samples, std::uint64_t seed, const RayOf& ray_of) const {
  constexpr std::uint32_t kBatch = 64;
  std::array<typename SamplePoints<D>::Point, kBatch> points;
  std::array<Vec3, kBatch> from, direction;
  std::array<RayHit, kBatch> hits;
  HemisphereHits result;
  result.rays = std::uint64_t{samples.size()} * replicates_;
  std::vector<std::uint32_t> met;
  for (std::uint32_t replicate = 0; replicate < replicates_; ++replicate) {
    for (std::uint32_t first = 0; first < samples.size(); first += kBatch) {
      const std::size_t drawn = std::min(kBatch, samples.size() - first);
      samples.take(nth_seed(seed, replicate), first, {points.data(), drawn});
      std::size_t n = 0;
      for (std::size_t k = 0; k < drawn; ++k) {
        const std::optional<Ray> ray = ray_of(points[k]);
        if (!ray) continue;
        from[n] = ray->from;
        direction[n++] = ray->direction;
      }
      result.covered += drawn - n;
      caster_.first_hits({from.data(), n}, {direction.data(), n}, {hits.data(), n});
      for (std::size_t k = 0; k < n; ++k) {
        result.missed += hits[k].side == RayHit::Side::none;
        if (hits[k].side == RayHit::Side::front && hits[k].patch != kNone) met.push_back(hits[k].patch);
      }
    }
  }
  std::ranges::sort(met);
  for (const std::uint32_t patch : met) {
    if (result.front.empty() || result.front.back().first != patch) result.front.emplace_back(patch, 0);
    ++result.front.back().second;
  }
  return result;
}

HemisphereHits HemisphereRays::from_point(const Element& element, std::uint64_t seed) const {
  const Frame frame(element.normal);
  const Vec3 from = element.sample + caster_.offset() * element.normal;
  const bool covered = contacts_ && contacts_->covered(element.facet, element.sample);
  return count(directions_, seed, [&](const auto& p) -> std::optional<Ray> {
    if (covered) return {};
    return Ray{from, frame.direction(p[0], p[1])};
  });
}

HemisphereHits HemisphereRays::from_area(std::span<const PatchPiece> pieces, std::uint64_t seed) const {
  std::vector<StartPiece> starts;
  std::vector<FanMap> maps;
  double area = 0;
  for (const PatchPiece& piece : pieces) {
    starts.emplace_back(mesh_, soup_, piece, caster_.offset());
    area += piece.area;
  }
  for (const StartPiece& start : starts) maps.emplace_back(start.loop);
  return count(points_and_directions_, seed, [&](const auto& p) -> std::optional<Ray> {
    // The first coordinate chooses the piece, too.
    std::size_t k = 0;
    double along = p[0] * area;
    while (k + 1 < starts.size() && along > starts[k].area) along -= starts[k++].area;
    const StartPiece& start = starts[k];
    const Vec3 at = maps[k](std::min(along / start.area, 1.0), p[1]);
    if (contacts_ && contacts_->covered(start.facet, at)) return {};
    return Ray{at + start.moved, start.frame.direction(p[2], p[3])};
  });
}

}  // namespace exitance
