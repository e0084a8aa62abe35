#include <algorithm>
#include <cmath>

#include "geometry/facets.h"
#include "geometry/level_chain.h"
#include "geometry/polygon_soup_store.h"

namespace exitance {
namespace {

/// What is this near, as a share of the extent, may meet.
constexpr double kBeside = 1e-9;

bool has_both_on_one_side(const Plane& plane, const Vec3& a, const Vec3& b, double near) {
  const double limit = near * norm(plane.normal);
  const double at_a = dot(plane.normal, a - plane.origin), at_b = dot(plane.normal, b - plane.origin);
  return (at_a > limit && at_b > limit) || (at_a < -limit && at_b < -limit);
}

/// Whether ab and cd may run along each other for a stretch.
bool may_overlap(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double near) {
  const double length = norm(b - a);
  if (length <= near) return false;
  const Vec3 along = (1 / length) * (b - a);
  const auto off = [&](const Vec3& p) { return norm(cross(along, p - a)); };
  if (off(c) > near || off(d) > near) return false;
  const double at_c = dot(along, c - a), at_d = dot(along, d - a);
  return std::min(length, std::max(at_c, at_d)) > std::max(0.0, std::min(at_c, at_d)) - near;
}

}  // namespace

/// Facets that are there and whose box touches or overlaps the box.
void PolygonSoup::find_facets(const Box& box, std::vector<std::uint32_t>& found) const {
  std::vector<std::uint32_t> items;
  index_.find(box, items);
  const auto facets = static_cast<std::uint32_t>(facets_.size());
  for (const std::uint32_t item : items) {
    const std::span<const std::uint32_t> of_item =
        item < facets ? std::span(&item, 1) : std::span<const std::uint32_t>(shells_[item - facets].facets);
    for (const std::uint32_t f : of_item) {
      if (box_of(f).overlaps(box)) found.push_back(f);
    }
  }
}

bool PolygonSoup::is_present(std::uint32_t facet) const {
  return facet < used_ &&
         std::ranges::none_of(gone_, [&](const auto& range) { return range.first <= facet && facet < range.second; });
}

/// Whether an edge that facet f or g leaves open comes to the other, or two of their edges may run along each other.
bool PolygonSoup::joins(std::uint32_t f, std::uint32_t g, double near) const {
  const auto open_edge_meets = [&](std::uint32_t of, std::uint32_t other) {
    const auto loop = corners(facets_[of]);
    const Box there = box_of(other).grown(near);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3 &a = loop[k].at, &b = loop[(k + 1) % loop.size()].at;
      Box edge;
      edge.extend(a);
      edge.extend(b);
      if (loop[k].neighbour == kNone && edge.overlaps(there) && !has_both_on_one_side(facets_[other].plane, a, b, near))
        return true;
    }
    return false;
  };
  if (open_edge_meets(f, g) || open_edge_meets(g, f)) return true;
  const auto of_f = corners(facets_[f]), of_g = corners(facets_[g]);
  for (std::size_t i = 0; i < of_f.size(); ++i) {
    for (std::size_t k = 0; k < of_g.size(); ++k) {
      if (may_overlap(of_f[i].at, of_f[(i + 1) % of_f.size()].at, of_g[k].at, of_g[(k + 1) % of_g.size()].at, near))
        return true;
    }
  }
  return false;
}

/// Whether some facet first … last − 1 joins one of the others; appends those that lie beside them.
bool PolygonSoup::joins_others(std::uint32_t first, std::uint32_t last, std::vector<std::uint32_t>& beside) const {
  const double near = kBeside * extent_;
  std::vector<std::uint32_t> found;
  for (std::uint32_t f = first; f < last; ++f) {
    found.clear();
    find_facets(box_of(f).grown(near), found);
    std::erase_if(found, [&](std::uint32_t g) { return first <= g && g < last; });
    if (std::ranges::any_of(found, [&](std::uint32_t g) { return joins(f, g, near); })) return true;
    beside.insert(beside.end(), found.begin(), found.end());
  }
  return false;
}

/// The facets first … last − 1 are gone.
void PolygonSoup::leave(std::uint32_t first, std::uint32_t last) {
  if (first == last) return;
  const auto place = std::ranges::lower_bound(gone_, std::pair(first, last));
  auto own = gone_.insert(place, {first, last});
  if (const auto next = own + 1; next != gone_.end() && next->first == own->second) {
    own->second = next->second;
    gone_.erase(next);
  }
  if (own != gone_.begin() && (own - 1)->second == own->first) {
    (own - 1)->second = own->second;
    gone_.erase(own);
  }
}

/// Of the facets from `first` on, which are new, and those beside them and beside what is gone.
void PolygonSoup::update_coplanar(std::uint32_t first, std::span<const std::uint32_t> beside) {
  for (const std::uint32_t t : beside) {
    std::vector<std::uint32_t> others = coplanar_[t];
    std::erase_if(others, [&](std::uint32_t f) { return !is_present(f); });
    if (others.size() < coplanar_[t].size()) coplanar_.set(t, std::move(others));
  }
  std::vector<std::uint32_t> near;
  for (std::uint32_t f = first; f < used_; ++f) {
    near.clear();
    find_facets(box_of(f).grown(level()), near);
    std::ranges::sort(near);
    for (const std::uint32_t t : near) {
      if (t >= first || !is_coplanar(f, t)) continue;
      std::vector<std::uint32_t> others = coplanar_[t];
      others.push_back(f);
      coplanar_.set(t, std::move(others));
    }
    std::erase_if(near, [&](std::uint32_t t) { return t == f || !is_coplanar(t, f); });
    coplanar_.set(f, near);
  }
}

/// Whether one of the facets first … last − 1 lies in the plane of any other than these.
bool PolygonSoup::lie_on_others(std::uint32_t first, std::uint32_t last) const {
  for (std::uint32_t f = first; f < last; ++f) {
    if (std::ranges::any_of(coplanar(f), [&](std::uint32_t t) { return t < first || last <= t; })) return true;
  }
  return false;
}

/// Whether a facet of another polygon that is not in the plane of f is no farther from it than the ends of chains are.
bool PolygonSoup::is_piled(std::uint32_t f) const {
  if (pile() == 0) return false;
  std::vector<std::uint32_t> near;
  find_facets(box_of(f).grown(pile()), near);
  return std::ranges::any_of(near, [&](std::uint32_t t) {
    return t != f && !std::ranges::binary_search(coplanar(f), t) && may_end_chain(*this, f, t);
  });
}

std::optional<PolygonSoup> PolygonSoup::edited(const PolygonSoup& before, PolygonRange gone, const Arrival& arrival) {
  Store& store = *before.store_;
  store.take_back();
  Cut cut;
  std::size_t facets = 0, corners = 0;
  double extent_coming = 0, extent_leaving = 0;
  const auto include = [](double& extent, const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis) extent = std::max(extent, std::fabs(p[axis]));
  };
  for (const Polygon& polygon : arrival.polygons) {
    cut.push_back(cut_into_facets(polygon));
    facets += cut.back().size();
    for (const Loop& loop : cut.back()) {
      corners += loop.size();
      for (const Vec3& p : loop) include(extent_coming, p);
    }
  }
  if (!store.has_room(arrival.polygons.size(), facets, corners)) return std::nullopt;
  const std::uint32_t gone_first = before.first_facet(gone.first), gone_last = before.first_facet(gone.last);
  std::vector<std::uint32_t> beside, gone_items;
  for (std::uint32_t f = gone_first; f < gone_last; ++f) {
    for (const Corner& c : before.corners(before.facets_[f])) include(extent_leaving, c.at);
    const std::uint32_t shell = before.facets_[f].shell;
    if (shell == kNone || !before.shells_[shell].convex) {
      gone_items.push_back(f);
    } else if (before.shells_[shell].facets.front() == f) {
      gone_items.push_back(static_cast<std::uint32_t>(before.facets_.size()) + shell);
    }
  }
  if (extent_coming > before.extent_) return std::nullopt;
  if (extent_leaving == before.extent_ && extent_coming < before.extent_) return std::nullopt;
  if (before.joins_others(gone_first, gone_last, beside)) return std::nullopt;
  // What goes may be the link of a chain, what comes may become one.
  if (before.piled_ && before.lie_on_others(gone_first, gone_last)) return std::nullopt;
  // What is behind the walls of one room depends on where others are.
  const auto has_room = [&](std::size_t first, std::size_t last) {
    return std::ranges::any_of(std::span(store.behind).subspan(first, last - first), is_of_room);
  };
  if (has_room(gone.first, gone.last)) return std::nullopt;

  PolygonSoup after;
  after.store_ = before.store_;
  after.coplanar_ = before.coplanar_;
  after.gone_ = before.gone_;
  after.extent_ = before.extent_;
  after.planes_ = before.planes_;
  after.piled_ = before.piled_;
  const std::uint32_t first = store.used;
  const auto first_shell = static_cast<std::uint32_t>(store.shells.size());
  const auto first_polygon = static_cast<std::uint32_t>(store.roles.size());
  after.leave(gone_first, gone_last);
  after.leave(before.used_, first);  // of other soups that share
  after.arrived_ = {first_polygon, first_polygon + static_cast<std::uint32_t>(arrival.polygons.size())};
  store.roles.insert(store.roles.end(), arrival.roles.begin(), arrival.roles.end());
  store.ranks.insert(store.ranks.end(), arrival.ranks.begin(), arrival.ranks.end());
  after.add_facets(cut, &before);
  after.find_neighbours(first);
  after.find_shells(first);
  after.set_spans();
  after.find_what_is_behind(arrival.polygons);
  if (has_room(first_polygon, store.behind.size())) return std::nullopt;
  after.index_ = before.index_.changed(gone_items, after.items_from(first, first_shell));
  if (after.joins_others(first, store.used, beside)) return std::nullopt;
  std::ranges::sort(beside);
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  after.update_coplanar(first, beside);
  after.touched_ = beside;
  for (std::uint32_t f = first; f < store.used; ++f) after.touched_.push_back(f);
  if (after.piled_ && after.lie_on_others(first, store.used)) return std::nullopt;
  for (std::uint32_t f = first; f < store.used; ++f) {
    if (after.is_piled(f)) return std::nullopt;
  }
  if (!store.behind_known &&
      std::ranges::any_of(after.touched_, [&](std::uint32_t f) { return after.is_against_patch(f); }))
    return std::nullopt;
  after.store_ = store.whole();
  return after;
}

}  // namespace exitance
