#pragma once
// The visible part of one convex source behind convex occluders: its boundary, as stretches of their edges.
//
// No region is built. The visible region is V = cone(source) − ∪ cone(occluder); a point of an edge that lies on no
// other edge bounds V exactly where it is covered by no other occluder. Where edges coincide, what lies to their left
// and right decides: an occluder covers the side of the line that it lies on; of occluder edges with the occluder on
// the same side one (the first added) stands for all; an occluder edge on the source's boundary bounds nothing.
// Coincidences, and so all degenerate positions, are decided by exact signs; crossings of edges are rounded parameters
// with error bounds, and an interval that is wrong by a rounding costs no more than a rounding.
//
//  - An occluder counts only with its part strictly in front of the source's plane. Where it pierces that plane, and
//  the
//    source lies on both sides of its own plane, it is cut along the line of both planes, which becomes an edge like
//    others. Otherwise the cone of its rest is separated from the source's cone, or adds nothing within it.
//  - One that lies in the source's plane counts whole if it covers the side of the source that is seen
//  (polygon_soup.h),
//    else not at all.
//  - Edge-on occluders hide nothing.

#include <algorithm>
#include <deque>
#include <span>
#include <utility>

#include "geometry/chart.h"
#include "geometry/cone.h"
#include "geometry/view.h"

namespace exitance {

/// A stretch of the visible region's boundary.
template <class Real>
struct Arc {
  const Cone<Real>* cone = nullptr;
  const ConeSide<Real>* side = nullptr;
  Real t0{}, t1{};
  Real t0_error{}, t1_error{};
  bool of_source = true;
};

/// What hides: a facet, or a convex shell as a whole, whose front faces are seen as one convex cone.
struct Occluder {
  std::uint32_t facet = kNone, shell = kNone;
};

template <class Real>
class VisibleRegion {
 public:
  /// Corners of a polygon, input points.
  using Corners = std::span<const Vec3* const>;

  explicit VisibleRegion(View& view) : view_(view), soup_(view.soup()) {}

  /// Starts on a source in a facet's plane, seen from the view's point, which lies strictly on side `facing` (±1) of
  /// that plane. Its corners run counter-clockwise seen from the facet's front; `horizon`: the sign of each against the
  /// receiver's horizon. False when no part of it is above the horizon.
  bool set_source(std::uint32_t facet, int facing, Corners corners, std::span<const int> horizon);

  /// How wrong [rad] the end of an arc may be before exact arithmetic is asked; at first 2^-46.
  void set_bearable_angle(double angle) { bearable_angle_ = angle; }

  enum class Effect { none, part, whole };

  /// Whether an occluder, which may be added, hides all of the source. Leaves the source with no occluders.
  bool hides(const Occluder& occluder) {
    const bool whole = add(occluder) == Effect::whole;
    count_ = 0;
    for (auto& covered : covered_source_) covered.clear();
    return whole;
  }

  /// Adds an occluder. A shell must be convex, with the point outside its box and all of it on the point's side of the
  /// source's plane (place_of).
  Effect add(const Occluder& occluder);

  enum class Place { nowhere, in_front, across };

  /// Where the part of a shell that is above the horizon lies: nowhere in front of the source's plane, nowhere behind
  /// it, or on both sides.
  Place place_of(const Shell& shell);

  /// Calls sink(arc) for every stretch of the boundary, and for those that are empty but might not be without rounding.
  template <class Sink>
  void for_each_arc(const Sink& sink);

  std::size_t occluder_count() const { return count_; }
  std::uint32_t source_facet() const { return source_facet_; }
  const Cone<Real>& source() const { return source_; }

 private:
  /// An occluder's cone and, of each side's edge, the stretch within the source's cone.
  struct Added {
    const Cone<Real>* cone = nullptr;
    Cone<Real> clipped;
    std::vector<Stretch<Real>> edges;  // empty: bounds nothing
    bool bounds = false;               // whether any edge does
  };

  Effect add_facet(std::uint32_t facet);
  Effect add_cone(Added& added);

  /// Of corners that run counter-clockwise seen from the front: seen from there, det(c − x, d − x, v − x) is negative
  /// inside, so that sign is −1 where x is in front.
  void set_cone(Cone<Real>& cone, Corners corners, int sign, bool on_source);
  const Cone<Real>& cone_of_facet(std::uint32_t facet);
  const Cone<Real>& cone_of_shell(std::uint32_t shell);
  void set_facet_cone(Cone<Real>& cone, std::uint32_t facet);
  void drop_below_horizon(Cone<Real>& cone);
  Cone<Real>* cached(std::uint32_t item, bool& is_new);

  Signed<Real> plane_value(const Plane& plane, const Vec3& v, int sign) const;
  ConeSide<Real> closing_cut(const Plane& T, int facing_occluder) const;
  void cover(const Added& a, const Added& b, bool b_first);
  /// row_: values of a side's functional at the corners of another cone.
  void fill_row(const ConeSide<Real>& side, const Cone<Real>& cone);
  bool lies_in(const ConeSide<Real>& edge) const { return row_[edge.from].sign == 0 && row_[edge.to].sign == 0; }
  void narrow_along(Stretch<Real>& stretch, const Cone<Real>& cone, const ConeSide<Real>& edge,
                    const ConeSide<Real>& side);

  template <class Sink>
  void finish_edge(const Cone<Real>& cone, const ConeSide<Real>& side, const Stretch<Real>& edge,
                   std::vector<Stretch<Real>>& covered, bool of_source, const Sink& sink);

  View& view_;
  const PolygonSoup& soup_;
  ViewFrame frame_;
  std::uint32_t source_facet_ = kNone;
  const Plane* source_plane_ = nullptr;
  int facing_source_ = 1;
  double bearable_angle_ = 0x1p-46;
  Cone<Real> source_;
  std::deque<Added> added_;  // count_ of them in use; they may point into themselves
  std::size_t count_ = 0;
  std::vector<std::vector<Stretch<Real>>> covered_source_;  // by source side
  std::vector<std::vector<Stretch<Real>>> covered_;         // by side of the occluder being finished
  std::vector<Signed<Real>> row_, weight_;
  std::vector<Stretch<Real>> within_;
  std::vector<const Vec3*> corners_;
  std::vector<int> corner_sides_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ring_;
  Chart chart_;

  // Cones of the current view, kept because every occluder is met on the way to many sources.
  struct Slot {
    std::uint32_t epoch = 0, cone = 0;
  };
  std::vector<Slot> slots_;  // by facet, then by shell
  std::deque<Cone<Real>> cones_;
  std::uint32_t cones_epoch_ = 0, cones_used_ = 0;
};

template <class Real>
void VisibleRegion<Real>::set_cone(Cone<Real>& cone, Corners corners, int sign, bool on_source) {
  cone.clear();
  const auto n = static_cast<std::uint32_t>(corners.size());
  for (const Vec3* v : corners) {
    ConeCorner<Real> c;
    c.w = difference<Real>(*v, frame_.x);
    c.length = norm(c.w);
    c.exact = {ViewPoint::Kind::vertex, on_source, 0, v, nullptr};
    cone.corners.push_back(c);
  }
  for (std::uint32_t k = 0; k < n; ++k) {
    ConeSide<Real> side;
    side.from = k;
    side.to = (k + 1) % n;
    set_edge_plane(side, frame_.x, cone.corners[side.from], cone.corners[side.to], sign);
    cone.sides.push_back(side);
  }
}

template <class Real>
bool VisibleRegion<Real>::set_source(std::uint32_t facet, int facing, Corners corners, std::span<const int> horizon) {
  source_facet_ = facet;
  source_plane_ = &soup_.facets()[facet].plane;
  frame_ = {view_.receiver().point, view_.receiver().normal, source_plane_->points};
  facing_source_ = facing;
  count_ = 0;
  if (std::none_of(horizon.begin(), horizon.end(), [](int s) { return s > 0; })) return false;
  set_cone(source_, corners, -facing, true);
  if (std::any_of(horizon.begin(), horizon.end(), [](int s) { return s < 0; })) {
    ConeSide<Real> closing;
    closing.m = {Real(frame_.normal.x), Real(frame_.normal.y), Real(frame_.normal.z)};
    closing.length = norm(closing.m);
    closing.error = 5 * roundoff<Real>() * closing.length;
    closing.exact = {ViewPlane::Kind::horizon, 1, nullptr, nullptr, {}};
    weight_.clear();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (horizon[k] == 0) {
        weight_.push_back({Real(0), Real(0), 0});
        continue;
      }
      // Of corners near the horizon, as of an edge shared with the receiver's surface, rounding would leave only noise.
      const ConeCorner<Real>& corner = source_.corners[k];
      const Signed<Real> value{dot(closing.m, corner.w), closing.error * corner.length, horizon[k]};
      const bool is_clear = value.value * horizon[k] > 0x1p20 * value.error;
      weight_.push_back(is_clear ? value : refined_value_at(closing, corner, frame_, view_.counts()));
    }
    clip(source_, weight_, ViewPoint::Kind::at_horizon, closing);
  }
  if (covered_source_.size() < source_.sides.size()) covered_source_.resize(source_.sides.size());
  for (auto& c : covered_source_) c.clear();
  chart_.centre_on(source_);
  return true;
}

/// Value of a plane's functional at an input point, times sign, with its exact sign.
template <class Real>
Signed<Real> VisibleRegion<Real>::plane_value(const Plane& plane, const Vec3& v, int sign) const {
  const PlanePoints& T = plane.points;
  const Vec<Real> p = difference<Real>(*T.b, *T.a), q = difference<Real>(*T.c, *T.a), w = difference<Real>(v, *T.a);
  const Real value = sign * dot(cross(p, q), w);
  const Real error = 12 * roundoff<Real>() * norm(p) * norm(q) * norm(w);  // as in set_edge_plane
  if (value > 0x1p20 * error || value < -0x1p20 * error) return {value, error, value > 0 ? 1 : -1};
  const ExactValue exact = exact_plane_value(T, v);
  return {Real(sign * exact.value), Real(exact.error), sign * exact.sign};
}

/// The plane through x and the line of the source's plane S and the occluder's plane T, S(x) T(v) − T(x) S(v): positive
/// where T hides S from x.
template <class Real>
ConeSide<Real> VisibleRegion<Real>::closing_cut(const Plane& T, int facing_occluder) const {
  using std::fabs;
  const auto normal_of = [](const PlanePoints& plane, Real& error) {
    const Vec<Real> p = difference<Real>(*plane.b, *plane.a), q = difference<Real>(*plane.c, *plane.a);
    error = 8 * roundoff<Real>() * norm(p) * norm(q);
    return cross(p, q);
  };
  Real error_S, error_T;
  const Vec<Real> n_S = normal_of(frame_.S, error_S), n_T = normal_of(T.points, error_T);
  const Signed<Real> S = plane_value(*source_plane_, frame_.x, 1), t = plane_value(T, frame_.x, 1);
  const int sign = -facing_source_ * facing_occluder;
  ConeSide<Real> side;
  side.m = Real(sign) * (S.value * n_T - t.value * n_S);
  side.length = norm(side.m);
  const Real norm_S = norm(n_S), norm_T = norm(n_T), size_S = fabs(S.value), size_T = fabs(t.value);
  side.error = 2 * (size_S * error_T + size_T * error_S + S.error * norm_T + t.error * norm_S +
                    4 * roundoff<Real>() * (size_S * norm_T + size_T * norm_S));
  side.exact = {ViewPlane::Kind::cut, sign, nullptr, nullptr, T.points};
  return side;
}

template <class Real>
void VisibleRegion<Real>::fill_row(const ConeSide<Real>& side, const Cone<Real>& cone) {
  row_.clear();
  for (const auto& c : cone.corners) row_.push_back(value_at(side, c, frame_, view_.counts()));
}

/// Narrows a stretch of an edge of the cone whose row is filled to where it is inside of the side.
template <class Real>
void VisibleRegion<Real>::narrow_along(Stretch<Real>& stretch, const Cone<Real>& cone, const ConeSide<Real>& edge,
                                       const ConeSide<Real>& side) {
  narrow(stretch, row_[edge.from], row_[edge.to], Real(bearable_angle_ / (edge.sweep + bearable_angle_ * 0x1p20)), [&] {
    if constexpr (!std::is_same_v<Real, double>) return;
    for (const std::uint32_t k : {edge.from, edge.to}) {
      row_[k] = refined_value_at(side, cone.corners[k], frame_, view_.counts());
    }
  });
}

/// A place for the cone of a facet, or a shell after all facets, in the current view.
template <class Real>
Cone<Real>* VisibleRegion<Real>::cached(std::uint32_t item, bool& is_new) {
  if (slots_.empty()) slots_.resize(soup_.facets().size() + soup_.shells().size());
  if (cones_epoch_ != view_.epoch()) {
    cones_epoch_ = view_.epoch();
    cones_used_ = 0;
  }
  Slot& slot = slots_[item];
  is_new = slot.epoch != cones_epoch_;
  if (is_new) {
    slot = {cones_epoch_, cones_used_++};
    if (cones_.size() < cones_used_) cones_.emplace_back();
  }
  return &cones_[slot.cone];
}

/// Of a cone with a part above the horizon: an edge on or below the horizon bounds nothing, and above the horizon the
/// cone is the same without it, because the cut of a convex cone by the horizon has its closing side in the horizon
/// itself.
template <class Real>
void VisibleRegion<Real>::drop_below_horizon(Cone<Real>& cone) {
  std::erase_if(cone.sides, [&](const ConeSide<Real>& side) { return side.below_horizon; });
}

template <class Real>
void VisibleRegion<Real>::set_facet_cone(Cone<Real>& cone, std::uint32_t facet) {
  const Facet& f = soup_.facets()[facet];
  const auto loop = soup_.corners(f);
  corners_.clear();
  for (const Corner& c : loop) corners_.push_back(&soup_.vertices()[c.vertex]);
  set_cone(cone, corners_, -view_.facing(facet), false);
  for (std::size_t k = 0; k < loop.size(); ++k) {
    cone.sides[k].across = loop[k].neighbour;
    cone.sides[k].below_horizon =
        view_.horizon(loop[k].vertex) <= 0 && view_.horizon(loop[(k + 1) % loop.size()].vertex) <= 0;
  }
}

template <class Real>
const Cone<Real>& VisibleRegion<Real>::cone_of_facet(std::uint32_t facet) {
  bool is_new = false;
  Cone<Real>& cone = *cached(facet, is_new);
  if (is_new) {
    set_facet_cone(cone, facet);
    drop_below_horizon(cone);
  }
  return cone;
}

/// The silhouette of a convex shell: the edges between faces that are seen from the front and others. A face in the
/// receiver's plane counts by the side on which the rounded point lies; without it the ring might not be convex.
template <class Real>
const Cone<Real>& VisibleRegion<Real>::cone_of_shell(std::uint32_t shell) {
  bool is_new = false;
  Cone<Real>& cone = *cached(static_cast<std::uint32_t>(soup_.facets().size()) + shell, is_new);
  if (!is_new) return cone;
  ring_.clear();
  for (const ShellEdge& edge : soup_.shells()[shell].edges) {
    const bool left = view_.side(edge.left) > 0, right = view_.side(edge.right) > 0;
    if (left != right) ring_.push_back(left ? std::pair(edge.from, edge.to) : std::pair(edge.to, edge.from));
  }
  // The edges form one ring: each in turn gets behind it the one that starts where it ends.
  for (std::size_t k = 0; k + 1 < ring_.size(); ++k) {
    const auto next = std::find_if(ring_.begin() + static_cast<std::ptrdiff_t>(k) + 1, ring_.end(),
                                   [&](const auto& e) { return e.first == ring_[k].second; });
    if (next != ring_.end()) std::swap(ring_[k + 1], *next);
  }
  corners_.clear();
  for (const auto& edge : ring_) corners_.push_back(&soup_.vertices()[edge.first]);
  set_cone(cone, corners_, -1, false);
  for (std::size_t k = 0; k < ring_.size(); ++k) {
    cone.sides[k].below_horizon = view_.horizon(ring_[k].first) <= 0 && view_.horizon(ring_[k].second) <= 0;
  }
  drop_below_horizon(cone);
  return cone;
}

template <class Real>
typename VisibleRegion<Real>::Place VisibleRegion<Real>::place_of(const Shell& shell) {
  bool in_front = false, behind = false, above = false;
  for (const std::uint32_t v : shell.vertices) {
    above = above || view_.horizon(v) > 0;
    const int s = facing_source_ * side_of(*source_plane_, soup_.vertices()[v], view_.counts());
    in_front = in_front || s > 0;
    behind = behind || s < 0;
    if (above && in_front && behind) return Place::across;
  }
  return !above || !in_front ? Place::nowhere : behind ? Place::across : Place::in_front;
}

template <class Real>
typename VisibleRegion<Real>::Effect VisibleRegion<Real>::add(const Occluder& occluder) {
  if (occluder.shell == kNone) return add_facet(occluder.facet);
  if (added_.size() == count_) added_.emplace_back();
  Added& added = added_[count_];
  added.cone = &cone_of_shell(occluder.shell);
  added.edges.clear();
  for (const auto& side : added.cone->sides) added.edges.push_back(side.stretch);
  return add_cone(added);
}

template <class Real>
typename VisibleRegion<Real>::Effect VisibleRegion<Real>::add_facet(std::uint32_t facet) {
  const auto facets = soup_.facets();
  const Facet& f = facets[facet];
  const int facing = view_.facing(facet);
  if (facing == 0 || facet == source_facet_) return Effect::none;
  const auto vertices = soup_.vertices();
  const auto loop = soup_.corners(f);
  if (std::none_of(loop.begin(), loop.end(), [&](const Corner& c) { return view_.horizon(c.vertex) > 0; })) {
    return Effect::none;
  }
  const auto coplanar = soup_.coplanar(source_facet_);
  const bool covers =
      std::binary_search(coplanar.begin(), coplanar.end(), facet) &&
      (facing_source_ > 0 ? soup_.covers(facet, source_facet_) : soup_.covers_back(facet, source_facet_));

  // Which side of the source's plane the occluder's corners lie on (+1: that of x), and of its own plane the source's.
  bool pierces = false;
  corner_sides_.assign(loop.size(), 0);
  if (!covers) {
    bool in_front = false, behind = false;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3& v = vertices[loop[k].vertex];
      if (std::any_of(source_.corners.begin(), source_.corners.end(), [&](const auto& c) { return *c.exact.a == v; })) {
        continue;
      }
      const int s = facing_source_ * side_of(*source_plane_, v, view_.counts());
      corner_sides_[k] = s;
      in_front = in_front || s > 0;
      behind = behind || s < 0;
    }
    if (!in_front) return Effect::none;
    bool beyond = false, nearer = false;
    for (const auto& c : source_.corners) {
      if (c.exact.kind != ViewPoint::Kind::vertex) continue;
      const Vec3& v = *c.exact.a;
      if (std::any_of(loop.begin(), loop.end(), [&](const Corner& k) { return vertices[k.vertex] == v; })) continue;
      const int s = facing * side_of(f.plane, v, view_.counts());
      beyond = beyond || s < 0;
      nearer = nearer || s > 0;
    }
    if (!beyond) return Effect::none;
    pierces = behind && nearer;
  }

  if (added_.size() == count_) added_.emplace_back();
  Added& added = added_[count_];
  added.cone = &cone_of_facet(facet);
  if (pierces) {
    set_facet_cone(added.clipped, facet);
    weight_.clear();
    for (const auto& c : added.clipped.corners) {
      weight_.push_back(plane_value(*source_plane_, *c.exact.a, facing_source_));
    }
    // The corners' weights are S times facing_source_; ViewPoint's weight is S itself.
    clip(added.clipped, weight_, ViewPoint::Kind::at_source_plane, closing_cut(f.plane, facing));
    for (auto& c : added.clipped.corners) c.exact.sign_at_a *= facing_source_;
    added.cone = &added.clipped;
  }
  // An edge whose neighbour faces the same way, and hides something of the source, too, bounds nothing. Of an occluder
  // that lies in the source's plane, and along an edge in that plane, the neighbour may dive behind it or lie in it.
  const auto reaches_in_front = [&](std::uint32_t n) {
    const auto c = soup_.corners(facets[n]);
    return std::any_of(c.begin(), c.end(), [&](const Corner& k) {
      return facing_source_ * side_of(*source_plane_, vertices[k.vertex], view_.counts()) > 0;
    });
  };
  added.edges.clear();
  for (const auto& side : added.cone->sides) {
    const std::uint32_t n = side.across;
    bool goes_on = n != kNone && n != source_facet_ && view_.facing(n) == facing;
    if (goes_on && covers) {
      goes_on = facets[n].polygon == f.polygon && std::binary_search(coplanar.begin(), coplanar.end(), n);
    } else if (goes_on && corner_sides_[side.from] == 0 && corner_sides_[side.to] == 0) {
      goes_on = reaches_in_front(n);
    }
    added.edges.push_back(side.stretch);
    added.edges.back().empty = goes_on;
  }
  return add_cone(added);
}

/// Meets a cone with the source's: leaves in added.edges what lies within it, and in covered_source_ what it covers.
template <class Real>
typename VisibleRegion<Real>::Effect VisibleRegion<Real>::add_cone(Added& added) {
  const Cone<Real>& cone = *added.cone;
  const ChartBox box = chart_.box_of(cone);
  if (!chart_.meets_source(box)) return Effect::none;

  // Apart, by a side of the source? And within the source, of each of the occluder's edges, which stretch?
  for (const auto& side : source_.sides) {
    fill_row(side, cone);
    bool apart = true;
    for (std::size_t k = 0; k < row_.size(); ++k) apart = apart && (row_[k].sign <= 0 || !cone.corners[k].kept);
    if (apart) return Effect::none;
    for (std::size_t k = 0; k < cone.sides.size(); ++k) {
      if (!added.edges[k].empty) narrow_along(added.edges[k], cone, cone.sides[k], side);
    }
  }

  // Apart, by a side of the occluder? And of each of the source's edges, which stretch does it cover?
  within_.clear();
  for (const auto& side : source_.sides) within_.push_back(side.stretch);
  bool whole = true;
  for (const auto& side : cone.sides) {
    fill_row(side, source_);
    bool apart = true;
    int side_of_source = 0;
    for (std::size_t k = 0; k < row_.size(); ++k) {
      if (!source_.corners[k].kept) continue;
      apart = apart && row_[k].sign <= 0;
      whole = whole && row_[k].sign >= 0;
      if (row_[k].sign != 0) side_of_source = row_[k].sign;
    }
    if (apart) return Effect::none;
    for (std::size_t k = 0; k < source_.sides.size(); ++k) {
      if (within_[k].empty || (lies_in(source_.sides[k]) && side_of_source > 0)) continue;
      narrow_along(within_[k], source_, source_.sides[k], side);
    }
  }
  if (whole) return Effect::whole;

  for (std::size_t k = 0; k < source_.sides.size(); ++k) {
    if (!within_[k].empty) covered_source_[k].push_back(within_[k]);
  }
  added.bounds = std::any_of(added.edges.begin(), added.edges.end(), [](const auto& e) { return !e.empty; });
  chart_.set(count_, box);
  ++count_;
  return Effect::part;
}

/// Adds to covered_ the stretches of a's bounding edges that b covers on their outer sides, or stands for.
template <class Real>
void VisibleRegion<Real>::cover(const Added& a, const Added& b, bool b_first) {
  const Cone<Real>& cone = *a.cone;
  within_.assign(a.edges.begin(), a.edges.end());
  for (const auto& side : b.cone->sides) {
    fill_row(side, cone);
    int side_of_a = 0;
    bool out_of_reach = true;
    for (std::size_t k = 0; k < row_.size(); ++k) {
      if (row_[k].sign >= 0) out_of_reach = false;
      if (cone.corners[k].kept && row_[k].sign != 0) side_of_a = row_[k].sign;
    }
    if (out_of_reach) return;
    for (std::size_t k = 0; k < cone.sides.size(); ++k) {
      if (within_[k].empty) continue;
      if (lies_in(cone.sides[k])) {
        // On one line. On opposite sides of it b covers a's outer side; on the same side, the first stands for both.
        if (side_of_a > 0 && !b_first) within_[k].empty = true;
      } else {
        narrow_along(within_[k], cone, cone.sides[k], side);
      }
    }
  }
  for (std::size_t k = 0; k < cone.sides.size(); ++k) {
    if (!within_[k].empty) covered_[k].push_back(within_[k]);
  }
}

template <class Real>
template <class Sink>
void VisibleRegion<Real>::finish_edge(const Cone<Real>& cone, const ConeSide<Real>& side, const Stretch<Real>& edge,
                                      std::vector<Stretch<Real>>& covered, bool of_source, const Sink& sink) {
  std::sort(covered.begin(), covered.end(), [](const auto& a, const auto& b) { return a.lo < b.lo; });
  Real reached = edge.lo, reached_error = edge.lo_error;
  const auto visible_until = [&](const Real& t, const Real& t_error) {
    // A stretch that is empty only by rounding is handed on with no length and its errors.
    if (t + t_error + reached_error > reached) {
      sink(Arc<Real>{&cone, &side, reached, t > reached ? t : reached, reached_error, t_error, of_source});
    }
  };
  for (const auto& c : covered) {
    if (!(c.hi + c.hi_error > reached - reached_error)) continue;
    if (c.hi < c.lo && c.hi + c.hi_error < c.lo - c.lo_error) continue;
    visible_until(c.lo < edge.hi ? c.lo : edge.hi, c.lo_error);
    if (c.hi > reached) {
      reached = c.hi;
      reached_error = c.hi_error;
    }
  }
  visible_until(edge.hi, edge.hi_error);
}

template <class Real>
template <class Sink>
void VisibleRegion<Real>::for_each_arc(const Sink& sink) {
  for (std::size_t k = 0; k < source_.sides.size(); ++k) {
    finish_edge(source_, source_.sides[k], source_.sides[k].stretch, covered_source_[k], true, sink);
  }
  for (std::size_t i = 0; i < count_; ++i) {
    const Added& a = added_[i];
    if (!a.bounds) continue;
    const std::size_t n = a.edges.size();
    if (covered_.size() < n) covered_.resize(n);
    for (std::size_t k = 0; k < n; ++k) covered_[k].clear();
    chart_.for_each_overlap(i, count_, [&](std::size_t j) { cover(a, added_[j], j < i); });
    for (std::size_t k = 0; k < n; ++k) {
      if (!a.edges[k].empty) finish_edge(*a.cone, a.cone->sides[k], a.edges[k], covered_[k], false, sink);
    }
  }
}

}  // namespace exitance
