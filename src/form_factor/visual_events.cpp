#include "src/form_factor/visual_events.h"

#include <algorithm>
#include <cmath>

#include "src/form_factor/event_reach.h"

namespace exitance {
namespace {

/// Pairs of occluders are looked at up to this many vertices times edges. Of more, few events are seen from any one
/// cell, and cells are cut sooner along those alone that their points tell of.
constexpr std::size_t kOccluderEvents = 5'000;

/// An edge with the facets on either side of it; kNone: nothing, several, or it does not matter.
struct Edge {
  Vec3 from, to;
  std::uint32_t left = kNone, right = kNone;
};

/// Vertices and edges that may bound what is seen of something: of an occluder, or of the source.
struct Outline {
  std::vector<Vec3> vertices;
  std::vector<Edge> edges;
};

Outline outline_of_item(const PolygonSoup& soup, std::uint32_t item) {
  Outline outline;
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  if (item >= facets) {
    const Shell& shell = soup.shells()[item - facets];
    for (const std::uint32_t v : shell.vertices) outline.vertices.push_back(soup.vertices()[v]);
    for (const ShellEdge& e : shell.edges) {
      outline.edges.push_back({soup.vertices()[e.from], soup.vertices()[e.to], e.left, e.right});
    }
    return outline;
  }
  const Facet& f = soup.facets()[item];
  const auto c = soup.corners(f);
  for (std::size_t k = 0; k < c.size(); ++k) {
    outline.vertices.push_back(c[k].at);
    const std::uint32_t n = c[k].neighbour;
    if (n != kNone && soup.facets()[n].polygon == f.polygon) continue;
    if (n != kNone && n < item) continue;  // met from the other side; where that is no occluder, its plane's event does
    outline.edges.push_back({c[k].at, c[(k + 1) % c.size()].at, n == kNone ? kNone : item, n});
  }
  return outline;
}

Outline outline_of_source(const PolygonSoup& soup, const Source& source) {
  Outline outline;
  outline.vertices = corners_of(soup, source);
  for (std::size_t k = 0; k < outline.vertices.size(); ++k) {
    outline.edges.push_back({outline.vertices[k], outline.vertices[(k + 1) % outline.vertices.size()]});
  }
  return outline;
}

class EventCollector {
 public:
  using Way = EventReach::Way;

  EventCollector(const PolygonSoup& soup, const Source& receiver, const Source& source,
                 std::span<const std::uint32_t> items)
      : soup_(soup),
        normal_(soup.facets()[receiver.facet].plane.normal),
        loop_(corners_of(soup, receiver)),
        spread_(spread_corners(loop_)),
        reach_(soup, receiver, source, items) {}

  void source_plane(std::uint32_t facet) {
    const Plane& p = soup_.facets()[facet].plane;
    keep(whole({p.normal, p.origin}));
  }

  void plane_of(std::uint32_t facet) {
    const Plane& p = soup_.facets()[facet].plane;
    const CutPlane plane{p.normal, p.origin};
    if (!crosses(loop_, plane)) return;
    Vec3 along;
    for (const LineStretch& s : reach_.of_facet(plane, corners_of(soup_, {facet, {}}), along)) keep({plane, along, s});
  }

  void contact(std::uint32_t facet) {
    const auto c = soup_.corners(soup_.facets()[facet]);
    for (std::size_t k = 0; k < c.size(); ++k) {
      const Vec3 &a = c[k].at, &b = c[(k + 1) % c.size()].at;
      keep(whole({cross(b - a, normal_), a}));
    }
  }

  /// Only an outline's edge counts: the surfaces that meet in it lie on one side of the plane.
  void vertex_edge(const Vec3& v, const Outline& of_v, const Edge& e, Way way) {
    if (v == e.from || v == e.to) return;
    const CutPlane plane{cross(e.from - v, e.to - v), v};
    const Vec3& n = plane.normal;
    if (!crosses(loop_, plane) || !reaches(plane, e, way)) return;
    if (e.left != kNone && e.right != kNone && side_of_facet(e.left, n, v) * side_of_facet(e.right, n, v) < 0) return;
    Vec3 along;
    for (const LineStretch& s : reach_.of_vertex_edge(plane, v, e.from, e.to, way, along)) keep({plane, along, s});
    // An edge of the vertex in the same plane comes into line with e as a whole, seen past its ends or not.
    for (const Edge& other : of_v.edges) {
      if (other.from != v && other.to != v) continue;
      const Vec3& end = other.from == v ? other.to : other.from;
      if (std::fabs(dot(n, end - v)) > 1e-12 * norm(e.from - v) * norm(e.to - v) * norm(end - v)) continue;
      const std::array one{v, end}, two{e.from, e.to};
      for (const LineStretch& s : reach_.of_edges(plane, one, two, along)) keep({plane, along, s});
    }
  }

  void between(const Outline& a, const Outline& b) {
    for (const Vec3& v : a.vertices) {
      for (const Edge& e : b.edges) {
        vertex_edge(v, a, e, Way::vertex_edge);
        vertex_edge(v, a, e, Way::edge_vertex);
      }
    }
  }
  void before_source(const Outline& occluder, const Outline& source) {
    for (const Vec3& v : occluder.vertices) {
      for (const Edge& e : source.edges) vertex_edge(v, occluder, e, Way::vertex_source);
    }
    for (const Vec3& v : source.vertices) {
      for (const Edge& e : occluder.edges) vertex_edge(v, source, e, Way::edge_source);
    }
  }

  std::vector<VisualEvent> take() { return std::move(events_); }

 private:
  /// The corners of a polygon's largest triangle.
  static std::array<Vec3, 3> spread_corners(std::span<const Vec3> loop) {
    std::array<Vec3, 3> spread{loop[0], loop[0], loop[0]};
    double largest = 0;
    for (std::size_t j = 1; j < loop.size(); ++j) {
      for (std::size_t k = j + 1; k < loop.size(); ++k) {
        const double size = norm(cross(loop[j] - loop[0], loop[k] - loop[0]));
        if (size > largest) {
          largest = size;
          spread = {loop[0], loop[j], loop[k]};
        }
      }
    }
    return spread;
  }

  /// Values at three corners that are not in line tell one line on the receiver from another.
  struct Trace {
    std::array<double, 3> value;
  };

  /// Of a facet on one side of a plane through p, 0 when it lies in it up to rounding.
  int side_of_facet(std::uint32_t facet, const Vec3& n, const Vec3& p) const {
    double farthest = 0, distance = 0;
    for (const Corner& c : soup_.corners(soup_.facets()[facet])) {
      const Vec3 w = c.at - p;
      const double d = dot(n, w);
      if (std::fabs(d) > std::fabs(farthest)) farthest = d;
      distance = std::max(distance, norm(w));
    }
    return std::fabs(farthest) <= 1e-12 * norm(n) * distance ? 0 : farthest > 0 ? 1 : -1;
  }

  /// Whether part of the receiver is within the angle, at the plane's point, of the edge or of what lies opposite.
  bool reaches(const CutPlane& plane, const Edge& e, Way way) const {
    const double sign = way == Way::vertex_edge || way == Way::vertex_source ? -1 : 1;
    for (const Vec3& inside :
         {sign * cross(plane.normal, e.from - plane.point), -sign * cross(plane.normal, e.to - plane.point)}) {
      const auto is_outside = [&](const Vec3& v) { return dot(inside, v - plane.point) < 0; };
      if (std::ranges::all_of(loop_, is_outside)) return false;
    }
    return true;
  }

  VisualEvent whole(const CutPlane& plane) const {
    const Vec3 along = cross(normal_, plane.normal);
    return {plane, (1 / norm(along)) * along};
  }

  Trace trace_of(const VisualEvent& event) const {
    Trace t;
    double largest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      t.value[k] = event.plane.at(spread_[k]);
      if (std::fabs(t.value[k]) > std::fabs(largest)) largest = t.value[k];
    }
    for (double& v : t.value) v /= largest;
    return t;
  }

  void keep(const VisualEvent& event) {
    if (!event.concerns(loop_)) return;
    const Trace t = trace_of(event);
    for (std::size_t k = 0; k < traces_.size(); ++k) {
      double apart = 0;
      for (std::size_t i = 0; i < 3; ++i) apart = std::max(apart, std::fabs(traces_[k].value[i] - t.value[i]));
      if (apart < 1e-11 && joined(events_[k], event)) return;
    }
    events_.push_back(event);
    traces_.push_back(t);
  }

  /// Joins another stretch of the same line to an event's, where they meet.
  static bool joined(VisualEvent& event, const VisualEvent& other) {
    const double start = dot(event.along, other.plane.point - event.plane.point),
                 sign = std::copysign(1, dot(event.along, other.along));
    LineStretch more;
    for (const double end : {other.stretch.from, other.stretch.to}) more.add(start + sign * end);
    if (more.from > event.stretch.to || more.to < event.stretch.from) return false;
    event.stretch.add(more);
    return true;
  }

  const PolygonSoup& soup_;
  Vec3 normal_;
  std::vector<Vec3> loop_;
  std::array<Vec3, 3> spread_;  // of its corners
  EventReach reach_;
  std::vector<VisualEvent> events_;
  std::vector<Trace> traces_;
};

}  // namespace

std::vector<SeenEdge> edges_of(const PolygonSoup& soup, const Source& source, std::span<const std::uint32_t> items) {
  std::vector<SeenEdge> edges;
  const auto add = [&](const Outline& outline) {
    for (const Edge& e : outline.edges) edges.push_back({0, e.from, e.to, {}, {}});
  };
  add(outline_of_source(soup, source));
  for (const std::uint32_t item : items) add(outline_of_item(soup, item));
  return edges;
}

std::vector<VisualEvent> visual_events(const PolygonSoup& soup, const Source& receiver, const Source& source,
                                       std::span<const std::uint32_t> items) {
  EventCollector events(soup, receiver, source, items);
  events.source_plane(source.facet);
  for (const std::uint32_t t : soup.coplanar(receiver.facet)) {
    if (soup.covers(t, receiver.facet)) events.contact(t);
  }
  const Outline of_source = outline_of_source(soup, source);
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  std::vector<Outline> between;
  std::size_t vertices = 0, edges = 0;
  for (const std::uint32_t item : items) {
    if (item < facets) {
      events.plane_of(item);
    } else {
      for (const std::uint32_t f : soup.shells()[item - facets].facets) events.plane_of(f);
    }
    between.push_back(outline_of_item(soup, item));
    events.before_source(between.back(), of_source);
    vertices += between.back().vertices.size();
    edges += between.back().edges.size();
  }
  if (vertices * edges <= kOccluderEvents) {
    for (std::size_t i = 0; i < between.size(); ++i) {
      for (std::size_t j = 0; j < between.size(); ++j) {
        if (i != j) events.between(between[i], between[j]);
      }
    }
  }
  return events.take();
}

}  // namespace exitance
