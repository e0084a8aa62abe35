#include "geometry/polygon_soup.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <stdexcept>
#include <unordered_map>

#include "geometry/edge_matching.h"
#include "geometry/facets.h"
#include "geometry/shell.h"
#include "geometry/surface_pieces.h"

namespace exitance {
namespace {

struct HashPoint {
  std::size_t operator()(const Vec3& p) const {
    std::uint64_t h = 0;
    for (const double c : {p.x, p.y, p.z}) {
      h = (h ^ std::bit_cast<std::uint64_t>(c + 0.0)) * 0x9e3779b97f4a7c15u;  // −0 + 0 is 0, which it equals
      h ^= h >> 32;
    }
    return h;
  }
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

PolygonSoup::PolygonSoup(std::span<const Polygon> polygons, std::span<const Role> roles)
    : roles_(roles.begin(), roles.end()) {
  if (roles.empty()) roles_.assign(polygons.size(), Role::patch);
  if (roles_.size() != polygons.size()) throw std::invalid_argument("PolygonSoup: as many roles as polygons, or none");
  add_facets(polygons);
  find_neighbours();
  find_shells();
  find_coplanar();
  find_closed(polygons);
  build_index();
}

void PolygonSoup::add_facets(std::span<const Polygon> polygons) {
  std::unordered_map<Vec3, std::uint32_t, HashPoint> vertex_of;
  first_facet_.push_back(0);
  for (std::uint32_t p = 0; p < polygons.size(); ++p) {
    for (const Loop& loop : cut_into_facets(polygons[p])) {
      Facet f;
      f.first = static_cast<std::uint32_t>(corners_.size());
      f.count = static_cast<std::uint32_t>(loop.size());
      f.polygon = p;
      for (const Vec3& point : loop) {
        const auto [place, is_new] = vertex_of.try_emplace(point, static_cast<std::uint32_t>(vertices_.size()));
        if (is_new) {
          vertices_.push_back(point);
          for (int axis = 0; axis < 3; ++axis) extent_ = std::max(extent_, std::fabs(point[axis]));
        }
        corners_.push_back({point, place->second, kNone});
      }
      facets_.push_back(f);
    }
    first_facet_.push_back(static_cast<std::uint32_t>(facets_.size()));
  }
  for (Facet& f : facets_) {
    f.plane = plane_of(vertices_, corners(f));
    FirstCorners& first = first_corners_.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      const Corner& c = corners(f)[k < f.count ? k : 0];
      first.x[k] = c.at.x;
      first.y[k] = c.at.y;
      first.z[k] = c.at.z;
      first.vertex[k] = c.vertex;
    }
    first.all = f.count <= 4;
  }
}

void PolygonSoup::find_neighbours() {
  struct Use {
    std::uint32_t facet, corner, from;
  };
  std::unordered_map<std::uint64_t, std::vector<Use>> uses;
  uses.reserve(corners_.size());
  for (std::uint32_t f = 0; f < facets_.size(); ++f) {
    if (roles_[facets_[f].polygon] == Role::unoccluding) continue;
    const auto c = corners(facets_[f]);
    for (std::uint32_t k = 0; k < c.size(); ++k) {
      const std::uint32_t from = c[k].vertex, to = c[(k + 1) % c.size()].vertex;
      uses[edge_key(from, to)].push_back({f, facets_[f].first + k, from});
    }
  }
  const auto join = [&](const Use& one, const Use& other) {
    corners_[one.corner].neighbour = other.facet;
    corners_[other.corner].neighbour = one.facet;
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

void PolygonSoup::find_shells() {
  StageCounts counts;
  std::vector<bool> visited(facets_.size(), false);
  std::vector<std::uint32_t> component;
  for (std::uint32_t seed = 0; seed < facets_.size(); ++seed) {
    if (visited[seed]) continue;
    component.assign(1, seed);
    visited[seed] = true;
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
        } else if (!visited[c[i].neighbour]) {
          visited[c[i].neighbour] = true;
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
      facets_[f].shell = static_cast<std::uint32_t>(shells_.size());
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
    shells_.push_back(std::move(shell));
  }
}

void PolygonSoup::find_coplanar() {
  std::vector<Box> boxes(facets_.size());
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    for (const Corner& c : corners(facets_[f])) boxes[f].extend(vertices_[c.vertex]);
  }
  const SpatialIndex index(boxes);
  StageCounts counts;
  coplanar_first_.assign(1, 0);
  std::vector<std::uint32_t> near;
  for (std::uint32_t f = 0; f < facets_.size(); ++f) {
    near.clear();
    index.find(boxes[f], near);
    std::sort(near.begin(), near.end());
    const Plane& plane = facets_[f].plane;
    for (const auto t : near) {
      if (t == f || roles_[facets_[t].polygon] == Role::unoccluding) continue;
      // Facets of a polygon that is planar but for rounding are in one plane by identity.
      const double flat = facets_[t].polygon == facets_[f].polygon
                              ? 0x1p-40 * norm(boxes[f].upper - boxes[f].lower) * norm(plane.normal)
                              : 0;
      const auto in_plane = [&](const Corner& c) {
        const Vec3& v = vertices_[c.vertex];
        return std::fabs(dot(plane.normal, v - plane.origin)) < flat || side_of(plane, v, counts) == 0;
      };
      const auto c = corners(facets_[t]);
      if (std::all_of(c.begin(), c.end(), in_plane)) coplanar_.push_back(t);
    }
    coplanar_first_.push_back(static_cast<std::uint32_t>(coplanar_.size()));
  }
}

/// Which polygons bound matter on their backs: those of closed pieces of surface, whether they look out (solids) or in
/// (rooms). The two sides of a sheet enclose nothing.
void PolygonSoup::find_closed(std::span<const Polygon> polygons) {
  closed_.assign(polygons.size(), false);
  bool contact = false;
  for (std::uint32_t f = 0; f < facets_.size() && !contact; ++f) {
    for (const std::uint32_t t : coplanar(f)) {
      contact = contact || (roles_[facets_[t].polygon] == Role::patch &&
                            dot(facets_[t].plane.normal, facets_[f].plane.normal) < 0);
    }
  }
  if (!contact) return;
  for (const SurfacePiece& piece : find_surface_pieces(polygons).pieces) {
    if (!piece.closed || piece.volume == 0) continue;
    for (const std::uint32_t p : piece.polygons) closed_[p] = true;
  }
}

void PolygonSoup::build_index() {
  std::vector<Box> boxes(facets_.size() + shells_.size());
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    const bool of_convex_shell = facets_[f].shell != kNone && shells_[facets_[f].shell].convex;
    if (roles_[facets_[f].polygon] == Role::unoccluding || of_convex_shell) continue;
    for (const Corner& c : corners(facets_[f])) boxes[f].extend(vertices_[c.vertex]);
  }
  for (std::size_t s = 0; s < shells_.size(); ++s) {
    if (shells_[s].convex) boxes[facets_.size() + s] = shells_[s].box;
  }
  index_ = SpatialIndex(boxes);
}

void PolygonSoup::prefetch(std::span<const std::uint32_t> items) const {
  constexpr std::size_t kLine = 64;
  for (const std::uint32_t item : items) {
    if (item >= facets_.size()) continue;
    __builtin_prefetch(&facets_[item]);
    const char* corners = reinterpret_cast<const char*>(&first_corners_[item]);
    for (std::size_t k = 0; k < sizeof(FirstCorners); k += kLine) __builtin_prefetch(corners + k);
  }
}

/// Where a facet stands among those that lie in its plane, seen from one side: what is less is nearer. It is one order
/// for all of them, so that wherever they overlap exactly one is seen.
std::pair<int, std::int64_t> PolygonSoup::depth_in_plane(std::uint32_t f, bool from_front) const {
  enum { sheet, matter_before, patch, matter_behind, back_of_patch };
  const std::int64_t polygon = facets_[f].polygon;
  const Role role = roles_[facets_[f].polygon];
  if (role == Role::sheet) return {sheet, polygon};
  if (role == Role::solid_face) return {from_front ? matter_behind : matter_before, polygon};
  if (from_front) return {patch, -polygon};
  return {closed_[facets_[f].polygon] ? matter_before : back_of_patch, polygon};
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
