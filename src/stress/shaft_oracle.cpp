#include "src/stress/shaft_oracle.h"

#include <algorithm>

namespace exitance {
namespace {

using Rational = ExactKernel::FT;
using Vector = ExactKernel::Vector_3;
using Overlap = Shaft::Overlap;

/// Whether the segment meets the closed facet; a segment in its plane tells nothing and counts as meeting it.
bool meets_facet(const ExactLoop& loop, const ExactSide& plane, const ExactPoint& from, const ExactPoint& to) {
  const Rational at_from = plane.value(from), at_to = plane.value(to);
  if (at_from == 0 && at_to == 0) return true;
  if (CGAL::sign(at_from) * CGAL::sign(at_to) > 0) return false;
  const ExactPoint p = from + (at_from / (at_from - at_to)) * (to - from);
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const ExactPoint &u = loop[k], &v = loop[(k + 1) % loop.size()];
    if (CGAL::cross_product(v - u, p - u) * plane.normal < 0) return false;
  }
  return true;
}

bool meets_solid(const ExactItem& solid, const ExactPoint& from, const ExactPoint& to) {
  Rational first = 0, last = 1;
  for (const ExactSide& s : solid.planes) {
    const Rational at_from = s.value(from), at_to = s.value(to);  // inside where negative
    if (at_from > 0 && at_to > 0) return false;
    if (at_from <= 0 && at_to <= 0) continue;
    const Rational t = at_from / (at_from - at_to);
    if (at_from > 0) first = std::max(first, t);
    if (at_to > 0) last = std::min(last, t);
  }
  return first <= last;
}

bool blocks_all(const ExactEnd& a, const ExactEnd& b, const ExactItem& item) {
  for (const ExactPoint& p : a.points) {
    for (const ExactPoint& q : b.points) {
      if (!(item.solid ? meets_solid(item, p, q) : meets_facet(item.loops[0], item.planes[0], p, q))) return false;
    }
  }
  return !item.solid || !reaches_into(a.points, item) || !reaches_into(b.points, item);
}

/// Whether facets in one plane overlap on a positive area above some plane, and whether the first holds all of the
/// second.
struct Contact {
  bool overlap = true, holds = true;
};
Contact contact_of(const ExactLoop& facet, const ExactSide& plane, const ExactLoop& end, const ExactSide& above) {
  Contact contact;
  ExactLoop left = clipped(end, above);
  for (std::size_t k = 0; k < facet.size(); ++k) {
    const ExactPoint &u = facet[k], &v = facet[(k + 1) % facet.size()];
    const ExactSide inner{u, CGAL::cross_product(plane.normal, v - u)};
    contact.holds = contact.holds && std::ranges::all_of(end, [&](const ExactPoint& p) { return inner.sign(p) >= 0; });
    left = clipped(left, inner);
  }
  contact.overlap = has_area(left);
  contact.holds = contact.holds && contact.overlap;
  return contact;
}

}  // namespace

bool meets_open(const ExactLoop& loop, const std::vector<ExactSide>& sides) {
  ExactLoop left = loop;
  for (const ExactSide& s : sides) {
    left = clipped(left, s);
    if (left.empty()) return false;
  }
  const ExactPoint middle = exact_mean(left);
  return std::ranges::all_of(sides, [&](const ExactSide& s) { return s.sign(middle) > 0; });
}

std::vector<ExactSide> sides_of_hull(const ExactEnd& a, const ExactEnd& b) {
  ExactLoop all = a.points;
  all.insert(all.end(), b.points.begin(), b.points.end());
  std::vector<ExactSide> sides{a.plane, b.plane};
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        ExactSide side{all[i], CGAL::cross_product(all[j] - all[i], all[k] - all[i])};
        if (side.normal == CGAL::NULL_VECTOR) continue;
        bool in = false, out = false;
        for (const ExactPoint& p : all) {
          const int s = side.sign(p);
          in = in || s > 0;
          out = out || s < 0;
          if (in && out) break;
        }
        if (in && out) continue;
        if (out) side.normal = -side.normal;
        sides.push_back(side);
      }
    }
  }
  return sides;
}

Lines look_along_lines(const ExactEnd& a, const ExactEnd& b, const ExactItem& item, int count, Random& random) {
  const auto inner_point = [&](const ExactLoop& points) {
    Vector sum = CGAL::NULL_VECTOR;
    int weights = 0;
    for (const ExactPoint& p : points) {
      const int w = random.whole(0, 3) == 0 ? 1 : random.whole(1, 400);
      sum = sum + Rational(w) * (p - CGAL::ORIGIN);
      weights += w;
    }
    return CGAL::ORIGIN + sum / Rational(weights);
  };
  Lines lines;
  for (int k = 0; k < count; ++k) {
    const ExactPoint p = inner_point(a.points), q = inner_point(b.points);
    if (a.plane.sign(q) <= 0 || b.plane.sign(p) <= 0) continue;
    ++lines.seen;
    bool blocked = false;
    for (std::size_t f = 0; f < item.loops.size() && !blocked; ++f) {
      blocked = item.planes[f].sign(p) * item.planes[f].sign(q) < 0 && meets_facet(item.loops[f], item.planes[f], p, q);
    }
    lines.blocked += blocked;
  }
  return lines;
}

bool plainly_separated(const ExactEnd& a, const ExactEnd& b, const ExactItem& shell) {
  for (const ExactEnd* end : {&a, &b}) {
    const auto in_front = [](const ExactLoop& points, const ExactSide& s) {
      return std::ranges::all_of(points, [&](const ExactPoint& p) { return s.sign(p) >= 0; });
    };
    if (std::ranges::all_of(shell.loops, [&](const ExactLoop& l) { return in_front(l, end->plane); })) return true;
    if (std::ranges::any_of(shell.planes, [&](const ExactSide& s) { return in_front(end->points, s); })) return true;
  }
  return false;
}

bool reaches_into(const ExactLoop& loop, const ExactItem& shell) {
  std::vector<ExactSide> inner;
  for (const ExactSide& s : shell.planes) inner.push_back({s.origin, -s.normal});
  return meets_open(loop, inner);
}

std::vector<std::uint32_t> items_of(const PolygonSoup& soup) {
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  std::vector<std::uint32_t> items;
  for (std::uint32_t f = 0; f < facets; ++f) {
    const std::uint32_t shell = soup.facets()[f].shell;
    const bool occludes = soup.is_present(f) && soup.role(soup.facets()[f].polygon) != Role::unoccluding;
    if (occludes && (shell == kNone || !soup.shells()[shell].convex)) items.push_back(f);
  }
  for (std::uint32_t s = 0; s < soup.shells().size(); ++s) {
    if (soup.shells()[s].convex) items.push_back(facets + s);
  }
  return items;
}

ShaftOracle::ShaftOracle(const PolygonSoup& soup) : soup_(soup) {
  for (const Facet& f : soup.facets()) {
    ExactLoop loop;
    for (const Corner& c : soup.corners(f)) loop.push_back(exact_point(c.at));
    planes_.push_back(exact_plane(loop));
    loops_.push_back(std::move(loop));
  }
}

ExactEnd ShaftOracle::end(const ShaftEnd& given) const {
  ExactEnd end{given.facet, loops_[given.facet], planes_[given.facet]};
  if (!given.loop.empty()) end.points.clear();
  for (const Vec3& p : given.loop) end.points.push_back(exact_point(p));
  return end;
}

ExactItem ShaftOracle::item(std::uint32_t index) const {
  if (index < loops_.size()) return {{loops_[index]}, {planes_[index]}, false};
  ExactItem item;
  item.solid = true;
  for (const std::uint32_t f : facets_of(index)) {
    item.loops.push_back(loops_[f]);
    item.planes.push_back(planes_[f]);
  }
  return item;
}

bool ShaftOracle::face_each_other(const ExactEnd& a, const ExactEnd& b) const {
  const auto above = [](const ExactEnd& end, const ExactEnd& other) {
    return std::ranges::any_of(end.points, [&](const ExactPoint& p) { return other.plane.sign(p) > 0; });
  };
  return above(a, b) && above(b, a);
}

bool ShaftOracle::in_one_plane(std::uint32_t t, std::uint32_t f) const {
  if (t == f) return false;
  if (soup_.facets()[t].polygon == soup_.facets()[f].polygon) {
    return std::ranges::binary_search(soup_.coplanar(f), t);
  }
  return std::ranges::all_of(loops_[t], [&](const ExactPoint& p) { return planes_[f].sign(p) == 0; });
}

std::vector<std::uint32_t> ShaftOracle::facets_of(std::uint32_t index) const {
  if (index < loops_.size()) return {index};
  return soup_.shells()[index - loops_.size()].facets;
}

bool ShaftOracle::touches_plane(std::uint32_t index, std::uint32_t f) const {
  return std::ranges::any_of(facets_of(index), [&](std::uint32_t t) { return in_one_plane(t, f); });
}

/// The rules of Role for what only occludes and a patch; the order of others is left to the soup.
bool ShaftOracle::covers(std::uint32_t t, std::uint32_t f) const {
  const std::uint32_t above = soup_.facets()[t].polygon, below = soup_.facets()[f].polygon;
  if (above == below) return false;
  if (soup_.role(below) == Role::patch && soup_.role(above) == Role::sheet) return true;
  if (soup_.role(below) == Role::patch && soup_.role(above) == Role::solid_face) {
    return planes_[t].normal * planes_[f].normal < 0;
  }
  return std::ranges::binary_search(soup_.coplanar(f), t) && soup_.covers(t, f);
}

Overlap ShaftOracle::overlap(const ExactEnd& a, const ExactEnd& b, const std::vector<ExactSide>& sides,
                             std::uint32_t index) const {
  if (index == a.facet || index == b.facet) return Overlap::outside;
  const ExactItem candidate = item(index);
  Overlap most = Overlap::outside;
  bool in_plane_of_end = false;
  for (const ExactEnd* end : {&a, &b}) {
    for (const std::uint32_t t : facets_of(index)) {
      if (!in_one_plane(t, end->facet)) continue;
      in_plane_of_end = true;
      if (!covers(t, end->facet)) continue;
      const Contact contact = contact_of(loops_[t], planes_[t], end->points, end == &a ? b.plane : a.plane);
      if (contact.overlap) most = std::max(most, contact.holds ? Overlap::blocking : Overlap::partial);
    }
  }
  if (in_plane_of_end && !candidate.solid) return most;  // even where it is so up to rounding only
  if (std::ranges::none_of(candidate.loops, [&](const ExactLoop& l) { return meets_open(l, sides); })) return most;
  return std::max(most, blocks_all(a, b, candidate) ? Overlap::blocking : Overlap::partial);
}

}  // namespace exitance
