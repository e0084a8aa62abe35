#include "geometry/point_shaft.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace exitance {
namespace {

/// So often at most a region is cut to find out whether screens hide a facet together.
constexpr std::uint32_t kMostCuts = 128;

}  // namespace

PointShaft::PointShaft(const PolygonSoup& soup) : soup_(soup) {}

void PointShaft::reset(const Receiver& receiver, const ShaftEnd& shooter) {
  receiver_ = receiver;
  shooter_ = shooter;
  loop_.assign(shooter.loop.begin(), shooter.loop.end());
  const Facet& of_shooter = soup_.facets()[shooter.facet];
  if (loop_.empty()) {
    for (const Corner& c : soup_.corners(of_shooter)) loop_.push_back(c.at);
  }
  half_spaces_.clear();
  outlines_.clear();
  screens_.clear();
  box_ = {};
  box_.extend(receiver_.point);
  for (const Vec3& p : loop_) box_.extend(p);
  empty_ = true;
  if (shooter.facet == receiver.facet) return;
  if (side_of(of_shooter.plane, receiver_.point, counts_) <= 0) return;
  const bool on_facet = receiver_.facet != kNone;
  const auto above = [&](const Vec3& p) {
    return !on_facet || side_of(soup_.facets()[receiver_.facet].plane, p, counts_) > 0;
  };
  if (std::none_of(loop_.begin(), loop_.end(), above)) return;
  empty_ = false;

  Box all = box_;
  all.extend(soup_.index().bounds());
  const Vec3 size = all.upper - all.lower;
  region_.clear(receiver_.point, 1.01 * (size.x + size.y + size.z));
  region_.add(of_shooter.plane, 1);
  if (on_facet) region_.add(soup_.facets()[receiver_.facet].plane, 1);
  for (std::size_t k = 0; k < loop_.size(); ++k) {
    const Vec3 &p = loop_[k], &q = loop_[k + 1 < loop_.size() ? k + 1 : 0];
    if (p != q) region_.add(q, p, receiver_.point);
  }
}

std::span<const HalfSpace> PointShaft::half_spaces() {
  if (half_spaces_.empty()) {
    for (std::size_t i = 0; i < region_.count(); ++i) {
      const HalfSpace h = region_.half_space(i, soup_.extent());
      if (std::isfinite(h.offset)) half_spaces_.push_back(h);
    }
  }
  return half_spaces_;
}

/// Whether a facet is an end's, or another polygon's in its plane: it hides nothing in between.
bool PointShaft::lies_in_an_end(std::uint32_t facet) const {
  const auto lies_in = [&](std::uint32_t end) {
    if (facet == end) return true;
    if (end == kNone) return false;
    return soup_.facets()[facet].polygon != soup_.facets()[end].polygon &&
           std::ranges::binary_search(soup_.coplanar(end), facet);
  };
  return lies_in(receiver_.facet) || lies_in(shooter_.facet);
}

bool PointShaft::enters(std::uint32_t facet) {
  if (empty_ || lies_in_an_end(facet)) return false;
  return meets_region(soup_.facets()[facet]);
}

bool PointShaft::meets_region(const Facet& facet) {
  const auto corners = soup_.corners(facet);
  const auto at_sight = region_.meets_at_sight(corners, counts_);
  return at_sight ? *at_sight : region_.meets(corners, facet.plane.points, counts_);
}

bool PointShaft::blocks(std::uint32_t facet) {
  if (empty_ || lies_in_an_end(facet)) return false;
  const Facet& f = soup_.facets()[facet];
  const int side = side_of(f.plane, receiver_.point, counts_);
  if (side == 0) return false;
  for (const Vec3& p : loop_) {
    if (side_of(f.plane, p, counts_) != -side) return false;
  }
  const auto corners = soup_.corners(f);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 &u = corners[k].at, &v = corners[k + 1 < corners.size() ? k + 1 : 0].at;
    for (const Vec3& p : loop_) {
      // Lines that pass the facet's edge on the inner side, as seen from in front of it.
      if (orientation(u, v, receiver_.point, p, counts_) == side) return false;
    }
  }
  return true;
}

bool PointShaft::blocks(const Shell& shell) {
  if (empty_) return false;
  const auto in_front = [&](const Vec3& v) {
    return std::any_of(shell.facets.begin(), shell.facets.end(),
                       [&](std::uint32_t f) { return side_of(soup_.facets()[f].plane, v, counts_) > 0; });
  };
  if (!in_front(receiver_.point)) return false;
  const auto meets = [&](const Vec3& p) {
    if (!in_front(p)) return false;
    return std::any_of(shell.facets.begin(), shell.facets.end(), [&](std::uint32_t f) {
      const Facet& facet = soup_.facets()[f];
      if (side_of(facet.plane, receiver_.point, counts_) <= 0 || side_of(facet.plane, p, counts_) >= 0) return false;
      const auto corners = soup_.corners(facet);
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Vec3 &u = corners[k].at, &v = corners[k + 1 < corners.size() ? k + 1 : 0].at;
        if (orientation(u, v, receiver_.point, p, counts_) > 0) return false;
      }
      return true;
    });
  };
  return std::all_of(loop_.begin(), loop_.end(), meets);
}

/// Whether all of an item lies in front of the shooter's plane and some of it faces the receiver or turns its back.
bool PointShaft::is_screen(std::uint32_t item) {
  const auto facets = static_cast<std::uint32_t>(soup_.facets().size());
  const Plane& plane = soup_.facets()[shooter_.facet].plane;
  const auto in_front = [&](const Vec3& v) { return side_of(plane, v, counts_) > 0; };
  if (item < facets) {
    const Facet& f = soup_.facets()[item];
    return !lies_in_an_end(item) && side_of(f.plane, receiver_.point, counts_) != 0 &&
           std::ranges::all_of(soup_.corners(f), [&](const Corner& c) { return in_front(c.at); });
  }
  const Shell& shell = soup_.shells()[item - facets];
  return shell.box.overlaps(box_) &&
         std::ranges::any_of(
             shell.facets,
             [&](std::uint32_t f) { return side_of(soup_.facets()[f].plane, receiver_.point, counts_) > 0; }) &&
         std::ranges::all_of(shell.vertices, [&](std::uint32_t v) { return in_front(soup_.vertices()[v]); });
}

/// Whether any of what is seen of a screen is in the pyramid.
bool PointShaft::enters_seen(std::uint32_t item) {
  const auto facets = static_cast<std::uint32_t>(soup_.facets().size());
  if (item < facets) return enters(item);
  return std::ranges::any_of(soup_.shells()[item - facets].facets, [&](std::uint32_t f) {
    return side_of(soup_.facets()[f].plane, receiver_.point, counts_) > 0 && enters(f);
  });
}

/// The facet's edges, or those between what is seen of a convex shell and what is not.
void PointShaft::append_outline(std::uint32_t item) {
  const auto facets = static_cast<std::uint32_t>(soup_.facets().size());
  const auto is_seen = [&](std::uint32_t f) { return side_of(soup_.facets()[f].plane, receiver_.point, counts_) > 0; };
  const auto append = [&](const Vec3& u, const Vec3& v, bool left) {
    outlines_.push_back(left ? OutlineEdge{&u, &v} : OutlineEdge{&v, &u});
  };
  if (item < facets) {
    const auto corners = soup_.corners(soup_.facets()[item]);
    for (std::size_t k = 0; k < corners.size(); ++k)
      append(corners[k].at, corners[k + 1 < corners.size() ? k + 1 : 0].at, is_seen(item));
    return;
  }
  for (const ShellEdge& edge : soup_.shells()[item - facets].edges) {
    const bool left = is_seen(edge.left);
    if (left != is_seen(edge.right)) append(soup_.vertices()[edge.from], soup_.vertices()[edge.to], left);
  }
}

void PointShaft::set_screens(std::span<const std::uint32_t> items) {
  only_entering_ = false;
  for (const std::uint32_t item : items) {
    if (!is_screen(item)) continue;
    const std::size_t first = outlines_.size();
    append_outline(item);
    screens_.push_back({item, first, outlines_.size()});
  }
}

/// Whether a corner of the facet that lies within the pyramid is behind or before no screen: then the facet is not
/// hidden near it.
bool PointShaft::sticks_out(const Facet& facet) {
  const auto is_inside = [&](const Vec3& v) {
    for (std::size_t i = 0; i < region_.count(); ++i) {
      if (region_.side(i, v, counts_) <= 0) return false;
    }
    return true;
  };
  const auto misses = [&](const Vec3& v, const Screen& screen) {
    return std::any_of(outlines_.begin() + static_cast<std::ptrdiff_t>(screen.first),
                       outlines_.begin() + static_cast<std::ptrdiff_t>(screen.last), [&](const OutlineEdge& edge) {
                         return orientation(receiver_.point, *edge.from, *edge.to, v, counts_) > 0;
                       });
  };
  return std::ranges::any_of(soup_.corners(facet), [&](const Corner& c) {
    return is_inside(c.at) && std::ranges::all_of(screens_, [&](const Screen& s) { return misses(c.at, s); });
  });
}

/// Takes the screens' cones, from the receiver, away from the region one by one, each in convex parts: outside of one
/// edge of its outline and inside of those before.
bool PointShaft::rest_is_hidden(const Facet& facet, std::size_t screen) {
  if (cuts_left_ == 0) return false;
  --cuts_left_;
  if (!meets_region(facet)) return true;
  if (screen == screens_.size()) return false;
  const std::size_t planes = region_.count();
  bool hidden = true;
  for (std::size_t k = screens_[screen].first; k < screens_[screen].last && hidden; ++k) {
    const OutlineEdge edge = outlines_[k];
    region_.add(receiver_.point, *edge.from, *edge.to);
    hidden = rest_is_hidden(facet, screen + 1);
    region_.remove_last();
    if (hidden) region_.add(receiver_.point, *edge.to, *edge.from);
  }
  while (region_.count() > planes) region_.remove_last();
  return hidden;
}

bool PointShaft::hidden(std::uint32_t facet) {
  if (empty_ || lies_in_an_end(facet)) return true;
  const Facet& f = soup_.facets()[facet];
  if (side_of(f.plane, receiver_.point, counts_) == 0) return true;
  if (sticks_out(f)) return false;
  if (!std::exchange(only_entering_, true))
    std::erase_if(screens_, [&](const Screen& screen) { return !enters_seen(screen.item); });
  cuts_left_ = kMostCuts;
  return rest_is_hidden(f, 0);
}

}  // namespace exitance
