#pragma once
// The visible part of one convex source behind convex occluders: its boundary, as stretches of their edges.
//
// No region is built. The visible region is V = cone(source) − ∪ cone(occluder); a point of an edge that lies on no other
// edge bounds V exactly where it is covered by no other occluder. Where edges coincide, what lies to their left and right
// decides: an occluder covers the side of the line that it lies on; of occluder edges with the occluder on the same side one
// (the first added) stands for all; an occluder edge on the source's boundary bounds nothing. Coincidences, and so all
// degenerate positions, are decided by exact signs; crossings of edges are rounded parameters with error bounds, and an
// interval that is wrong by a rounding costs no more than a rounding.
//
//  - An occluder counts only with its part strictly in front of the source's plane. Where it pierces that plane, and the
//    source lies on both sides of its own plane, it is cut along the line of both planes, which becomes an edge like others.
//    Otherwise the cone of its rest is separated from the source's cone, or adds nothing within it.
//  - One that lies in the source's plane counts whole if the caller says that it covers the source, else not at all.
//  - Edge-on occluders must not be added.

#include <algorithm>
#include <span>

#include "geometry/chart.h"
#include "geometry/cone.h"
#include "geometry/polygon_soup.h"

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

template <class Real>
class VisibleRegion {
 public:
  /// Corner of a polygon as an input point, with its vector from x and whether it lies in the source's plane by identity.
  using Corners = std::span<const Vec3* const>;

  VisibleRegion(const PolygonSoup& soup, StageCounts& counts) : soup_(soup), counts_(counts) {}

  /// Starts on a source in a plane, seen from x, which lies strictly on side `facing` (±1) of the plane. Its corners run
  /// counter-clockwise seen from the plane's front; `horizon`: the sign of each against the receiver's horizon. False when
  /// no part of it is above the horizon.
  bool set_source(const Vec3& x, const Vec3& normal, const Plane& plane, int facing, Corners corners,
                  std::span<const int> horizon);

  enum class Effect { none, part, whole };

  /// Adds an occluding facet, seen from side `facing`; `covers`: it lies in the source's plane and covers it.
  /// bounds(k): whether the edge from corner k is an edge of the occluder, not shared with one that carries on.
  /// horizon(vertex): a vertex' sign against the receiver's horizon.
  template <class Bounds, class Horizon>
  Effect add_occluder(std::uint32_t facet, int facing, bool covers, const Bounds& bounds, const Horizon& horizon);

  /// Calls sink(arc) for every stretch of the boundary, and for those that are empty but might not be without rounding.
  template <class Sink>
  void for_each_arc(const Sink& sink);

  std::size_t occluder_count() const { return occluder_count_; }
  const Cone<Real>& source() const { return source_; }

 private:
  /// Of corners that run counter-clockwise seen from the front: seen from there, det(c − x, d − x, v − x) is negative
  /// inside, so that sign is −1 where x is in front.
  void set_cone(Cone<Real>& cone, Corners corners, int sign, bool on_source);
  Signed<Real> plane_value(const Plane& plane, const Vec3& v, int sign) const;
  ConeSide<Real> closing_cut(const Plane& T, int facing_occluder) const;
  void cover(const Cone<Real>& a, const Cone<Real>& b, bool b_first);
  /// row_: values of a side's functional at the corners of another cone.
  void fill_row(const ConeSide<Real>& side, const Cone<Real>& cone);
  bool lies_in(const ConeSide<Real>& edge) const { return row_[edge.from].sign == 0 && row_[edge.to].sign == 0; }
  void narrow_along(Stretch<Real>& stretch, const Cone<Real>& cone, const ConeSide<Real>& edge,
                    const ConeSide<Real>& side);

  template <class Sink>
  void finish_edge(const Cone<Real>& cone, const ConeSide<Real>& side, std::vector<Stretch<Real>>& covered,
                   bool of_source, const Sink& sink);

  const PolygonSoup& soup_;
  StageCounts& counts_;
  ViewFrame frame_;
  const Plane* source_plane_ = nullptr;
  int facing_source_ = 1;
  Cone<Real> source_;
  std::vector<Cone<Real>> occluders_;  // occluder_count_ of them in use
  std::size_t occluder_count_ = 0;
  std::vector<std::vector<Stretch<Real>>> covered_source_;  // by source side
  std::vector<std::vector<Stretch<Real>>> covered_;         // by side of the occluder being finished
  std::vector<Signed<Real>> row_, weight_;
  std::vector<Stretch<Real>> within_, source_cut_;
  Chart chart_;
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
bool VisibleRegion<Real>::set_source(const Vec3& x, const Vec3& normal, const Plane& plane, int facing, Corners corners,
                                     std::span<const int> horizon) {
  frame_ = {x, normal, plane.points};
  source_plane_ = &plane;
  facing_source_ = facing;
  occluder_count_ = 0;
  if (std::none_of(horizon.begin(), horizon.end(), [](int s) { return s > 0; })) return false;
  set_cone(source_, corners, -facing, true);
  if (std::any_of(horizon.begin(), horizon.end(), [](int s) { return s < 0; })) {
    ConeSide<Real> closing;
    closing.m = {Real(normal.x), Real(normal.y), Real(normal.z)};
    closing.length = norm(closing.m);
    closing.error = 5 * roundoff<Real>() * closing.length;
    closing.exact = {ViewPlane::Kind::horizon, 1, nullptr, nullptr, {}};
    weight_.clear();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (horizon[k] == 0) {
        weight_.push_back({Real(0), Real(0), 0});
        continue;
      }
      using std::fabs;
      const Real value = fabs(dot(closing.m, source_.corners[k].w));
      weight_.push_back({horizon[k] * value, closing.error * source_.corners[k].length, horizon[k]});
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
  for (const auto& c : cone.corners) row_.push_back(value_at(side, c, frame_, counts_));
}

/// Narrows a stretch of an edge of the cone whose row is filled to where it is inside of the side.
template <class Real>
void VisibleRegion<Real>::narrow_along(Stretch<Real>& stretch, const Cone<Real>& cone, const ConeSide<Real>& edge,
                                       const ConeSide<Real>& side) {
  narrow(stretch, row_[edge.from], row_[edge.to], edge.sweep, [&] {
    if constexpr (!std::is_same_v<Real, double>) return;
    for (const std::uint32_t k : {edge.from, edge.to}) {
      row_[k] = refined_value_at(side, cone.corners[k], frame_, counts_);
    }
  });
}

template <class Real>
template <class Bounds, class Horizon>
typename VisibleRegion<Real>::Effect VisibleRegion<Real>::add_occluder(std::uint32_t facet, int facing, bool covers,
                                                                       const Bounds& bounds, const Horizon& horizon) {
  const Facet& f = soup_.facets()[facet];
  const auto vertices = soup_.vertices();
  const auto loop = soup_.corners(f);
  const auto is_corner = [](const auto& corners, const Vec3& v) {
    return std::any_of(corners.begin(), corners.end(), [&](const auto& c) { return *c.exact.a == v; });
  };

  if (std::none_of(loop.begin(), loop.end(), [&](const Corner& c) { return horizon(c.vertex) > 0; })) {
    return Effect::none;
  }

  // Which side of the source's plane the occluder's corners lie on (+1: that of x), and of its own plane the source's.
  bool pierces = false;
  if (!covers) {
    bool in_front = false, behind = false;
    for (const Corner& c : loop) {
      const Vec3& v = vertices[c.vertex];
      if (is_corner(source_.corners, v)) continue;
      const int s = facing_source_ * side_of(*source_plane_, v, counts_);
      in_front = in_front || s > 0;
      behind = behind || s < 0;
    }
    if (!in_front) return Effect::none;
    bool beyond = false, nearer = false;
    for (const auto& c : source_.corners) {
      if (c.exact.kind != ViewPoint::Kind::vertex) continue;
      const Vec3& v = *c.exact.a;
      if (std::any_of(loop.begin(), loop.end(), [&](const Corner& k) { return vertices[k.vertex] == v; })) continue;
      const int s = facing * side_of(f.plane, v, counts_);
      beyond = beyond || s < 0;
      nearer = nearer || s > 0;
    }
    if (!beyond) return Effect::none;
    pierces = behind && nearer;
  }

  if (occluders_.size() == occluder_count_) occluders_.emplace_back();
  Cone<Real>& cone = occluders_[occluder_count_];
  {
    std::array<const Vec3*, 64> few;
    std::vector<const Vec3*> many;
    if (loop.size() > few.size()) many.resize(loop.size());
    const std::span<const Vec3*> corners =
        many.empty() ? std::span<const Vec3*>(few.data(), loop.size()) : std::span<const Vec3*>(many);
    for (std::size_t k = 0; k < loop.size(); ++k) corners[k] = &vertices[loop[k].vertex];
    set_cone(cone, corners, -facing, false);
  }
  for (std::uint32_t k = 0; k < loop.size(); ++k) cone.sides[k].bounds = bounds(k);
  const ChartBox box = chart_.box_of(cone);
  if (pierces) {
    weight_.clear();
    for (const auto& c : cone.corners) weight_.push_back(plane_value(*source_plane_, *c.exact.a, facing_source_));
    // The corners' weights are S times facing_source_; ViewPoint's weight is S itself.
    clip(cone, weight_, ViewPoint::Kind::at_source_plane, closing_cut(f.plane, facing));
    for (auto& c : cone.corners) c.exact.sign_at_a *= facing_source_;
  }

  // An edge on or below the horizon bounds nothing, and above the horizon the cone is the same without it: the cut by the
  // horizon has its closing side in the horizon itself.
  std::erase_if(cone.sides, [&](const ConeSide<Real>& side) {
    const auto below = [&](std::uint32_t k) { return k < loop.size() && horizon(loop[k].vertex) <= 0; };
    return side.exact.kind == ViewPlane::Kind::edge && below(side.from) && below(side.to);
  });

  // Apart, by a side of the source? And within the source, of each of the occluder's edges, which stretch?
  within_.clear();
  for (const auto& side : cone.sides) {
    within_.push_back(side.stretch);
    within_.back().empty = !side.bounds;
  }
  for (const auto& side : source_.sides) {
    fill_row(side, cone);
    bool apart = true;
    for (std::size_t k = 0; k < row_.size(); ++k) apart = apart && (row_[k].sign <= 0 || !cone.corners[k].kept);
    if (apart) return Effect::none;
    for (std::size_t k = 0; k < cone.sides.size(); ++k) {
      if (!within_[k].empty) narrow_along(within_[k], cone, cone.sides[k], side);
    }
  }

  // Apart, by a side of the occluder? And of each of the source's edges, which stretch does it cover?
  std::vector<Stretch<Real>>& cut = source_cut_;
  cut.clear();
  for (const auto& side : source_.sides) cut.push_back(side.stretch);
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
      if (cut[k].empty || (lies_in(source_.sides[k]) && side_of_source > 0)) continue;
      narrow_along(cut[k], source_, source_.sides[k], side);
    }
  }
  if (whole) return Effect::whole;

  for (std::size_t k = 0; k < source_.sides.size(); ++k) {
    if (!cut[k].empty) covered_source_[k].push_back(cut[k]);
  }
  for (std::size_t k = 0; k < cone.sides.size(); ++k) {
    cone.sides[k].stretch = within_[k];
    cone.sides[k].bounds = !within_[k].empty;
  }
  chart_.set(occluder_count_, box);
  ++occluder_count_;
  return Effect::part;
}

/// Adds to covered_ the stretches of a's bounding edges that b covers on their outer sides, or stands for.
template <class Real>
void VisibleRegion<Real>::cover(const Cone<Real>& a, const Cone<Real>& b, bool b_first) {
  within_.clear();
  for (const auto& side : a.sides) {
    within_.push_back(side.stretch);
    within_.back().empty = !side.bounds;
  }
  for (const auto& side : b.sides) {
    fill_row(side, a);
    int side_of_a = 0;
    bool out_of_reach = true;
    for (std::size_t k = 0; k < row_.size(); ++k) {
      if (row_[k].sign >= 0) out_of_reach = false;
      if (a.corners[k].kept && row_[k].sign != 0) side_of_a = row_[k].sign;
    }
    if (out_of_reach) return;
    for (std::size_t k = 0; k < a.sides.size(); ++k) {
      if (within_[k].empty) continue;
      if (lies_in(a.sides[k])) {
        // On one line. On opposite sides of it b covers a's outer side; on the same side, the first stands for both.
        if (side_of_a > 0 && !b_first) within_[k].empty = true;
      } else {
        narrow_along(within_[k], a, a.sides[k], side);
      }
    }
  }
  for (std::size_t k = 0; k < a.sides.size(); ++k) {
    if (!within_[k].empty) covered_[k].push_back(within_[k]);
  }
}

template <class Real>
template <class Sink>
void VisibleRegion<Real>::finish_edge(const Cone<Real>& cone, const ConeSide<Real>& side,
                                      std::vector<Stretch<Real>>& covered, bool of_source, const Sink& sink) {
  std::sort(covered.begin(), covered.end(), [](const auto& a, const auto& b) { return a.lo < b.lo; });
  const Stretch<Real>& edge = side.stretch;
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
    finish_edge(source_, source_.sides[k], covered_source_[k], true, sink);
  }
  for (std::size_t i = 0; i < occluder_count_; ++i) {
    const Cone<Real>& a = occluders_[i];
    if (std::none_of(a.sides.begin(), a.sides.end(), [](const auto& s) { return s.bounds; })) continue;
    if (covered_.size() < a.sides.size()) covered_.resize(a.sides.size());
    for (std::size_t k = 0; k < a.sides.size(); ++k) covered_[k].clear();
    chart_.for_each_overlap(i, occluder_count_, [&](std::size_t j) { cover(a, occluders_[j], j < i); });
    for (std::size_t k = 0; k < a.sides.size(); ++k) {
      if (a.sides[k].bounds) finish_edge(a, a.sides[k], covered_[k], false, sink);
    }
  }
}

}  // namespace exitance
