#include "geometry/edge_matching.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "geometry/disjoint_sets.h"
#include "geometry/near_pairs.h"

namespace exitance {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 point(const Vec3& p) {
  return {p.x, p.y, p.z};
}

// Adding zero makes −0 into 0.
auto order(const Vec3& p) {
  return std::tuple{p.x + 0.0, p.y + 0.0, p.z + 0.0};
}

void add_loop(const std::vector<Vec3>& loop, bool reversed, std::uint32_t polygon, std::vector<DirectedEdge>& edges) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& a = loop[i];
    const Vec3& b = loop[(i + 1) % loop.size()];
    if (a == b) continue;
    edges.push_back(reversed ? DirectedEdge{b, a, polygon} : DirectedEdge{a, b, polygon});
  }
}

bool runs_up(const DirectedEdge& e) {
  return order(e.from) < order(e.to);
}

// Edges between the same two points, whichever way they run, stand together.
void sort_by_ends(std::vector<DirectedEdge>& edges) {
  std::ranges::sort(edges, {}, [](const DirectedEdge& e) {
    const bool up = runs_up(e);
    return std::tuple{order(up ? e.from : e.to), order(up ? e.to : e.from), e.polygon, up};
  });
}

bool same_ends(const DirectedEdge& e, const DirectedEdge& f) {
  return (e.from == f.from && e.to == f.to) || (e.from == f.to && e.to == f.from);
}

template <typename Visit>
void for_each_group(const std::vector<DirectedEdge>& edges, Visit visit) {
  for (std::size_t first = 0; first < edges.size();) {
    std::size_t last = first + 1;
    while (last < edges.size() && same_ends(edges[first], edges[last])) ++last;
    visit(std::span<const DirectedEdge>(edges.data() + first, last - first));
    first = last;
  }
}

int net_direction(std::span<const DirectedEdge> group) {
  int net = 0;
  for (const DirectedEdge& e : group) net += runs_up(e) ? 1 : -1;
  return net;
}

// Whether a point in an edge's box lies on it between its ends, exactly, or so near to it and not to its ends.
bool lies_on(const DirectedEdge& e, const Vec3& v, double near) {
  if (v == e.from || v == e.to) return false;
  if (near > 0) {
    const Vec3 along = normalized(e.to - e.from), w = v - e.from;
    const double t = dot(w, along);
    if (t > near && dot(e.to - v, along) > near && norm(w - t * along) <= near) return true;
  }
  Box box;
  box.extend(e.from);
  box.extend(e.to);
  return box.contains(v) && CGAL::collinear(point(e.from), point(v), point(e.to));
}

int longest_axis(const Vec3& d) {
  const double x = std::fabs(d.x), y = std::fabs(d.y), z = std::fabs(d.z);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

// Cuts each edge at the ends of the others that lie on it.
std::vector<DirectedEdge> cut_at_vertices(const std::vector<DirectedEdge>& edges, double near) {
  std::vector<const Vec3*> ends;
  for (const DirectedEdge& e : edges) ends.insert(ends.end(), {&e.from, &e.to});
  std::ranges::sort(ends, {}, [](const Vec3* p) { return order(*p); });
  ends.erase(std::unique(ends.begin(), ends.end(), [](const Vec3* p, const Vec3* q) { return *p == *q; }), ends.end());

  std::vector<Box> points(ends.size()), segments(edges.size());
  for (std::size_t i = 0; i < ends.size(); ++i) points[i].extend(*ends[i]);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    segments[i].extend(edges[i].from);
    segments[i].extend(edges[i].to);
    segments[i] = segments[i].grown(near);
  }
  std::vector<std::vector<Vec3>> cuts(edges.size());
  for_each_near_pair(points, segments, [&](std::uint32_t p, std::uint32_t i) {
    if (lies_on(edges[i], *ends[p], near)) cuts[i].push_back(*ends[p]);
  });

  std::vector<DirectedEdge> pieces;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    // Along a line the order of coordinates is the order of points.
    const int axis = longest_axis(edges[i].to - edges[i].from);
    std::ranges::sort(cuts[i], {}, [axis](const Vec3& v) { return std::tuple{v[axis], order(v)}; });
    if (edges[i].to[axis] < edges[i].from[axis]) std::ranges::reverse(cuts[i]);
    Vec3 from = edges[i].from;
    for (const Vec3& v : cuts[i]) pieces.push_back({std::exchange(from, v), v, edges[i].polygon});
    pieces.push_back({from, edges[i].to, edges[i].polygon});
  }
  return pieces;
}

// An edge as it leaves the common line of its group: in which direction its polygon lies, seen along the line.
struct Wing {
  double angle = 0;
  bool up = false;
  std::size_t edge = 0;  ///< of the group
  std::int64_t polygon = 0;
  bool matched = false;
};

// Sorted by angle, and where wings lie on each other those first whose back lies on the side where the angles are
// smaller.
std::vector<Wing> sort_round_line(std::span<const DirectedEdge> group,
                                  const std::function<Vec3(std::uint32_t)>& normal) {
  // Wings of faces in contact differ by rounding only.
  constexpr double kSameAngle = 1e-9;
  constexpr double kFullTurn = 2 * std::numbers::pi;
  const DirectedEdge& first = group.front();
  const Vec3 along = normalized(runs_up(first) ? first.to - first.from : first.from - first.to);
  // A polygon lies to the left of its edge.
  const auto direction = [&](const DirectedEdge& e) {
    const Vec3 left = cross(normal(e.polygon), along);
    return runs_up(e) ? left : -left;
  };
  const Vec3 zero = direction(first);
  std::vector<Wing> wings;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const Vec3 d = direction(group[k]);
    double angle = std::atan2(dot(cross(zero, d), along), dot(zero, d));
    if (angle < -kSameAngle) angle += kFullTurn;
    wings.push_back({.angle = angle, .up = runs_up(group[k]), .edge = k, .polygon = group[k].polygon});
  }
  std::ranges::stable_sort(wings, {}, &Wing::angle);
  for (std::size_t i = 1; i < wings.size(); ++i) {
    if (wings[i].angle - wings[i - 1].angle < kSameAngle) wings[i].angle = wings[i - 1].angle;
  }
  // The order of equal ones is that of brackets, so that faces that are there twice pair the same way along all their
  // edges.
  std::ranges::stable_sort(wings, {}, [](const Wing& w) {
    return std::tuple{w.angle, !w.up, w.up ? -w.polygon : w.polygon};
  });
  return wings;
}

// What finds no partner is open.
void match_round_line(std::span<const DirectedEdge> group, std::span<const Polygon> polygons, DisjointSets& sets,
                      std::vector<DirectedEdge>& open) {
  std::vector<bool> matched(group.size(), false);
  for (const auto& [i, j] : pairs_round_line(group, [&](std::uint32_t p) { return area_vector(polygons[p]); })) {
    sets.unite(group[i].polygon, group[j].polygon);
    matched[i] = matched[j] = true;
  }
  for (std::size_t k = 0; k < group.size(); ++k) {
    if (!matched[k]) open.push_back(group[k]);
  }
}

}  // namespace

// Wings cancel in pairs that have matter behind them: going round the line, matter begins at an edge that runs down and
// ends at one that runs up. So solids that touch, and a solid that stands in the corner of a room, stay apart.
std::vector<std::pair<std::size_t, std::size_t>> pairs_round_line(std::span<const DirectedEdge> group,
                                                                  const std::function<Vec3(std::uint32_t)>& normal) {
  std::vector<Wing> wings = sort_round_line(group, normal);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  std::vector<Wing*> begun;
  for (int round = 0; round < 2; ++round) {
    for (Wing& wing : wings) {
      if (wing.matched) continue;
      if (!wing.up) {
        if (round == 0) begun.push_back(&wing);
      } else if (!begun.empty()) {
        pairs.emplace_back(begun.back()->edge, wing.edge);
        wing.matched = begun.back()->matched = true;
        begun.pop_back();
      }
    }
  }
  return pairs;
}

std::vector<DirectedEdge> directed_edges(std::span<const Polygon> polygons) {
  std::vector<DirectedEdge> edges;
  for (std::uint32_t i = 0; i < polygons.size(); ++i) {
    add_loop(polygons[i].outer, false, i, edges);
    for (const auto& hole : polygons[i].holes) {
      add_loop(hole, dot(area_vector(hole), area_vector(polygons[i].outer)) > 0, i, edges);
    }
  }
  return edges;
}

EdgeMatching match_edges(std::span<const Polygon> polygons, double near) {
  DisjointSets sets(polygons.size());
  std::vector<DirectedEdge> unbalanced, crowded;
  const auto unite_pairs = [&](std::vector<DirectedEdge> edges, auto otherwise) {
    sort_by_ends(edges);
    for_each_group(edges, [&](std::span<const DirectedEdge> group) {
      if (group.size() == 2 && net_direction(group) == 0) {
        sets.unite(group[0].polygon, group[1].polygon);
      } else {
        otherwise(group);
      }
    });
  };
  unite_pairs(directed_edges(polygons), [&](std::span<const DirectedEdge> group) {
    auto& rest = net_direction(group) == 0 ? crowded : unbalanced;
    rest.insert(rest.end(), group.begin(), group.end());
  });
  unite_pairs(cut_at_vertices(unbalanced, near),
              [&](std::span<const DirectedEdge> group) { crowded.insert(crowded.end(), group.begin(), group.end()); });

  EdgeMatching matching;
  sort_by_ends(crowded);
  for_each_group(crowded,
                 [&](std::span<const DirectedEdge> group) { match_round_line(group, polygons, sets, matching.open); });

  matching.piece.resize(polygons.size());
  for (std::uint32_t i = 0; i < polygons.size(); ++i) {
    // A root is the first polygon of its piece.
    matching.piece[i] = sets.root(i) == i ? matching.pieces++ : matching.piece[sets.root(i)];
  }
  return matching;
}

}  // namespace exitance
