#include "geometry/shaft.h"

#include <algorithm>

#include "geometry/level_facets.h"

namespace exitance {
namespace {

constexpr int kKnownSidesBits = 12;
constexpr std::int8_t kUnknown = 2;

int dominant_axis(const Vec3& n) {
  const double x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

}  // namespace

Shaft::Shaft(const PolygonSoup& soup)
    : soup_(soup), known_sides_(std::size_t{1} << kKnownSidesBits, ~std::uint64_t{0}) {}

void Shaft::reset(const ShaftEnd& a, const ShaftEnd& b) {
  box_ = {};
  for (std::size_t k = 0; k < 2; ++k) {
    const ShaftEnd& given = k == 0 ? a : b;
    End& end = ends_[k];
    end.facet = given.facet;
    end.whole = given.loop.empty();
    end.points.assign(given.loop.begin(), given.loop.end());
    if (end.whole) {
      for (const Corner& c : soup_.corners(soup_.facets()[end.facet])) end.points.push_back(c.at);
    }
    end.given.assign(end.points.size(), false);
    for (const Vec3& p : end.points) box_.extend(p);
  }
  facing_ = a.facet != b.facet && !coplanar(a.facet, ends_[1]) && !coplanar(b.facet, ends_[0]) &&
            set_heights(ends_[0], ends_[1]) && set_heights(ends_[1], ends_[0]);
  if (!facing_) return;
  coplanarities_.assign(ends_[0].points.size() * ends_[1].points.size(), kUnknown);
  Box all = box_;
  all.extend(soup_.index().bounds());
  const Vec3 size = all.upper - all.lower;
  reach_ = 1.01 * (size.x + size.y + size.z);
  region_.clear(ends_[0].points.front(), reach_);
  for (const End& end : ends_) region_.add(soup_.facets()[end.facet].plane, 1);
  add_sides(0);
  add_sides(1);
}

/// Of all corners of a facet against another facet's plane, exact. Pieces of facets ask this again and again.
Shaft::Sides Shaft::sides_of_facet(std::uint32_t facet, std::uint32_t plane_facet) {
  const std::uint64_t key = (std::uint64_t{facet} << 32 | plane_facet) << 2;  // a soup has fewer than 2^30 facets
  std::uint64_t& place = known_sides_[(facet * 0x9e3779b1u ^ plane_facet * 0x85ebca77u) >> (32 - kKnownSidesBits)];
  if ((place & ~std::uint64_t{3}) != key) {
    std::uint64_t sides = in_plane;
    const Plane& plane = soup_.facets()[plane_facet].plane;
    for (const Corner& c : soup_.corners(soup_.facets()[facet])) {
      const int side = side_of(plane, c.at, counts_);
      sides |= side > 0 ? front : side < 0 ? back : in_plane;
      if (sides == both) break;
    }
    place = key | sides;
  }
  return static_cast<Sides>(place & 3);
}

/// Of an end. A piece lies on the side on which its facet does, whatever rounding says.
Shaft::Sides Shaft::sides_of_end(const End& end, std::uint32_t plane_facet) {
  const Sides of_facet = sides_of_facet(end.facet, plane_facet);
  if (end.whole || of_facet != both) return of_facet;
  const Plane& plane = soup_.facets()[plane_facet].plane;
  int sides = in_plane;
  for (const Vec3& p : end.points) {
    const int side = side_of(plane, p, counts_);
    sides |= side > 0 ? front : side < 0 ? back : in_plane;
    if (sides == both) break;
  }
  return static_cast<Sides>(sides);
}

/// Whether some of an end lies above the other's plane.
bool Shaft::set_heights(End& end, const End& other) {
  if ((sides_of_facet(end.facet, other.facet) & front) == 0) return false;
  const Plane& plane = soup_.facets()[other.facet].plane;
  end.height.clear();
  bool some = false;
  for (const Vec3& p : end.points) {
    end.height.push_back(static_cast<std::int8_t>(side_of(plane, p, counts_)));
    some = some || end.height.back() > 0;
  }
  return some;
}

/// Adds the planes that hold an edge of one end and a vertex of the other above its plane and that support the hull
/// there: the one that is turned farthest outward about the edge. An edge that is none of the hull's has no such plane;
/// planes that support the hull only with vertices below do not bound what is above.
void Shaft::add_sides(std::size_t e) {
  const End &one = ends_[e], &other = ends_[1 - e];
  const std::size_t n = one.points.size(), m = other.points.size();
  const bool above = std::all_of(other.height.begin(), other.height.end(), [](std::int8_t h) { return h > 0; });
  // Whether the other's edge j lies in the plane through edge k and point j: the sign of the point after, where doubles
  // do not tell. The ends ask this of the same four points.
  const auto coplanarity = [&](std::size_t k, std::size_t j) -> std::int8_t& {
    return coplanarities_[e == 0 ? k * m + j : j * n + k];
  };
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 &p = one.points[k], &q = one.points[k + 1 < n ? k + 1 : 0];
    if (p == q || one.given[k]) continue;
    const std::size_t plane = region_.count();
    std::size_t farthest = m;
    for (std::size_t j = 0; j < m; ++j) {
      const Vec3& v = other.points[j];
      if (other.height[j] <= 0) continue;
      if (farthest < m) {
        int side = region_.certain_side(plane, v, counts_);
        if (side == 0) {
          const bool next = j == farthest + 1, last = farthest == 0 && j + 1 == m;
          std::int8_t unshared = kUnknown;
          std::int8_t& known = next ? coplanarity(k, farthest) : last ? coplanarity(k, j) : unshared;
          const int turn = next || !last ? 1 : -1;
          if (known == kUnknown) known = static_cast<std::int8_t>(turn * region_.exact_side(plane, v, counts_));
          side = turn * known;
        }
        if (side >= 0) continue;
        region_.remove_last();
      }
      region_.add(q, p, v);
      farthest = j;
    }
    if (farthest == m) continue;
    // Of whole facets nothing is rounded: there is one order of turning about the edge, and the end is convex.
    if (!(one.whole && above) && !supports(plane, one, other, above ? farthest : m)) {
      region_.remove_last();
      continue;
    }
    // An edge of the other end in this plane would find it once more: above its plane there is no other.
    if (one.height[k] <= 0 && one.height[k + 1 < n ? k + 1 : 0] <= 0) continue;
    auto& given = ends_[1 - e].given;
    if (coplanarity(k, farthest) == 0) given[farthest] = 1;
    if (farthest == 0 && coplanarity(k, m - 1) == 0) given[m - 1] = 1;
  }
}

/// Whether all points of one end and the first of the other lie inside a plane or on it, and some of the one inside:
/// not when one end crosses the plane of the other, or when rounding has put the plane wrong.
bool Shaft::supports(std::size_t plane, const End& one, const End& other, std::size_t count) {
  bool some_inside = false;
  const auto not_outside = [&](const Vec3& p) {
    const int side = region_.side(plane, p, counts_);
    some_inside = some_inside || side > 0;
    return side >= 0;
  };
  return std::all_of(one.points.begin(), one.points.end(), not_outside) && some_inside &&
         std::all_of(other.points.begin(), other.points.begin() + static_cast<std::ptrdiff_t>(count), not_outside);
}

bool Shaft::coplanar(std::uint32_t facet, const End& end) const {
  const auto coplanar = soup_.coplanar(end.facet);
  return std::binary_search(coplanar.begin(), coplanar.end(), facet);
}

/// Makes `prism_` what lies over a convex loop along the largest component of its normal, seen from which it is
/// counter-clockwise. In a plane by identity, whatever is left of rounded points' distances from it is the same along
/// that axis.
void Shaft::set_prism(std::span<const Vec3> loop, const Vec3& normal) {
  const int axis = dominant_axis(normal);
  const double lift = 4 * soup_.extent();
  prism_.clear(loop.front(), reach_ + 2 * lift);
  lifted_.assign(loop.begin(), loop.end());
  for (Vec3& v : lifted_) v[axis] += normal[axis] > 0 ? lift : -lift;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 &p = loop[k], &q = loop[k + 1 < loop.size() ? k + 1 : 0];
    if (p != q) prism_.add(q, p, lifted_[k]);
  }
}

/// Whether the interiors of a facet and of a convex loop in its plane, with this normal, overlap in front of a plane.
bool Shaft::overlap_in_plane(const Facet& facet, std::span<const Vec3> loop, const Vec3& normal,
                             const Plane& in_front) {
  set_prism(loop, normal);
  prism_.add(in_front, 1);
  const auto corners = soup_.corners(facet);
  const auto at_sight = prism_.meets_at_sight(corners, counts_);
  return at_sight ? *at_sight : prism_.meets(corners, facet.plane.points, counts_);
}

/// Of a facet in the plane of one end. A piece overlaps only what its facet overlaps, whatever rounding says.
Shaft::Overlap Shaft::cover(std::uint32_t facet, std::size_t e) {
  const End& end = ends_[e];
  if (!soup_.covers(facet, end.facet)) return Overlap::outside;
  const Facet &f = soup_.facets()[facet], &of_end = soup_.facets()[end.facet];
  const Plane& in_front = soup_.facets()[ends_[1 - e].facet].plane;
  if (!overlap_in_plane(f, end.points, of_end.plane.normal, in_front)) return Overlap::outside;
  const auto loop_of = [&](const Facet& of) {
    loop_.clear();
    for (const Corner& c : soup_.corners(of)) loop_.push_back(c.at);
    return std::span<const Vec3>(loop_);
  };
  if (!end.whole && !overlap_in_plane(f, loop_of(of_end), of_end.plane.normal, in_front)) return Overlap::outside;
  set_prism(loop_of(f), f.plane.normal);
  for (const Vec3& v : end.points) {
    for (std::size_t i = 0; i < prism_.count(); ++i) {
      if (prism_.side(i, v, counts_) < 0) return Overlap::partial;
    }
  }
  return Overlap::blocking;
}

/// Whether the shaft lies on one side of a facet's plane, as far as its ends tell.
bool Shaft::beside(std::uint32_t facet) {
  const Sides first = sides_of_end(ends_[0], facet);
  return first != both && (first | sides_of_end(ends_[1], facet)) != both;
}

bool Shaft::enters(std::uint32_t facet) {
  const Facet& f = soup_.facets()[facet];
  const auto corners = soup_.corners(f);
  const auto at_sight = region_.meets_at_sight(corners, counts_);
  if (at_sight == false || beside(facet)) return false;
  if (!at_sight && !region_.meets(corners, f.plane.points, counts_)) return false;
  // Where the ends meet, or reach below each other's planes, the sides alone do not bound them.
  Box box;
  for (const Corner& c : corners) box.extend(c.at);
  return box_.overlaps(box);
}

Shaft::Overlap Shaft::overlap(std::uint32_t item) {
  if (!facing_) return Overlap::outside;
  const auto facets = static_cast<std::uint32_t>(soup_.facets().size());
  return item < facets ? overlap_of_facet(item) : overlap_of_shell(item - facets);
}

Shaft::Overlap Shaft::overlap_of_facet(std::uint32_t facet) {
  for (const End& end : ends_) {
    if (facet == end.facet) return Overlap::outside;
  }
  for (std::size_t e = 0; e < 2; ++e) {
    if (coplanar(facet, ends_[e])) return cover(facet, e);
  }
  if (!enters(facet)) return Overlap::outside;
  return blocks(facet) ? Overlap::blocking : Overlap::partial;
}

Shaft::Overlap Shaft::overlap_of_shell(std::uint32_t index) {
  const Shell& shell = soup_.shells()[index];
  Overlap result = Overlap::outside;
  bool of_end = false;  // or behind it
  for (std::size_t e = 0; e < 2; ++e) {
    of_end = of_end || soup_.facets()[ends_[e].facet].shell == index;
    for (const std::uint32_t t : soup_.coplanar(ends_[e].facet)) {
      if (soup_.facets()[t].shell != index) continue;
      result = std::max(result, cover(t, e));
      of_end = of_end || (dot(soup_.facets()[t].plane.normal, soup_.facets()[ends_[e].facet].plane.normal) > 0 &&
                          backs(soup_, shell, t, ends_[e].facet, 1));
    }
  }
  // A convex shell lies behind its own facets.
  if (of_end || result == Overlap::blocking) return result;
  if (!std::any_of(shell.facets.begin(), shell.facets.end(), [&](std::uint32_t f) { return enters(f); })) return result;
  return blocks(shell) ? Overlap::blocking : Overlap::partial;
}

/// Whether every line between the ends crosses a facet that enters: the ends lie on different sides of its plane, and
/// each plane through one of its edges and a point of the one end has all of the other end on its inner side.
bool Shaft::blocks(std::uint32_t facet) {
  const Sides first = sides_of_end(ends_[0], facet);
  if (first != front && first != back) return false;
  if (sides_of_end(ends_[1], facet) != (first == front ? back : front)) return false;
  const auto corners = soup_.corners(soup_.facets()[facet]);
  const int outside = first == front ? 1 : -1;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 &u = corners[k].at, &v = corners[k + 1 < corners.size() ? k + 1 : 0].at;
    for (const Vec3& a : ends_[0].points) {
      for (const Vec3& b : ends_[1].points) {
        if (orientation(u, v, a, b, counts_) == outside) return false;
      }
    }
  }
  return true;
}

/// Whether a shell that enters meets the line from each point of the one end to each of the other: then it meets all
/// lines, and its interior those between the ends' interior points. One that has points of both ends inside it may meet
/// a line without its surface crossing it.
bool Shaft::blocks(const Shell& shell) {
  for (const Vec3& a : ends_[0].points) {
    for (const Vec3& b : ends_[1].points) {
      if (!crosses(shell, a, b)) return false;
    }
  }
  const auto vertices = soup_.vertices();
  for (std::size_t e = 0; e < 2; ++e) {
    const auto& points = ends_[e].points;
    if (std::all_of(shell.vertices.begin(), shell.vertices.end(),
                    [&](std::uint32_t v) { return region_.side(e, vertices[v], counts_) >= 0; })) {
      return true;
    }
    if (std::any_of(shell.facets.begin(), shell.facets.end(), [&](std::uint32_t f) {
          return std::all_of(points.begin(), points.end(),
                             [&](const Vec3& p) { return side_of(soup_.facets()[f].plane, p, counts_) >= 0; });
        })) {
      return true;
    }
  }
  return false;
}

/// Whether a line from one point to another meets a convex shell's solid: it starts in it or comes in through a facet.
bool Shaft::crosses(const Shell& shell, const Vec3& from, const Vec3& to) {
  bool starts_inside = true;
  for (const std::uint32_t f : shell.facets) {
    const Facet& facet = soup_.facets()[f];
    const int side = side_of(facet.plane, from, counts_);
    starts_inside = starts_inside && side <= 0;
    if (side <= 0 || side_of(facet.plane, to, counts_) > 0) continue;
    const auto corners = soup_.corners(facet);
    bool inside = true;
    for (std::size_t k = 0; k < corners.size() && inside; ++k) {
      inside = orientation(corners[k].at, corners[k + 1 < corners.size() ? k + 1 : 0].at, from, to, counts_) <= 0;
    }
    if (inside) return true;
  }
  return starts_inside;
}

Shaft::Overlap Shaft::find_occluders(std::vector<std::uint32_t>& items) {
  items.clear();
  if (!facing_) return Overlap::outside;
  half_spaces_.clear();
  for (std::size_t i = 0; i < region_.count(); ++i) {
    const HalfSpace h = region_.half_space(i, soup_.extent());
    const double lowered = h.offset - norm(h.normal) * soup_.pile();
    if (std::isfinite(lowered)) half_spaces_.push_back({h.normal, lowered});
  }
  soup_.index().find(half_spaces_, box_.grown(soup_.pile()), items);
  soup_.prefetch(items);
  Overlap most = Overlap::outside;
  std::erase_if(items, [&](std::uint32_t item) {
    const Overlap o = overlap(item);
    most = std::max(most, o);
    return o == Overlap::outside;
  });
  std::sort(items.begin(), items.end());
  return most;
}

}  // namespace exitance
