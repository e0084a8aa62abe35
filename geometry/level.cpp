#include "geometry/level.h"

#include <algorithm>
#include <cmath>

#include "geometry/convex_part.h"
#include "geometry/polygon.h"
#include "geometry/spatial_index.h"

namespace exitance {
namespace {

/// Of an area: what rounding lets loops overlap that meet along an edge.
constexpr double kNothing = 0x1p-30;

double extent_of(const Loop& loop) {
  Box box;
  for (const Vec3& v : loop) box.extend(v);
  return loop.empty() ? 0 : norm(box.upper - box.lower);
}

/// Area of what of loop g lies over or under f, if that is nowhere farther from the plane of f; else 0.
double area_flat_on(const Loop& f, const Loop& g, double near) {
  const Vec3 normal = area_vector(f);
  const auto height = [&](const Vec3& v) { return dot(normal, v - f[0]); };
  const double area = norm(normal), limit = near * area, extent = extent_of(f);
  // A narrow loop is turned by the rounding of its coordinates over its width, at least area by length.
  const double farthest = limit * extent * (extent + extent_of(g));
  if (std::ranges::any_of(g, [&](const Vec3& v) { return !(std::fabs(height(v)) * area <= farthest); })) return 0;
  const double enough = kNothing * std::min(area, norm(area_vector(g)));
  Loop common = g;
  double of_common = 0;
  for (std::size_t k = 0; k < f.size(); ++k) {
    const Vec3 inward = cross(normal, f[(k + 1) % f.size()] - f[k]);
    common = convex_part(common, [&](const Vec3& v) { return dot(inward, v - f[k]); });
    of_common = norm(area_vector(common));
    if (of_common <= enough) return 0;
  }
  // Of loops that meet along an edge, at any angle, rounding makes overlaps some ulps of their coordinates wide, and
  // there they lie no farther apart: an overlap must be wider than what it is judged by.
  if (of_common <= 2 * near * extent_of(common)) return 0;
  const bool is_flat = std::ranges::all_of(common, [&](const Vec3& v) { return std::fabs(height(v)) <= limit; });
  return is_flat ? of_common : 0;
}

}  // namespace

bool may_be_level(const Vec3& n, const Vec3& m) {
  return std::fabs(dot(n, m)) > 0.5 * norm(n) * norm(m);
}

double level_area(const Loop& f, const Loop& g, double near) {
  if (!may_be_level(area_vector(f), area_vector(g))) return 0;
  return std::max(area_flat_on(f, g, near), area_flat_on(g, f, near));
}

}  // namespace exitance
