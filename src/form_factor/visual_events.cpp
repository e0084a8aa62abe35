#include "src/form_factor/visual_events.h"

#include <algorithm>
#include <set>
#include <tuple>

namespace exitance {
namespace {

/// Pairs of occluders are looked at up to this many vertices times edges.
constexpr std::size_t kOccluderEvents = 4000;

struct Edge {
  std::uint32_t from, to;      ///< from < to
  std::uint32_t facet, other;  ///< on either side of it; kNone: nothing, several, or it does not matter
  friend auto operator<=>(const Edge&, const Edge&) = default;
};

/// Vertices and edges of some facets, each once; edges between facets of one polygon are left out. Where an edge bounds
/// always, whatever surface continues beyond it, it is kept without its neighbour.
struct Outline {
  std::vector<std::uint32_t> vertices;
  std::vector<Edge> edges;

  void add(const PolygonSoup& soup, std::uint32_t facet, bool bounds_always) {
    const Facet& f = soup.facets()[facet];
    const auto c = soup.corners(f);
    for (std::size_t k = 0; k < c.size(); ++k) {
      vertices.push_back(c[k].vertex);
      const std::uint32_t next = c[(k + 1) % c.size()].vertex;
      if (c[k].neighbour != kNone && soup.facets()[c[k].neighbour].polygon == f.polygon) continue;
      const std::uint32_t n = bounds_always ? kNone : c[k].neighbour;
      edges.push_back(
          {std::min(c[k].vertex, next), std::max(c[k].vertex, next), std::min(facet, n), std::max(facet, n)});
    }
  }
  void finish() {
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  }
};

Outline outline_of(const PolygonSoup& soup, const std::vector<std::uint32_t>& facets, bool bounds_always) {
  Outline outline;
  for (const std::uint32_t f : facets) outline.add(soup, f, bounds_always);
  outline.finish();
  return outline;
}

std::vector<std::uint32_t> facets_of(const PolygonSoup& soup, std::uint32_t polygon) {
  std::vector<std::uint32_t> facets;
  for (std::uint32_t f = soup.first_facet(polygon); f < soup.first_facet(polygon + 1); ++f) facets.push_back(f);
  return facets;
}

class EventCollector {
 public:
  EventCollector(const PolygonSoup& soup, std::uint32_t receiver) : soup_(soup) {
    const Facet& f = soup.facets()[receiver];
    normal_ = f.plane.normal;
    std::vector<Vec3> loop;
    for (const Corner& c : soup.corners(f)) loop.push_back(soup.vertices()[c.vertex]);
    cells_ = cells_of(loop);
  }

  void plane_of(std::uint32_t facet) {
    const Plane& p = soup_.facets()[facet].plane;
    keep({{p.normal, p.origin}, {}});
  }

  void contact(std::uint32_t facet) {
    const auto c = soup_.corners(soup_.facets()[facet]);
    for (std::size_t k = 0; k < c.size(); ++k) {
      const Vec3 &a = at(c[k].vertex), &b = at(c[(k + 1) % c.size()].vertex);
      keep({{cross(b - a, normal_), a}, {}});
    }
  }

  /// A vertex in line with an edge, seen from beyond the vertex or from beyond the edge. Only an outline's edge counts:
  /// the surfaces that meet in it lie on one side of the plane.
  void vertex_edge(std::uint32_t v, const Edge& e, bool beyond_vertex) {
    if (v == e.from || v == e.to) return;
    const Vec3 &p = at(v), c = at(e.from) - p, d = at(e.to) - p;
    const Vec3 n = cross(c, d);
    if (e.other != kNone && side_of_facet(e.facet, n, p) * side_of_facet(e.other, n, p) < 0) return;
    const double sign = beyond_vertex ? -1 : 1;
    keep({{n, p}, {sign * cross(n, c), -sign * cross(n, d)}});
  }

  std::vector<VisualEvent> take() { return std::move(events_); }

 private:
  const Vec3& at(std::uint32_t vertex) const { return soup_.vertices()[vertex]; }

  /// Of a facet on one side of a plane through p, 0 when it lies in it up to rounding.
  int side_of_facet(std::uint32_t facet, const Vec3& n, const Vec3& p) const {
    double farthest = 0, distance = 0;
    for (const Corner& c : soup_.corners(soup_.facets()[facet])) {
      const Vec3 w = at(c.vertex) - p;
      const double d = dot(n, w);
      if (std::fabs(d) > std::fabs(farthest)) farthest = d;
      distance = std::max(distance, norm(w));
    }
    return std::fabs(farthest) <= 1e-12 * norm(n) * distance ? 0 : farthest > 0 ? 1 : -1;
  }

  void keep(const VisualEvent& event) {
    if (std::any_of(cells_.begin(), cells_.end(), [&](const AreaCell& c) { return event.concerns(c); })) {
      events_.push_back(event);
    }
  }

  const PolygonSoup& soup_;
  Vec3 normal_;
  std::vector<AreaCell> cells_;
  std::vector<VisualEvent> events_;
};

/// Whether some corner of the facet lies strictly on the side `sign` of the plane through three points.
bool reaches(const PolygonSoup& soup, const Facet& f, const Vec3& a, const Vec3& b, const Vec3& c, int sign,
             StageCounts& counts) {
  const auto corners = soup.corners(f);
  return std::any_of(corners.begin(), corners.end(),
                     [&](const Corner& k) { return orientation(a, b, c, soup.vertices()[k.vertex], counts) == sign; });
}

bool reaches_above(const PolygonSoup& soup, const Facet& f, const Facet& plane, StageCounts& counts) {
  const auto corners = soup.corners(f);
  return std::any_of(corners.begin(), corners.end(),
                     [&](const Corner& k) { return side_of(plane.plane, soup.vertices()[k.vertex], counts) > 0; });
}

/// Sides of the convex hull of two sets of vertices that hold an edge of the one and a vertex of the other: plane by
/// three vertices and the sign of its inner side.
struct HullSide {
  std::uint32_t a, b, c;
  int inner;
};

void add_hull_sides(const PolygonSoup& soup, const Outline& one, const Outline& other, std::vector<HullSide>& sides,
                    StageCounts& counts) {
  const auto vertices = soup.vertices();
  for (const Edge& e : one.edges) {
    for (const std::uint32_t v : other.vertices) {
      int inner = 0;
      bool supports = true;
      for (const Outline* part : {&one, &other}) {
        for (const std::uint32_t w : part->vertices) {
          if (!supports || w == e.from || w == e.to || w == v) continue;
          const int side = orientation(vertices[e.from], vertices[e.to], vertices[v], vertices[w], counts);
          supports = side == 0 || inner == 0 || side == inner;
          if (side != 0) inner = side;
        }
      }
      if (supports && inner != 0) sides.push_back({e.from, e.to, v, inner});
    }
  }
}

}  // namespace

bool VisualEvent::concerns(const AreaCell& cell) const {
  const auto loop = cell.loop();
  for (const Vec3& n : inside) {
    if (n == Vec3{}) continue;
    if (std::all_of(loop.begin(), loop.end(), [&](const Vec3& v) { return dot(n, v - plane.point) < 0; })) return false;
  }
  return crosses(cell, plane);
}

bool face_each_other(const PolygonSoup& soup, std::uint32_t r, std::uint32_t s) {
  StageCounts counts;
  const Facet &a = soup.facets()[r], &b = soup.facets()[s];
  return reaches_above(soup, b, a, counts) && reaches_above(soup, a, b, counts);
}

std::vector<std::uint32_t> occluders_between(const PolygonSoup& soup, std::uint32_t receiver_facet,
                                             std::uint32_t source_polygon) {
  StageCounts counts;
  const auto source_facets = facets_of(soup, source_polygon);
  const Outline receiver = outline_of(soup, {receiver_facet}, true), source = outline_of(soup, source_facets, true);
  const std::uint32_t receiver_polygon = soup.facets()[receiver_facet].polygon;
  Box box;
  for (const Outline* part : {&receiver, &source}) {
    for (const std::uint32_t v : part->vertices) box.extend(soup.vertices()[v]);
  }
  std::vector<std::uint32_t> items, found;
  soup.index().find(box, items);
  const auto facet_count = static_cast<std::uint32_t>(soup.facets().size());
  for (const std::uint32_t item : items) {
    if (item < facet_count) {
      found.push_back(item);
    } else {
      const auto& facets = soup.shells()[item - facet_count].facets;
      found.insert(found.end(), facets.begin(), facets.end());
    }
  }
  std::sort(found.begin(), found.end());

  std::vector<HullSide> sides;
  add_hull_sides(soup, receiver, source, sides, counts);
  add_hull_sides(soup, source, receiver, sides, counts);
  const auto vertices = soup.vertices();
  std::erase_if(found, [&](std::uint32_t t) {
    const Facet& f = soup.facets()[t];
    if (f.polygon == receiver_polygon || f.polygon == source_polygon) return true;
    const bool covers_source = std::any_of(source_facets.begin(), source_facets.end(), [&](std::uint32_t s) {
      const auto coplanar = soup.coplanar(s);
      return std::binary_search(coplanar.begin(), coplanar.end(), t) && soup.covers(t, s);
    });
    if (!reaches_above(soup, f, soup.facets()[receiver_facet], counts)) return true;
    if (!covers_source && std::none_of(source_facets.begin(), source_facets.end(), [&](std::uint32_t s) {
          return reaches_above(soup, f, soup.facets()[s], counts);
        })) {
      return true;
    }
    return std::any_of(sides.begin(), sides.end(), [&](const HullSide& side) {
      return !reaches(soup, f, vertices[side.a], vertices[side.b], vertices[side.c], side.inner, counts);
    });
  });
  return found;
}

std::vector<VisualEvent> visual_events(const PolygonSoup& soup, std::uint32_t receiver_facet,
                                       std::uint32_t source_polygon, const std::vector<std::uint32_t>& occluders) {
  EventCollector events(soup, receiver_facet);
  const auto source_facets = facets_of(soup, source_polygon);
  for (const std::uint32_t s : source_facets) events.plane_of(s);
  for (const std::uint32_t t : soup.coplanar(receiver_facet)) events.contact(t);
  for (const std::uint32_t t : occluders) events.plane_of(t);

  const Outline source = outline_of(soup, source_facets, true), between = outline_of(soup, occluders, false);
  for (const std::uint32_t v : between.vertices) {
    for (const Edge& e : source.edges) events.vertex_edge(v, e, true);
  }
  for (const std::uint32_t v : source.vertices) {
    for (const Edge& e : between.edges) events.vertex_edge(v, e, false);
  }
  if (between.vertices.size() * between.edges.size() <= kOccluderEvents) {
    for (const std::uint32_t v : between.vertices) {
      for (const Edge& e : between.edges) {
        events.vertex_edge(v, e, true);
        events.vertex_edge(v, e, false);
      }
    }
  }
  return events.take();
}

}  // namespace exitance
