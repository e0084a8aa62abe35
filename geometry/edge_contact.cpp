#include "geometry/edge_contact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>

#include <algorithm>
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

bool cover_all(std::vector<Stretch>& stretches) {
  std::ranges::sort(stretches);
  Exact reached = 0;
  for (const auto& [from, to] : stretches) {
    if (from > reached) return false;
    reached = std::max(reached, to);
  }
  return reached >= 1;
}

}  // namespace

std::vector<bool> edges_in_contact(std::span<const DirectedEdge> edges, std::span<const PieceFacet> facets,
                                   std::span<const std::uint32_t> piece_of_polygon) {
  if (edges.empty()) return {};
  std::vector<Box> edge_boxes(edges.size()), facet_boxes(facets.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    edge_boxes[i].extend(edges[i].from);
    edge_boxes[i].extend(edges[i].to);
  }
  for (std::size_t i = 0; i < facets.size(); ++i) {
    for (const Vec3& p : facets[i].loop) facet_boxes[i].extend(p);
  }
  std::vector<std::vector<Stretch>> stretches(edges.size());
  for_each_near_pair(edge_boxes, facet_boxes, [&](std::uint32_t e, std::uint32_t f) {
    if (piece_of_polygon[edges[e].polygon] == facets[f].piece) return;
    if (auto stretch = stretch_on(facets[f].loop, edges[e])) stretches[e].push_back(*std::move(stretch));
  });

  std::vector<bool> in_contact;
  in_contact.reserve(edges.size());
  for (auto& of_edge : stretches) in_contact.push_back(cover_all(of_edge));
  return in_contact;
}

}  // namespace exitance
