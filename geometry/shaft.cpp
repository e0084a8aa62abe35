#include "geometry/shaft.h"

#include <algorithm>

namespace exitance {
namespace {

int dominant_axis(const Vec3& n) {
  const double x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

}  // namespace

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
    for (const Vec3& p : end.points) box_.extend(p);
  }
  facing_ = a.facet != b.facet && !coplanar(a.facet, ends_[1]) && !coplanar(b.facet, ends_[0]) &&
            set_heights(ends_[0], ends_[1]) && set_heights(ends_[1], ends_[0]);
  if (!facing_) return;
  Box all = box_;
  all.extend(soup_.index().bounds());
  const Vec3 size = all.upper - all.lower;
  reach_ = 1.01 * (size.x + size.y + size.z);
  region_.clear(ends_[0].points.front(), reach_);
  for (const End& end : ends_) region_.add(soup_.facets()[end.facet].plane, 1);
  add_sides(ends_[0], ends_[1]);
  add_sides(ends_[1], ends_[0]);
}

/// Whether some of an end lies above the other's plane.
bool Shaft::set_heights(End& end, const End& other) {
  const Plane& plane = soup_.facets()[other.facet].plane;
  end.height.clear();
  bool some = false;
  for (const Vec3& p : end.points) {
    end.height.push_back(static_cast<std::int8_t>(side_of(plane, p, counts_)));
    some = some || end.height.back() > 0;
  }
  if (!some || end.whole) return some;
  // A piece reaches no higher than its facet, whatever rounding says.
  const auto corners = soup_.corners(soup_.facets()[end.facet]);
  return std::any_of(corners.begin(), corners.end(),
                     [&](const Corner& c) { return side_of(plane, c.at, counts_) > 0; });
}

/// Adds the planes that hold an edge of the one end and a vertex of the other above its plane and that support the hull
/// there: the one that is turned farthest outward about the edge. An edge that is none of the hull's has no such plane;
/// planes that support the hull only with vertices below do not bound what is above.
void Shaft::add_sides(const End& one, const End& other) {
  const std::size_t n = one.points.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 &p = one.points[k], &q = one.points[k + 1 < n ? k + 1 : 0];
    if (p == q) continue;
    bool added = false;
    for (std::size_t j = 0; j < other.points.size(); ++j) {
      const Vec3& v = other.points[j];
      if (other.height[j] <= 0 || (added && region_.side(region_.count() - 1, v, counts_) >= 0)) continue;
      if (added) region_.remove_last();
      region_.add(q, p, v);
      added = true;
    }
    if (added && !supports(region_.count() - 1)) region_.remove_last();
  }
}

/// Whether all points of both ends lie inside a plane or on it, and some inside: not when one end crosses the plane of
/// the other, or when rounding has put the plane wrong.
bool Shaft::supports(std::size_t plane) {
  bool some_inside = false;
  for (const End& end : ends_) {
    for (const Vec3& p : end.points) {
      const int side = region_.side(plane, p, counts_);
      if (side < 0) return false;
      some_inside = some_inside || side > 0;
    }
  }
  return some_inside;
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

/// Of a facet in the plane of one end.
Shaft::Overlap Shaft::cover(std::uint32_t facet, std::size_t e) {
  const End& end = ends_[e];
  if (!soup_.covers(facet, end.facet)) return Overlap::outside;
  const Facet &f = soup_.facets()[facet], &of_end = soup_.facets()[end.facet];
  const auto corners = soup_.corners(f);
  set_prism(end.points, of_end.plane.normal);
  prism_.add(soup_.facets()[ends_[1 - e].facet].plane, 1);
  const auto at_sight = prism_.meets_at_sight(corners, counts_);
  if (!(at_sight ? *at_sight : prism_.meets(corners, f.plane.points, counts_))) return Overlap::outside;
  loop_.clear();
  for (const Corner& c : corners) loop_.push_back(c.at);
  set_prism(loop_, f.plane.normal);
  for (const Vec3& v : end.points) {
    for (std::size_t i = 0; i < prism_.count(); ++i) {
      if (prism_.side(i, v, counts_) < 0) return Overlap::partial;
    }
  }
  return Overlap::blocking;
}

/// Whether the shaft lies on one side of a plane: as far as its ends' points tell, or the facets they are pieces of.
bool Shaft::beside(const Plane& plane) {
  const auto on_one_side = [&](const auto& visit) {
    bool front = false, back = false;
    const auto see = [&](const Vec3& v) {
      const int side = side_of(plane, v, counts_);
      front = front || side > 0;
      back = back || side < 0;
      return !(front && back);
    };
    return visit(see);
  };
  if (on_one_side([&](const auto& see) {
        return std::all_of(ends_.begin(), ends_.end(),
                           [&](const End& end) { return std::all_of(end.points.begin(), end.points.end(), see); });
      })) {
    return true;
  }
  if (ends_[0].whole && ends_[1].whole) return false;
  return on_one_side([&](const auto& see) {
    return std::all_of(ends_.begin(), ends_.end(), [&](const End& end) {
      const auto corners = soup_.corners(soup_.facets()[end.facet]);
      return std::all_of(corners.begin(), corners.end(), [&](const Corner& c) { return see(c.at); });
    });
  });
}

bool Shaft::enters(std::uint32_t facet) {
  const Facet& f = soup_.facets()[facet];
  const auto corners = soup_.corners(f);
  if (const auto known = region_.meets_at_sight(corners, counts_)) {
    if (!*known) return false;
    return !beside(f.plane);
  }
  return !beside(f.plane) && region_.meets(corners, f.plane.points, counts_);
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
  return blocks(soup_.facets()[facet]) ? Overlap::blocking : Overlap::partial;
}

Shaft::Overlap Shaft::overlap_of_shell(std::uint32_t index) {
  const Shell& shell = soup_.shells()[index];
  Overlap result = Overlap::outside;
  bool of_end = false;
  for (std::size_t e = 0; e < 2; ++e) {
    of_end = of_end || soup_.facets()[ends_[e].facet].shell == index;
    for (const std::uint32_t t : soup_.coplanar(ends_[e].facet)) {
      if (soup_.facets()[t].shell == index) result = std::max(result, cover(t, e));
    }
  }
  // A convex shell lies behind its own facets.
  if (of_end || result == Overlap::blocking) return result;
  if (!std::any_of(shell.facets.begin(), shell.facets.end(), [&](std::uint32_t f) { return enters(f); })) return result;
  return blocks(shell) ? Overlap::blocking : Overlap::partial;
}

/// Whether every line between the ends crosses a facet that enters: the ends lie on different sides of its plane, and
/// each plane through one of its edges and a point of the one end has all of the other end on its inner side.
bool Shaft::blocks(const Facet& facet) {
  int side[2] = {0, 0};
  for (std::size_t e = 0; e < 2; ++e) {
    for (const Vec3& p : ends_[e].points) {
      const int s = side_of(facet.plane, p, counts_);
      if (s != 0 && side[e] != 0 && s != side[e]) return false;
      if (s != 0) side[e] = s;
    }
  }
  if (side[0] * side[1] >= 0) return false;
  const auto corners = soup_.corners(facet);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 &u = corners[k].at, &v = corners[k + 1 < corners.size() ? k + 1 : 0].at;
    for (const Vec3& a : ends_[0].points) {
      for (const Vec3& b : ends_[1].points) {
        if (orientation(u, v, a, b, counts_) * side[0] > 0) return false;
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
    if (std::isfinite(h.offset)) half_spaces_.push_back(h);
  }
  soup_.index().find(half_spaces_, box_, items);
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
