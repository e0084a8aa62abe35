#include "geometry/edge_contact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/near_pairs.h"
#include "geometry/projection.h"

namespace exitance {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_rational;

Kernel::Point_3 point(const Vec3& p) {
  return {p.x, p.y, p.z};
}

// A stretch of an edge: from 0, its beginning, to 1, its end.
using Stretch = std::pair<Exact, Exact>;

Exact twice_area(Projection projection, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Exact au = projection.u(a), av = projection.v(a);
  return (Exact(projection.u(b)) - au) * (Exact(projection.v(c)) - av) -
         (Exact(projection.v(b)) - av) * (Exact(projection.u(c)) - au);
}

// The stretch of the edge that lies on a convex facet, if the facet's plane holds the edge.
std::optional<Stretch> stretch_on(const Loop& facet, const DirectedEdge& e) {
  const auto projection = largest_projection(facet);
  if (!projection) return std::nullopt;
  const std::size_t n = facet.size();
  std::size_t k = 0;
  while (turn(*projection, facet[k], facet[(k + 1) % n], facet[(k + 2) % n]) == 0) ++k;
  const Vec3 &a = facet[k], &b = facet[(k + 1) % n], &c = facet[(k + 2) % n];
  for (const Vec3& end : {e.from, e.to}) {
    if (CGAL::orientation(point(a), point(b), point(c), point(end)) != CGAL::COPLANAR) return std::nullopt;
  }
  const int sense = turn(*projection, a, b, c);
  Stretch stretch{0, 1};
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 &p = facet[i], &q = facet[(i + 1) % n];
    const int from_side = turn(*projection, p, q, e.from) * sense, to_side = turn(*projection, p, q, e.to) * sense;
    if (from_side >= 0 && to_side >= 0) continue;
    if (from_side < 0 && to_side < 0) return std::nullopt;
    // An end on the line itself crosses at 0 or 1.
    const Exact from = twice_area(*projection, p, q, e.from), to = twice_area(*projection, p, q, e.to);
    const Exact crossing = from / (from - to);
    if (from_side < 0) {
      stretch.first = std::max(stretch.first, crossing);
    } else {
      stretch.second = std::min(stretch.second, crossing);
    }
  }
  return stretch.first < stretch.second ? std::optional(stretch) : std::nullopt;
}

// The stretch of the edge that lies within so much of a convex facet and of its plane.
std::optional<Stretch> stretch_near(const Loop& facet, const DirectedEdge& e, double near) {
  const Vec3 normal = normalized(area_vector(facet));
  const auto is_off = [&](const Vec3& end) { return !(std::fabs(dot(normal, end - facet[0])) <= near); };
  if (is_off(e.from) || is_off(e.to)) return std::nullopt;
  double first = 0, second = 1;
  for (std::size_t i = 0; i < facet.size(); ++i) {
    const Vec3 &p = facet[i], &q = facet[(i + 1) % facet.size()];
    if (p == q) continue;
    const Vec3 inward = normalized(cross(normal, q - p));
    const double from = dot(inward, e.from - p) + near, to = dot(inward, e.to - p) + near;
    if (from < 0 && to < 0) return std::nullopt;
    if (from < 0) first = std::max(first, from / (from - to));
    if (to < 0) second = std::min(second, from / (from - to));
  }
  return first < second ? std::optional(Stretch(first, second)) : std::nullopt;
}

// Whether stretches leave no gap of more than `gap` between them.
bool cover_all(std::vector<Stretch>& stretches, const Exact& gap) {
  std::ranges::sort(stretches);
  Exact reached = 0;
  for (const auto& [from, to] : stretches) {
    if (from > reached + gap) return false;
    reached = std::max(reached, to);
  }
  return reached + gap >= 1;
}

}  // namespace

std::vector<bool> edges_in_contact(std::span<const DirectedEdge> edges, std::span<const PieceFacet> facets,
                                   std::span<const std::uint32_t> piece_of_polygon, double near) {
  if (edges.empty()) return {};
  std::vector<Box> edge_boxes(edges.size()), facet_boxes(facets.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    edge_boxes[i].extend(edges[i].from);
    edge_boxes[i].extend(edges[i].to);
    edge_boxes[i] = edge_boxes[i].grown(near);
  }
  for (std::size_t i = 0; i < facets.size(); ++i) {
    for (const Vec3& p : facets[i].loop) facet_boxes[i].extend(p);
  }
  std::vector<std::vector<Stretch>> stretches(edges.size());
  std::vector<bool> on_one(edges.size());  // facet, all of the edge: then no other is asked
  const auto add = [&](std::uint32_t e, std::optional<Stretch> stretch) {
    if (!stretch) return;
    on_one[e] = stretch->first == 0 && stretch->second == 1;
    stretches[e].push_back(*std::move(stretch));
  };
  for_each_near_pair(edge_boxes, facet_boxes, [&](std::uint32_t e, std::uint32_t f) {
    if (on_one[e] || piece_of_polygon[edges[e].polygon] == facets[f].piece) return;
    add(e, stretch_on(facets[f].loop, edges[e]));
    if (near > 0 && !on_one[e]) add(e, stretch_near(facets[f].loop, edges[e], near));
  });

  std::vector<bool> in_contact;
  in_contact.reserve(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double length = norm(edges[i].to - edges[i].from);
    in_contact.push_back(cover_all(stretches[i], near == 0 ? 0 : length > near ? near / length : 1));
  }
  return in_contact;
}

}  // namespace exitance
