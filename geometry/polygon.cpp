#include "geometry/polygon.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <CGAL/intersections.h>

#include <algorithm>

#include "geometry/projection.h"

namespace exitance {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using FlatLoop = std::vector<Kernel::Point_2>;

FlatLoop flatten(Projection projection, const std::vector<Vec3>& loop) {
  FlatLoop flat;
  flat.reserve(loop.size());
  for (const Vec3& p : loop) flat.emplace_back(projection.u(p), projection.v(p));
  return flat;
}

/// Four turns the same way go round once, so they need no sweep. (Five may be a pentagram.)
bool is_strictly_convex_quadrilateral(Projection projection, const std::vector<Vec3>& loop) {
  if (loop.size() != 4) return false;
  const int first = turn(projection, loop[0], loop[1], loop[2]);
  return first != 0 && turn(projection, loop[1], loop[2], loop[3]) == first &&
         turn(projection, loop[2], loop[3], loop[0]) == first && turn(projection, loop[3], loop[0], loop[1]) == first;
}

bool is_simple(Projection projection, const std::vector<Vec3>& loop) {
  if (loop.size() < 3) return false;
  if (loop.size() == 3) return turn(projection, loop[0], loop[1], loop[2]) != 0;
  if (is_strictly_convex_quadrilateral(projection, loop)) return true;
  const FlatLoop flat = flatten(projection, loop);
  return CGAL::is_simple_2(flat.begin(), flat.end(), Kernel());
}

bool touch(const FlatLoop& a, const FlatLoop& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Kernel::Segment_2 edge(a[i], a[(i + 1) % a.size()]);
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (CGAL::do_intersect(edge, Kernel::Segment_2(b[j], b[(j + 1) % b.size()]))) return true;
    }
  }
  return false;
}

/// Whether loops that do not touch have `inner` within `outer`.
bool contains(const FlatLoop& outer, const FlatLoop& inner) {
  return CGAL::bounded_side_2(outer.begin(), outer.end(), inner[0], Kernel()) == CGAL::ON_BOUNDED_SIDE;
}

bool all_finite(const Polygon& polygon) {
  const auto finite = [](const std::vector<Vec3>& loop) { return std::all_of(loop.begin(), loop.end(), is_finite); };
  return finite(polygon.outer) && std::all_of(polygon.holes.begin(), polygon.holes.end(), finite);
}

bool is_simple(Projection projection, const Polygon& polygon) {
  const std::vector<Vec3> outer = without_repeats(polygon.outer);
  if (!is_simple(projection, outer)) return false;
  if (polygon.holes.empty()) return true;

  const FlatLoop flat_outer = flatten(projection, outer);
  std::vector<FlatLoop> flat_holes;
  for (const auto& given : polygon.holes) {
    const std::vector<Vec3> hole = without_repeats(given);
    if (!is_simple(projection, hole)) return false;
    const FlatLoop flat = flatten(projection, hole);
    if (touch(flat_outer, flat) || !contains(flat_outer, flat)) return false;
    for (const FlatLoop& other : flat_holes) {
      if (touch(other, flat) || contains(other, flat) || contains(flat, other)) return false;
    }
    flat_holes.push_back(flat);
  }
  return true;
}

}  // namespace

PolygonDefect find_defect(const Polygon& polygon) {
  if (!all_finite(polygon)) return PolygonDefect::non_finite;
  const auto too_few = [](const std::vector<Vec3>& loop) { return loop.size() < 3; };
  if (too_few(polygon.outer) || std::any_of(polygon.holes.begin(), polygon.holes.end(), too_few)) {
    return PolygonDefect::too_few_vertices;
  }
  const auto projection = largest_projection(polygon.outer);
  if (!projection) return PolygonDefect::zero_area;
  return is_simple(*projection, polygon) ? PolygonDefect::none : PolygonDefect::self_intersecting;
}

std::string_view describe(PolygonDefect defect) {
  switch (defect) {
    case PolygonDefect::none:
      return "no defect";
    case PolygonDefect::non_finite:
      return "a coordinate is not a finite number";
    case PolygonDefect::too_few_vertices:
      return "a loop has fewer than three vertices";
    case PolygonDefect::zero_area:
      return "its vertices lie on one line, so it has no area";
    case PolygonDefect::self_intersecting:
      return "its boundary crosses or touches itself, or a hole lies outside it";
  }
  return "";
}

Vec3 area_vector(const std::vector<Vec3>& loop) {
  // The same for a quadrilateral whatever vertex comes first, to the last bit.
  if (loop.size() == 4) return 0.5 * cross(loop[2] - loop[0], loop[3] - loop[1]);
  Vec3 sum;
  for (std::size_t i = 2; i < loop.size(); ++i) sum = sum + cross(loop[i - 1] - loop[0], loop[i] - loop[0]);
  return 0.5 * sum;
}

Vec3 area_vector(const Polygon& polygon) {
  const Vec3 outer = area_vector(polygon.outer);
  Vec3 sum = outer;
  for (const auto& hole : polygon.holes) {
    const Vec3 a = area_vector(hole);
    sum = dot(a, outer) > 0 ? sum - a : sum + a;
  }
  return sum;
}

}  // namespace exitance
