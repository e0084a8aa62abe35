#include "geometry/contact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "geometry/facets.h"
#include "geometry/level.h"
#include "geometry/near_pairs.h"
#include "geometry/predicates.h"
#include "geometry/projection.h"

namespace exitance {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_rational;

struct FlatFacet {
  Loop loop;
  std::uint32_t polygon = 0;
  Projection projection;  // its own
};

Kernel::Point_3 point(const Vec3& p) {
  return {p.x, p.y, p.z};
}

std::vector<FlatFacet> make_facets(std::span<const Polygon> polygons) {
  std::vector<FlatFacet> facets;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    for (Loop& loop : cut_into_facets(polygons[i])) {
      const auto projection = largest_projection(loop);
      if (projection) facets.push_back({std::move(loop), static_cast<std::uint32_t>(i), *projection});
    }
  }
  return facets;
}

std::vector<Box> make_boxes(const std::vector<FlatFacet>& facets) {
  std::vector<Box> boxes(facets.size());
  for (std::size_t i = 0; i < facets.size(); ++i) {
    for (const Vec3& p : facets[i].loop) boxes[i].extend(p);
  }
  return boxes;
}

// Most planes in architecture are perpendicular to an axis: then one comparison a vertex is enough.
bool lies_at(const Loop& loop, int axis, double value) {
  return std::ranges::all_of(loop, [&](const Vec3& p) { return p[axis] == value; });
}

// Three corners that turn in the projection; collinear ones define no plane.
std::array<Vec3, 3> spanning_corners(const FlatFacet& f) {
  std::size_t k = 0;
  const std::size_t n = f.loop.size();
  while (turn(f.projection, f.loop[k], f.loop[(k + 1) % n], f.loop[(k + 2) % n]) == 0) ++k;
  return {f.loop[k], f.loop[(k + 1) % n], f.loop[(k + 2) % n]};
}

bool in_one_plane(const FlatFacet& f, const FlatFacet& g) {
  const int axis = f.projection.axis;
  const double level = f.loop[0][axis];
  if (lies_at(f.loop, axis, level)) return lies_at(g.loop, axis, level);
  const auto corners = spanning_corners(f);
  const auto a = point(corners[0]), b = point(corners[1]), c = point(corners[2]);
  return std::ranges::all_of(g.loop,
                             [&](const Vec3& p) { return CGAL::orientation(a, b, c, point(p)) == CGAL::COPLANAR; });
}

// Area in the plane by area in the projection. Of needles a rounded normal would have no digit left.
double stretch(const FlatFacet& f) {
  const auto [a, b, c] = spanning_corners(f);
  const Vec3 normal = exact_cross(a, b, c);
  return norm(normal) / std::fabs(normal[f.projection.axis]);
}

// +1 when a convex loop runs counter-clockwise in the projection, −1 when clockwise.
int rotation_sense(Projection projection, const Loop& loop) {
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const int side = turn(projection, loop[k], loop[(k + 1) % loop.size()], loop[(k + 2) % loop.size()]);
    if (side != 0) return side;
  }
  return 0;
}

// Whether no point of `other` lies on the inner side of some edge of `loop`. For convex loops in one plane this, one
// way or the other, is the same as having no area in common.
bool separated_by_edge(Projection projection, const Loop& loop, int sense, const Loop& other) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& a = loop[i];
    const Vec3& b = loop[(i + 1) % loop.size()];
    if (a == b) continue;
    const auto outside = [&](const Vec3& p) { return p == a || p == b || turn(projection, a, b, p) * sense <= 0; };
    if (std::ranges::all_of(other, outside)) return true;
  }
  return false;
}

struct ExactPoint {
  Exact u, v;
};

Exact twice_area(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

std::vector<ExactPoint> flatten(Projection projection, const Loop& loop, int sense) {
  std::vector<ExactPoint> flat;
  flat.reserve(loop.size());
  for (const Vec3& p : loop) flat.push_back({Exact(projection.u(p)), Exact(projection.v(p))});
  if (sense < 0) std::ranges::reverse(flat);
  return flat;
}

// Sutherland and Hodgman (1974), one half-plane: what lies left of a → b.
std::vector<ExactPoint> clip(const std::vector<ExactPoint>& loop, const ExactPoint& a, const ExactPoint& b) {
  std::vector<ExactPoint> kept;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const ExactPoint& p = loop[i];
    const ExactPoint& q = loop[(i + 1) % loop.size()];
    const Exact p_side = twice_area(a, b, p), q_side = twice_area(a, b, q);
    if (p_side >= 0) kept.push_back(p);
    if ((p_side > 0 && q_side < 0) || (p_side < 0 && q_side > 0)) {
      const Exact t = p_side / (p_side - q_side);
      kept.push_back({p.u + t * (q.u - p.u), p.v + t * (q.v - p.v)});
    }
  }
  return kept;
}

// Area in the projection, of convex loops.
double overlap_in_projection(Projection projection, const Loop& f, int f_sense, const Loop& g, int g_sense) {
  std::vector<ExactPoint> common = flatten(projection, f, f_sense);
  const std::vector<ExactPoint> window = flatten(projection, g, g_sense);
  for (std::size_t i = 0; i < window.size(); ++i) common = clip(common, window[i], window[(i + 1) % window.size()]);
  Exact twice = 0;
  for (std::size_t i = 2; i < common.size(); ++i) twice += twice_area(common[0], common[i - 1], common[i]);
  return CGAL::to_double(twice) / 2;
}

struct Overlap {
  double area;
  bool same_facing;
};

// Of facets in exactly one plane.
std::optional<Overlap> overlap_in_plane(const FlatFacet& f, const FlatFacet& g) {
  const int f_sense = rotation_sense(f.projection, f.loop), g_sense = rotation_sense(f.projection, g.loop);
  if (separated_by_edge(f.projection, f.loop, f_sense, g.loop) ||
      separated_by_edge(f.projection, g.loop, g_sense, f.loop)) {
    return std::nullopt;
  }
  return Overlap{stretch(f) * overlap_in_projection(f.projection, f.loop, f_sense, g.loop, g_sense),
                 f_sense == g_sense};
}

// Of others.
std::optional<Overlap> overlap_near_plane(const FlatFacet& f, const FlatFacet& g, double near) {
  const double area = near > 0 ? level_area(f.loop, g.loop, near) : 0;
  if (!(area > 0)) return std::nullopt;
  return Overlap{area, dot(area_vector(f.loop), area_vector(g.loop)) > 0};
}

}  // namespace

std::vector<CoplanarOverlap> coplanar_overlaps(std::span<const Polygon> polygons, double near) {
  const std::vector<FlatFacet> facets = make_facets(polygons);
  std::vector<Box> boxes = make_boxes(facets);
  for (Box& box : boxes) box = box.grown(0.5 * near);

  // Areas by facets first: pairs come in no fixed order, and sums of doubles depend on it.
  struct Part {
    std::uint32_t f, g;
    double area;
    auto order() const { return std::pair{f, g}; }
  };
  std::map<std::tuple<std::uint32_t, std::uint32_t, bool>, std::vector<Part>> found;
  for_each_near_pair(boxes, [&](std::uint32_t i, std::uint32_t j) {
    const FlatFacet &f = facets[i], &g = facets[j];
    if (f.polygon == g.polygon) return;
    const auto overlap = in_one_plane(f, g) ? overlap_in_plane(f, g) : overlap_near_plane(f, g, near);
    if (overlap) found[{f.polygon, g.polygon, overlap->same_facing}].push_back({i, j, overlap->area});
  });

  std::vector<CoplanarOverlap> overlaps;
  for (auto& [key, parts] : found) {
    std::ranges::sort(parts, {}, &Part::order);
    double area = 0;
    for (const Part& part : parts) area += part.area;
    overlaps.push_back({std::get<0>(key), std::get<1>(key), area, std::get<2>(key)});
  }
  return overlaps;
}

}  // namespace exitance
