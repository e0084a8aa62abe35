#include "geometry/polygon_soup.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <unordered_map>

#include "geometry/edge_matching.h"
#include "geometry/facets.h"
#include "geometry/level_chain.h"
#include "geometry/level_facets.h"
#include "geometry/point_hash.h"
#include "geometry/polygon_soup_store.h"
#include "geometry/shell.h"

namespace exitance {
namespace {

struct HashPoint {
  std::size_t operator()(const Vec3& p) const { return hash_of(p); }
};

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
}

/// Plane through three corners of a convex loop that are not collinear: the triple (first, k, k + 1) of largest area.
Plane plane_of(std::span<const Vec3> vertices, std::span<const Corner> corners) {
  const Vec3& a = vertices[corners[0].vertex];
  std::size_t best = 1;
  double largest = -1;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    const Vec3 n = cross(vertices[corners[k].vertex] - a, vertices[corners[k + 1].vertex] - a);
    const double size = std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z);
    if (size > largest) {
      largest = size;
      best = k;
    }
  }
  const Vec3& b = vertices[corners[best].vertex];
  const Vec3& c = vertices[corners[best + 1].vertex];
  const Vec3 p = b - a, q = c - a;
  Plane plane;
  plane.origin = a;
  plane.normal = cross(p, q);
  // |p_i q_j| + |p_j q_i| ≤ |p||q|, each product with two roundings of differences, one of its own and one of the
  // subtraction: 4.01 u |p||q|; 5 covers the rounding of the norms.
  plane.normal_error = 5 * kRoundoff * norm(p) * norm(q);
  plane.normal_size = std::max({std::fabs(plane.normal.x), std::fabs(plane.normal.y), std::fabs(plane.normal.z)});
  plane.points = {&a, &b, &c};
  for (int axis = 0; axis < 3; ++axis) {
    if (std::all_of(corners.begin(), corners.end(),
                    [&](const Corner& k) { return vertices[k.vertex][axis] == a[axis]; })) {
      plane.axis = axis;
      Vec3 above = a;
      above[axis] = std::nextafter(a[axis], std::numeric_limits<double>::infinity());
      StageCounts counts;
      plane.axis_sign = orientation(a, b, c, above, counts);
    }
  }
  return plane;
}

}  // namespace

int side_of(const Plane& plane, const Vec3& v, StageCounts& counts) {
  if (plane.axis >= 0) {
    const double c = v[plane.axis], p = plane.origin[plane.axis];
    ++counts.filter;
    return c > p ? plane.axis_sign : c < p ? -plane.axis_sign : 0;
  }
  // The normal's error in each component, and on each product one rounding of the difference, one of its own and at
  // most two of the sum.
  const Vec3 w = v - plane.origin;
  const double value = dot(plane.normal, w);
  const double bound = (1.01 * plane.normal_error + 5 * kRoundoff * plane.normal_size) *
                           (std::fabs(w.x) + std::fabs(w.y) + std::fabs(w.z)) +
                       0x1p-1000;
  if (value > bound || value < -bound) {
    ++counts.filter;
    return value > 0 ? 1 : -1;
  }
  return orientation(*plane.points.a, *plane.points.b, *plane.points.c, v, counts);
}

PolygonSoup::PolygonSoup(std::span<const Polygon> polygons, std::span<const Role> roles, std::span<const Rank> ranks,
                         std::uint32_t spare, Planes planes)
    : store_(std::make_shared<Store>()), planes_(planes) {
  if (!roles.empty() && roles.size() != polygons.size())
    throw std::invalid_argument("PolygonSoup: as many roles as polygons, or none");
  if (!ranks.empty() && ranks.size() != polygons.size())
    throw std::invalid_argument("PolygonSoup: as many ranks as polygons, or none");
  Store& store = *store_;
  store.roles.assign(roles.begin(), roles.end());
  if (roles.empty()) store.roles.assign(polygons.size(), Role::patch);
  store.ranks.assign(ranks.begin(), ranks.end());
  for (std::size_t p = 0; ranks.empty() && p < polygons.size(); ++p) store.ranks.push_back(p);
  store.first_facet.push_back(0);
  Cut cut;
  std::size_t facets = spare, corners = std::size_t{4} * spare;
  for (const Polygon& polygon : polygons) {
    cut.push_back(cut_into_facets(polygon));
    facets += cut.back().size();
    for (const Loop& loop : cut.back()) corners += loop.size();
  }
  store.facets.resize(facets);
  store.first_corners.resize(facets);
  store.corners.reserve(corners);
  if (spare > 0) {
    const std::size_t most = polygons.size() + spare;
    store.vertices.reserve(corners);
    store.shells.reserve(facets / 4 + 1);
    store.roles.reserve(most);
    store.ranks.reserve(most);
    store.first_facet.reserve(most + 1);
    store.behind.reserve(most);
  }
  add_facets(cut, nullptr);
  find_neighbours(0);
  find_shells(0);
  set_spans();
  coplanar_ = Paged<std::vector<std::uint32_t>>(facets_.size());
  find_coplanar();
  for (std::uint32_t f = 0; f < used_ && !store.behind_known; ++f) store.behind_known = is_against_patch(f);
  find_what_is_behind(polygons);
  build_index();
  store_ = store.whole();
}

/// After what was added.
void PolygonSoup::set_spans() {
  const Store& store = *store_;
  vertices_ = store.vertices;
  facets_ = store.facets;
  corners_ = store.corners;
  first_corners_ = store.first_corners;
  shells_ = store.shells;
  roles_ = store.roles;
  first_facet_ = store.first_facet;
  used_ = store.used;
}

/// known: a soup whose vertices are used where they are the same.
void PolygonSoup::add_facets(const Cut& cut, const PolygonSoup* known) {
  Store& store = *store_;
  std::unordered_map<Vec3, std::uint32_t, HashPoint> vertex_of;
  const std::uint32_t first = store.used;
  const auto place_of = [&](const Vec3& point) {
    const auto [place, is_new] = vertex_of.try_emplace(point, static_cast<std::uint32_t>(store.vertices.size()));
    if (!is_new) return place->second;
    if (known != nullptr) {
      const std::uint32_t there = known->vertex_at(point);
      if (there != kNone) return place->second = there;
    }
    store.vertices.push_back(point);
    for (int axis = 0; axis < 3; ++axis) extent_ = std::max(extent_, std::fabs(point[axis]));
    return place->second;
  };
  for (const std::vector<Loop>& loops : cut) {
    const auto polygon = static_cast<std::uint32_t>(store.first_facet.size() - 1);
    for (const Loop& loop : loops) {
      Facet& f = store.facets[store.used++];
      f.first = static_cast<std::uint32_t>(store.corners.size());
      f.count = static_cast<std::uint32_t>(loop.size());
      f.polygon = polygon;
      for (const Vec3& point : loop) store.corners.push_back({point, place_of(point), kNone});
    }
    store.first_facet.push_back(store.used);
  }
  set_spans();
  for (std::uint32_t k = first; k < store.used; ++k) {
    Facet& f = store.facets[k];
    f.plane = plane_of(vertices_, corners(f));
    FirstCorners& of_facet = store.first_corners[k];
    for (std::size_t i = 0; i < 4; ++i) {
      const Corner& c = corners(f)[i < f.count ? i : 0];
      of_facet.x[i] = c.at.x;
      of_facet.y[i] = c.at.y;
      of_facet.z[i] = c.at.z;
      of_facet.vertex[i] = c.vertex;
    }
    of_facet.all = f.count <= 4;
  }
}

/// The vertex at a point, of a facet that is found there; kNone: none.
std::uint32_t PolygonSoup::vertex_at(const Vec3& point) const {
  Box box;
  box.extend(point);
  std::vector<std::uint32_t> near;
  find_facets(box, near);
  for (const std::uint32_t f : near) {
    for (const Corner& c : corners(facets_[f])) {
      if (c.at == point) return c.vertex;
    }
  }
  return kNone;
}

/// Of facets from `first` on, which share no edge with those before.
void PolygonSoup::find_neighbours(std::uint32_t first) {
  Store& store = *store_;
  struct Use {
    std::uint32_t facet, corner, from;
  };
  std::unordered_map<std::uint64_t, std::vector<Use>> uses;
  uses.reserve(store.corners.size() - (first < store.used ? store.facets[first].first : store.corners.size()));
  for (std::uint32_t f = first; f < store.used; ++f) {
    if (roles_[facets_[f].polygon] == Role::unoccluding) continue;
    const auto c = corners(facets_[f]);
    for (std::uint32_t k = 0; k < c.size(); ++k) {
      const std::uint32_t from = c[k].vertex, to = c[(k + 1) % c.size()].vertex;
      uses[edge_key(from, to)].push_back({f, facets_[f].first + k, from});
    }
  }
  const auto join = [&](const Use& one, const Use& other) {
    store.corners[one.corner].neighbour = other.facet;
    store.corners[other.corner].neighbour = one.facet;
  };
  std::vector<DirectedEdge> group;
  for (const auto& [key, use] : uses) {
    const auto up = std::ranges::count(use, use[0].from, &Use::from);
    if (2 * up != std::ssize(use)) continue;
    if (use.size() == 2) {
      join(use[0], use[1]);
      continue;
    }
    // Solids that touch along an edge stay apart.
    if (std::ranges::any_of(use, [&](const Use& u) { return facets_[u.facet].plane.normal == Vec3{}; })) continue;
    group.clear();
    for (const Use& u : use) {
      const auto c = corners(facets_[u.facet]);
      const std::size_t k = u.corner - facets_[u.facet].first;
      group.push_back({c[k].at, c[(k + 1) % c.size()].at, u.facet});
    }
    for (const auto& [i, j] : pairs_round_line(group, [&](std::uint32_t f) { return facets_[f].plane.normal; })) {
      join(use[i], use[j]);
    }
  }
}

/// Of facets from `first` on, whose neighbours are among them.
void PolygonSoup::find_shells(std::uint32_t first) {
  Store& store = *store_;
  StageCounts counts;
  std::vector<bool> visited(store.used - first, false);
  std::vector<std::uint32_t> component;
  for (std::uint32_t seed = first; seed < store.used; ++seed) {
    if (visited[seed - first]) continue;
    component.assign(1, seed);
    visited[seed - first] = true;
    bool closed = true;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    Box box;
    for (std::size_t k = 0; k < component.size(); ++k) {
      const auto c = corners(facets_[component[k]]);
      for (std::size_t i = 0; i < c.size(); ++i) {
        box.extend(vertices_[c[i].vertex]);
        if (i >= 2) triangles.push_back({c[0].vertex, c[i - 1].vertex, c[i].vertex});
        if (c[i].neighbour == kNone) {
          closed = false;
        } else if (!visited[c[i].neighbour - first]) {
          visited[c[i].neighbour - first] = true;
          component.push_back(c[i].neighbour);
        }
      }
    }
    if (!closed || triangles.size() < 4 || !bounds_solid(vertices_, triangles)) continue;
    Shell shell;
    shell.box = box;
    shell.facets = component;
    std::sort(shell.facets.begin(), shell.facets.end());
    shell.convex = true;
    for (const auto f : shell.facets) {
      store.facets[f].shell = store.first_corners[f].shell = static_cast<std::uint32_t>(store.shells.size());
      const auto loop = corners(facets_[f]);
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Corner& c = loop[k];
        shell.vertices.push_back(c.vertex);
        if (f < c.neighbour) shell.edges.push_back({c.vertex, loop[(k + 1) % loop.size()].vertex, f, c.neighbour});
        // Convex along every edge, a closed surface that does not intersect itself is convex as a whole
        // (Tietze–Nakajima).
        for (const Corner& n : corners(facets_[c.neighbour])) {
          shell.convex = shell.convex && side_of(facets_[f].plane, vertices_[n.vertex], counts) <= 0;
        }
      }
    }
    std::sort(shell.vertices.begin(), shell.vertices.end());
    shell.vertices.erase(std::unique(shell.vertices.begin(), shell.vertices.end()), shell.vertices.end());
    store.shells.push_back(std::move(shell));
  }
}

Box PolygonSoup::box_of(std::uint32_t facet) const {
  Box box;
  for (const Corner& c : corners(facets_[facet])) box.extend(c.at);
  return box;
}

/// Whether facet t lies in the plane of f, exactly or by identity.
bool PolygonSoup::lies_in_plane(std::uint32_t t, std::uint32_t f) const {
  StageCounts counts;
  const Plane& plane = facets_[f].plane;
  // Facets of a polygon that is planar but for rounding are in one plane by identity.
  double flat = 0;
  if (facets_[t].polygon == facets_[f].polygon) {
    const Box box = box_of(f);
    flat = 0x1p-40 * norm(box.upper - box.lower) * norm(plane.normal);
  }
  return std::ranges::all_of(corners(facets_[t]), [&](const Corner& c) {
    return std::fabs(dot(plane.normal, c.at - plane.origin)) < flat || side_of(plane, c.at, counts) == 0;
  });
}

/// The same, or whether the two are level.
bool PolygonSoup::is_coplanar(std::uint32_t t, std::uint32_t f) const {
  if (lies_in_plane(t, f)) return true;
  return planes_ == Planes::rounded && facets_[t].polygon != facets_[f].polygon && are_level(*this, t, f, level());
}

void PolygonSoup::find_coplanar() {
  std::vector<Box> boxes(store_->used);
  for (std::uint32_t f = 0; f < boxes.size(); ++f) boxes[f] = box_of(f);
  const SpatialIndex index(boxes);
  const auto occludes = [&](std::uint32_t f) { return roles_[facets_[f].polygon] != Role::unoccluding; };
  std::vector<std::uint32_t> near;
  std::vector<FacetPair> apart;
  for (std::uint32_t f = 0; f < boxes.size(); ++f) {
    near.clear();
    const Box around = boxes[f].grown(pile()), close = boxes[f].grown(level());
    index.find(around, near);
    std::erase_if(near, [&](std::uint32_t t) {
      if (t == f || !occludes(t) || !boxes[t].overlaps(around)) return true;
      if (boxes[t].overlaps(close) && is_coplanar(t, f)) return false;
      if (f < t && occludes(f) && may_end_chain(*this, f, t)) apart.emplace_back(f, t);
      return true;
    });
    if (near.empty()) continue;
    std::sort(near.begin(), near.end());
    coplanar_.set(f, near);
  }
  piled_ = !apart.empty();
  const auto add = [&](std::uint32_t f, std::uint32_t t) {
    std::vector<std::uint32_t> others = coplanar_[f];
    others.insert(std::ranges::lower_bound(others, t), t);
    coplanar_.set(f, std::move(others));
  };
  for (const auto& [f, g] : ends_of_chains(*this, std::move(apart))) {
    add(f, g);
    add(g, f);
  }
}

/// Whether a patch lies against the facet in its plane.
bool PolygonSoup::is_against_patch(std::uint32_t f) const {
  return std::ranges::any_of(coplanar(f), [&](std::uint32_t t) {
    return roles_[facets_[t].polygon] == Role::patch && dot(facets_[t].plane.normal, facets_[f].plane.normal) < 0;
  });
}

/// Behind the last polygons of the soup, where that is to be known.
void PolygonSoup::find_what_is_behind(std::span<const Polygon> polygons) {
  Store& store = *store_;
  const std::size_t first = store.behind.size();
  store.behind.resize(first + polygons.size(), Behind::nothing);
  if (!store.behind_known) return;
  std::ranges::copy(find_matter(polygons, level()), store.behind.begin() + static_cast<std::ptrdiff_t>(first));
}

/// Of the index: the facets from first_facet on, and the convex shells from first_shell on.
std::vector<SpatialIndex::Item> PolygonSoup::items_from(std::uint32_t first_facet, std::uint32_t first_shell) const {
  std::vector<SpatialIndex::Item> items;
  for (std::uint32_t f = first_facet; f < store_->used; ++f) {
    const bool of_convex_shell = facets_[f].shell != kNone && shells_[facets_[f].shell].convex;
    if (roles_[facets_[f].polygon] == Role::unoccluding || of_convex_shell) continue;
    items.push_back({f, box_of(f)});
  }
  const auto facets = static_cast<std::uint32_t>(facets_.size());
  for (std::uint32_t s = first_shell; s < shells_.size(); ++s) {
    if (shells_[s].convex) items.push_back({facets + s, shells_[s].box});
  }
  return items;
}

void PolygonSoup::build_index() {
  std::vector<Box> boxes(facets_.size() + shells_.size());
  for (const SpatialIndex::Item& item : items_from(0, 0)) boxes[item.number] = item.box;
  index_ = SpatialIndex(boxes);
}

void PolygonSoup::prefetch(std::span<const std::uint32_t> items) const {
  prefetch_corners(items);
  for (const std::uint32_t item : items) {
    if (item < facets_.size()) __builtin_prefetch(&facets_[item]);
  }
}

void PolygonSoup::prefetch_corners(std::span<const std::uint32_t> items) const {
  constexpr std::size_t kLine = 64;
  for (const std::uint32_t item : items) {
    if (item >= facets_.size()) continue;
    const char* corners = reinterpret_cast<const char*>(&first_corners_[item]);
    for (std::size_t k = 0; k < sizeof(FirstCorners); k += kLine) __builtin_prefetch(corners + k);
  }
}

/// Where a facet stands among those that lie in its plane, seen from one side: what is less is nearer. It is one order
/// for all of them, so that wherever they overlap exactly one is seen.
std::pair<int, std::int64_t> PolygonSoup::depth_in_plane(std::uint32_t f, bool from_front) const {
  enum { sheet, matter_before, patch, matter_behind, back_of_patch };
  const auto polygon = static_cast<std::int64_t>(store_->ranks[facets_[f].polygon]);
  const Role role = roles_[facets_[f].polygon];
  if (role == Role::sheet) return {sheet, polygon};
  if (role == Role::solid_face) return {from_front ? matter_behind : matter_before, polygon};
  if (from_front) return {patch, -polygon};
  return {is_matter(store_->behind[facets_[f].polygon]) ? matter_before : back_of_patch, polygon};
}

bool PolygonSoup::covers(std::uint32_t t, std::uint32_t f) const {
  if (facets_[t].polygon == facets_[f].polygon) return false;
  const bool same_facing = dot(facets_[t].plane.normal, facets_[f].plane.normal) > 0;
  return depth_in_plane(t, same_facing) < depth_in_plane(f, true);
}

bool PolygonSoup::covers_back(std::uint32_t t, std::uint32_t f) const {
  if (facets_[t].polygon == facets_[f].polygon || roles_[facets_[f].polygon] == Role::unoccluding) return false;
  const bool same_facing = dot(facets_[t].plane.normal, facets_[f].plane.normal) > 0;
  return depth_in_plane(t, !same_facing) < depth_in_plane(f, false);
}

}  // namespace exitance
