#include "src/scene/sample_site.h"

#include <algorithm>
#include <cmath>

#include "geometry/radiator.h"
#include "src/scene/patch_mesh.h"

namespace exitance {
namespace {

/// Corners are off by some 2^-52 of the extent; from this share of it that is below 2^-32 of what is seen.
constexpr double kEnough = 0x1p-20;
/// Of small elements far from the origin: this share of the way to the nearest corner.
constexpr double kEnoughOfElement = 1.0 / 64;
/// Ways from the centroid to the corners, no simple fractions: lines through the one seldom meet the others.
constexpr double kWays[] = {0.21, 0.34};
/// Sine of an angle that rounding gives surfaces modelled in one plane.
constexpr double kParallel = 0x1p-26;

}  // namespace

Vec3 centroid(std::span<const Vec3> loop) {
  Vec3 moment;
  double area = 0;
  for (std::size_t i = 2; i < loop.size(); ++i) {
    const double weight = doubled_area(loop[0], loop[i - 1], loop[i]);
    moment = moment + weight * ((loop[i - 1] - loop[0]) + (loop[i] - loop[0]));
    area += weight;
  }
  return loop[0] + (1 / (3 * area)) * moment;
}

Vec3 SampleSite::choose(std::uint32_t facet, std::span<const Vec3> loop) {
  const Vec3 middle = centroid(loop);
  double enough = reach();
  for (const Vec3& corner : loop) enough = std::min(enough, kEnoughOfElement * norm(corner - middle));
  Vec3 best = middle;
  double farthest = clearance(middle, facet, enough);
  for (const double way : kWays) {
    for (const Vec3& corner : loop) {
      if (farthest >= enough) return best;
      const Vec3 p = middle + way * (corner - middle);
      const double distance = clearance(p, facet, enough);
      if (distance > farthest) {
        farthest = distance;
        best = p;
      }
    }
  }
  return best;
}

Vec3 SampleSite::choose(const PatchMesh& mesh, const Element& element) {
  const PatchPiece& piece = *std::ranges::max_element(mesh.pieces_of(element), {}, &PatchPiece::area);
  if (piece.loop_count > 0) return choose(piece.facet, mesh.loop(piece));
  loop_.clear();
  for (const Corner& corner : soup_.corners(soup_.facets()[piece.facet])) loop_.push_back(corner.at);
  return choose(piece.facet, loop_);
}

double SampleSite::reach() const {
  return kEnough * soup_.extent();
}

/// Distance to the nearest hindrance, at most `enough`.
double SampleSite::clearance(const Vec3& p, std::uint32_t facet, double enough) {
  Box box;
  box.extend(p - Vec3{enough, enough, enough});
  box.extend(p + Vec3{enough, enough, enough});
  found_.clear();
  soup_.index().find(box, found_);
  const auto facets = soup_.facets();
  const Facet& own = facets[facet];
  double nearest = enough;
  for (const std::uint32_t item : found_) {
    if (item < facets.size()) {
      nearest = std::min(nearest, clearance_of(p, facets[item], own, enough));
      continue;
    }
    for (const std::uint32_t f : soup_.shells()[item - facets.size()].facets)
      nearest = std::min(nearest, clearance_of(p, facets[f], own, enough));
  }
  return nearest;
}

/// In roundings' accuracy, as no answer depends on it.
double SampleSite::clearance_of(const Vec3& p, const Facet& other, const Facet& own, double enough) const {
  if (other.polygon == own.polygon) return enough;
  const Vec3& normal = other.plane.normal;
  const double size = norm(normal);
  if (!(size > 0)) return enough;
  const double above = std::fabs(dot(normal, p - other.plane.origin)) / size;
  if (above >= enough) return enough;
  const auto corners = soup_.corners(other);
  double inside = enough, outside = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 &a = corners[k].at, &b = corners[(k + 1) % corners.size()].at;
    const double length = norm(b - a);
    if (!(length > 0)) continue;
    const double left = dot(cross(b - a, p - a), normal) / (length * size);
    inside = std::min(inside, left);
    outside = std::max(outside, -left);
  }
  if (outside > 0) return std::min(enough, std::hypot(above, outside));
  const bool parallel = norm(cross(normal, own.plane.normal)) <= kParallel * size * norm(own.plane.normal);
  return parallel ? std::min(enough, std::hypot(above, inside)) : above;
}

}  // namespace exitance
