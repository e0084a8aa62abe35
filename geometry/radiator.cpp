#include "geometry/radiator.h"

#include <algorithm>
#include <cmath>

#include "geometry/projection.h"

namespace exitance {
namespace {

/// (b − a) × (c − a), with a relative error of 2^-49 in length and direction.
Vec3 accurate_cross(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 p = b - a, q = c - a;
  const Vec3 product = cross(p, q);
  const double length = norm(product);
  // Each component is a difference of two products, four roundings on each: 5 u |p||q| in length at most.
  if (5 * kRoundoff * norm(p) * norm(q) <= 0x1p-50 * length) return product;
  return exact_cross(a, b, c);
}

RadiatorFacet facet_of(const Loop& given) {
  RadiatorFacet f;
  f.loop = without_repeats(given);
  const auto n = static_cast<std::uint32_t>(f.loop.size());
  double largest = 0;
  Vec3 low = f.loop.front(), high = low;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3& v = f.loop[i];
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], v[axis]);
      high[axis] = std::max(high[axis], v[axis]);
    }
    if (i < 1 || i + 1 >= n) continue;
    const Vec3 doubled = accurate_cross(f.loop[0], v, f.loop[i + 1]);
    const double length = norm(doubled);
    f.area += 0.5 * length;
    if (length > largest) {
      largest = length;
      f.spanning = {0, i, i + 1};
      f.normal = (1 / length) * doubled;
    }
  }
  f.centre = low + 0.5 * (high - low);
  for (const Vec3& v : f.loop) f.radius = std::max(f.radius, norm(v - f.centre));
  return f;
}

}  // namespace

double doubled_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return norm(accurate_cross(a, b, c));
}

Radiator::Radiator(const Polygon& polygon) : Radiator(cut_into_facets(polygon)) {}

Radiator::Radiator(std::span<const Loop> facets) {
  for (const Loop& loop : facets) {
    RadiatorFacet facet = facet_of(loop);
    if (!(facet.area > 0)) continue;
    area_ += facet.area;
    facets_.push_back(std::move(facet));
  }
}

}  // namespace exitance
