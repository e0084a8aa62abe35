#include "geometry/level.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/convex_part.h"
#include "geometry/near_pairs.h"
#include "geometry/polygon.h"

namespace exitance {
namespace {

/// Of an area: what rounding lets facets overlap that meet along an edge.
constexpr double kNothing = 0x1p-30;

using Loop = std::vector<Vec3>;

Loop loop_of(std::span<const Corner> corners) {
  Loop loop;
  for (const Corner& c : corners) loop.push_back(c.at);
  return loop;
}

/// Whether all corners lie more than `limit` before a plane, or all more than that behind it.
bool is_clear_of(const Loop& loop, const Plane& plane, double limit) {
  bool before = true, behind = true;
  for (const Vec3& v : loop) {
    const double height = dot(plane.normal, v - plane.origin);
    before = before && height > limit;
    behind = behind && height < -limit;
  }
  return before || behind;
}

double extent_of(const Loop& loop) {
  Box box;
  for (const Vec3& v : loop) box.extend(v);
  return loop.empty() ? 0 : norm(box.upper - box.lower);
}

/// Whether what of facet g lies over or under f is nowhere farther from the plane of f.
bool lies_flat_on(const PolygonSoup& soup, std::uint32_t f, std::uint32_t g, double near) {
  const Plane& plane = soup.facets()[f].plane;
  const double limit = near * norm(plane.normal);
  const Loop on = loop_of(soup.corners(soup.facets()[f]));
  Loop common = loop_of(soup.corners(soup.facets()[g]));
  if (is_clear_of(common, plane, limit)) return false;
  const double enough = kNothing * std::min(norm(area_vector(on)), norm(area_vector(common)));
  for (std::size_t k = 0; k < on.size(); ++k) {
    const Vec3 inward = cross(plane.normal, on[(k + 1) % on.size()] - on[k]);
    common = convex_part(common, [&](const Vec3& v) { return dot(inward, v - on[k]); });
    // Of facets that meet along an edge, at any angle, rounding makes overlaps some ulps of their coordinates wide, and
    // there they lie no farther apart: an overlap must be wider than what it is judged by.
    if (norm(area_vector(common)) <= std::max(enough, 2 * near * extent_of(common))) return false;
  }
  return std::ranges::all_of(common,
                             [&](const Vec3& v) { return std::fabs(dot(plane.normal, v - plane.origin)) <= limit; });
}

}  // namespace

bool are_level(const PolygonSoup& soup, std::uint32_t f, std::uint32_t g, double near) {
  const Vec3 &n = soup.facets()[f].plane.normal, &m = soup.facets()[g].plane.normal;
  if (!(std::fabs(dot(n, m)) > 0.5 * norm(n) * norm(m))) return false;
  return lies_flat_on(soup, f, g, near) || lies_flat_on(soup, g, f, near);
}

bool any_are_level(const PolygonSoup& soup, double near) {
  const auto facets = soup.facets();
  std::vector<std::uint32_t> present;
  std::vector<Box> boxes;
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    if (!soup.is_present(f)) continue;
    Box box;
    for (const Corner& c : soup.corners(facets[f])) box.extend(c.at);
    present.push_back(f);
    boxes.push_back({box.lower - Vec3{near, near, near}, box.upper + Vec3{near, near, near}});
  }
  bool any = false;
  for_each_near_pair(boxes, [&](std::uint32_t i, std::uint32_t j) {
    const std::uint32_t f = present[i], g = present[j];
    any = any || (facets[f].polygon != facets[g].polygon && are_level(soup, f, g, near));
  });
  return any;
}

}  // namespace exitance
