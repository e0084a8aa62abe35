#include "geometry/edge_matching.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

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

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t i, std::uint32_t j) {
    const std::uint32_t a = root(i), b = root(j);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

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

// Cuts each edge at the ends of the others that lie exactly on it.
std::vector<DirectedEdge> cut_at_vertices(const std::vector<DirectedEdge>& edges) {
  std::vector<const Vec3*> ends;
  for (const DirectedEdge& e : edges) ends.insert(ends.end(), {&e.from, &e.to});
  std::ranges::sort(ends, {}, [](const Vec3* p) { return order(*p); });
  ends.erase(std::unique(ends.begin(), ends.end(), [](const Vec3* p, const Vec3* q) { return *p == *q; }), ends.end());

  std::vector<Box> points(ends.size()), segments(edges.size());
  for (std::size_t i = 0; i < ends.size(); ++i) points[i].extend(*ends[i]);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    segments[i].extend(edges[i].from);
    segments[i].extend(edges[i].to);
  }
  std::vector<std::vector<Vec3>> cuts(edges.size());
  for_each_near_pair(points, segments, [&](std::uint32_t p, std::uint32_t i) {
    const DirectedEdge& e = edges[i];
    const Vec3& v = *ends[p];
    if (v == e.from || v == e.to || !CGAL::collinear(point(e.from), point(v), point(e.to))) return;
    // On the edge's line and in its box, so between its ends.
    cuts[i].push_back(v);
  });

  std::vector<DirectedEdge> pieces;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    // Along a line the order of coordinates is the order of points.
    std::ranges::sort(cuts[i], {}, order);
    if (!runs_up(edges[i])) std::ranges::reverse(cuts[i]);
    Vec3 from = edges[i].from;
    for (const Vec3& v : cuts[i]) pieces.push_back({std::exchange(from, v), v, edges[i].polygon});
    pieces.push_back({from, edges[i].to, edges[i].polygon});
  }
  return pieces;
}

// The edges of a group that remain when edges of opposite direction have cancelled, those of one piece first.
void settle_group(std::span<const DirectedEdge> group, DisjointSets& sets, std::vector<DirectedEdge>& open) {
  std::map<std::uint32_t, int> net_of_piece;
  for (const DirectedEdge& e : group) net_of_piece[sets.root(e.polygon)] += runs_up(e) ? 1 : -1;
  const bool any_up = std::ranges::any_of(net_of_piece, [](const auto& piece) { return piece.second > 0; });
  const bool any_down = std::ranges::any_of(net_of_piece, [](const auto& piece) { return piece.second < 0; });
  if (any_up && any_down) {
    std::uint32_t joined = 0xffffffffu;
    for (const auto& [piece, net] : net_of_piece) {
      if (net == 0) continue;
      if (joined != 0xffffffffu) sets.unite(joined, piece);
      joined = piece;
    }
    net_of_piece.clear();
    for (const DirectedEdge& e : group) net_of_piece[sets.root(e.polygon)] += runs_up(e) ? 1 : -1;
  }
  for (const DirectedEdge& e : group) {
    int& net = net_of_piece[sets.root(e.polygon)];
    if (net == 0 || (net > 0) != runs_up(e)) continue;
    open.push_back(e);
    net += net > 0 ? -1 : 1;
  }
}

}  // namespace

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

EdgeMatching match_edges(std::span<const Polygon> polygons) {
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
  unite_pairs(cut_at_vertices(unbalanced),
              [&](std::span<const DirectedEdge> group) { crowded.insert(crowded.end(), group.begin(), group.end()); });

  EdgeMatching matching;
  sort_by_ends(crowded);
  for_each_group(crowded, [&](std::span<const DirectedEdge> group) { settle_group(group, sets, matching.open); });

  matching.piece.resize(polygons.size());
  for (std::uint32_t i = 0; i < polygons.size(); ++i) {
    // A root is the first polygon of its piece.
    matching.piece[i] = sets.root(i) == i ? matching.pieces++ : matching.piece[sets.root(i)];
  }
  return matching;
}

}  // namespace exitance
