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
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "geometry/chart.h"
#include "geometry/cone.h"
#include "geometry/level_facets.h"
#include "geometry/sieve.h"
#include "geometry/view_cones.h"

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

/// What hides: a facet, or a shell as a whole: of a convex one the front faces are seen as one convex cone, of others
/// by their silhouette (silhouette.h).
struct OccluderId {
  std::uint32_t facet = kNone, shell = kNone;
};

template <class Real>
class VisibleRegion {
 public:
  explicit VisibleRegion(View& view) : view_(view), soup_(view.soup()), cones_(view) {}

  /// Starts on a source in a facet's plane, seen from the view's point, which lies strictly on side `facing` (±1) of
  /// that plane. Its corners run counter-clockwise seen from the facet's front; `horizon`: the sign of each against the
  /// receiver's horizon. False when no part of it is above the horizon. `drop`: given if the corners lie in the plane
  /// up to rounding only; with a height for each and then zeros, to a multiple of kLanes. Used until the next source.
  bool set_source(std::uint32_t facet, int facing, PointLoop loop, std::span<const int> horizon, const Drop* drop);

  /// Of the current source no facets will be added but these, ascending, and those of convex shells. An edge that an
  /// occluder shares with one that is left out bounds what is seen, even where the corners of a rounded source reach an
  /// ulp into the one left out. Unless said, all facets are added that hide something of the source.
  void will_add_only(std::span<const std::uint32_t> facets) { added_only_ = facets; }

  /// How wrong [rad] the end of an arc may be before exact arithmetic is asked; at first 2^-46.
  void set_bearable_angle(double angle) { per_bearable_angle_ = 1 / angle; }

  enum class Effect { none, part, whole };

  /// Whether an occluder, which may be added, hides all of the source. Leaves the source with no occluders.
  bool hides(const OccluderId& occluder) {
    const bool whole = add(occluder) == Effect::whole;
    count_ = 0;
    for (auto& covered : covered_source_) covered.clear();
    return whole;
  }

  /// Whether an occluder that may be added has a chance to hide all of the source, as far as rounded numbers tell: a
  /// convex one must hide its middle.
  bool stands_before_the_middle(const OccluderId& occluder) {
    if (occluder.shell != kNone && !soup_.shells()[occluder.shell].convex) return true;
    if (occluder.shell == kNone && view_.facing(occluder.facet) == 0) return false;
    const Cone<Real>& cone =
        occluder.shell == kNone ? cones_.of_facet(occluder.facet) : cones_.of_shell(occluder.shell);
    const Vec<double>& middle = chart_.axis();
    return std::ranges::all_of(cone.sides, [&](const ConeSide<Real>& side) {
      return Real(middle.x) * side.m.x + Real(middle.y) * side.m.y + Real(middle.z) * side.m.z > 0;
    });
  }

  /// Whether a facet surely hides nothing of the source: found at a glance, where it lies outside of the cone or below
  /// the horizon, or is a back face of a shell that the point is outside of. Told in double precision only.
  bool misses(std::uint32_t facet) const {
    const FirstCorners& corners = soup_.first_corners(facet);
    const Sieve::Glance glance = sieve_.glance(corners);
    return glance == Sieve::Glance::outside ||
           (glance == Sieve::Glance::back && corners.shell != kNone && view_.outside(soup_.shells()[corners.shell]));
  }

  /// Adds an occluder. A shell must have the point outside its box and be all on the point's side of the source's plane
  /// (place_of), and one that is not convex must have a usable silhouette.
  Effect add(const OccluderId& occluder);

  /// Whether a shell that is not convex, with the point outside its box, has a usable silhouette.
  bool has_silhouette(std::uint32_t shell) { return cones_.silhouette_of(shell).is_usable; }

  enum class Place { nowhere, in_front, across };

  /// Where the part of a shell that is above the horizon lies: nowhere in front of the source's plane, nowhere behind
  /// it, or on both sides. Where a facet of it is in the source's plane and faces the side that is seen, it is nowhere
  /// in front if it is convex and lies behind the plane but for rounding (backs), and across if it is not convex.
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
    const Cone<Real>* cone = nullptr;              // null until it is asked for, of a facet that bounds nothing
    std::uint32_t facet = kNone;                   // that one
    const Silhouette<Real>* silhouette = nullptr;  // of a shell that is not convex; `cone` is its edges
    std::uint32_t shell = kNone;
    Cone<Real> clipped;
    SideBlocks<Real> sides;  // of the cone, if there is no silhouette, once they are asked for
    bool has_sides = false;
    std::vector<Stretch<Real>> edges;  // empty: bounds nothing
    bool bounds = false;               // whether any edge does
  };

  Added& next_added() {
    if (added_.size() == count_) added_.push_back(std::make_unique<Added>());
    added_[count_]->silhouette = nullptr;
    return *added_[count_];
  }
  Sieve::Verdict judge(std::uint32_t facet, int facing) const {
    if constexpr (!std::is_same_v<Real, double>) return Sieve::Verdict::unsure;
    return sieve_.judge(soup_.facets()[facet].plane, soup_.first_corners(facet), facing);
  }
  Effect add_facet(std::uint32_t facet);
  template <class Drops>
  Effect add_cone(Added& added, const Drops& drops);
  Effect add_silhouette(Added& added);
  bool is_apart(const Cone<Real>& cone);
  bool goes_on(std::uint32_t n, std::pair<std::uint32_t, std::uint32_t> edge, const Facet& occluder, int facing,
               bool covers);
  bool goes_on_all_round(const Facet& occluder, int facing);
  /// Of a facet in the source's plane.
  bool covers_source(std::uint32_t facet) const {
    return facing_source_ > 0 ? soup_.covers(facet, source_facet_) : soup_.covers_back(facet, source_facet_);
  }

  Signed<Real> plane_value(const Plane& plane, const Vec3& v, int sign) const;
  ConeSide<Real> closing_cut(const Plane& T, int facing_occluder) const;
  bool cover(const Added& a, Added& b, bool b_first);
  bool cover_by_silhouette(const Added& a, const Added& b);
  Evaluation evaluation() { return {frame_, view_.counts(), per_bearable_angle_}; }

  struct FacedPlane {
    const Plane& plane;
    int facing;
  };
  struct PlaneSides {
    bool in_front = false, behind = false;
  };
  template <class Decide>
  PlaneSides sides_of(const FacedPlane& faced, const Corners<Real>& corners, std::size_t n, const double* astray,
                      const Decide& decide);
  PlaneSides sides_of_source(const FacedPlane& faced, std::span<const Corner> occluder);
  PlaneSides sides_of_occluder(const Cone<Real>& cone, std::span<const Corner> occluder);
  void fill(Row<Real>& row, const ConeSide<Real>& side, const Cone<Real>& cone) {
    row.fill(side, cone.corners, frame_, view_.counts());
  }
  static bool lies_in(const Row<Real>& row, const ConeSide<Real>& edge) {
    return row.sign(edge.from) == 0 && row.sign(edge.to) == 0;
  }
  void narrow_along(Stretch<Real>& stretch, const Row<Real>& row, const Cone<Real>& cone, const ConeSide<Real>& edge,
                    const ConeSide<Real>& side) {
    const int from = row.sign(edge.from), to = row.sign(edge.to);
    if (from <= 0 && to <= 0) stretch.empty = true;
    if (from * to < 0) narrow_to_crossing(stretch, row.at(edge.from), row.at(edge.to), cone, edge, side);
  }
  void narrow_to_crossing(Stretch<Real>& stretch, const Signed<Real>& from, const Signed<Real>& to,
                          const Cone<Real>& cone, const ConeSide<Real>& edge, const ConeSide<Real>& side);

  template <class Sink>
  void finish_edge(const Cone<Real>& cone, const ConeSide<Real>& side, const Stretch<Real>& edge,
                   std::vector<Stretch<Real>>& covered, bool of_source, const Sink& sink);

  View& view_;
  const PolygonSoup& soup_;
  ViewCones<Real> cones_;
  ViewFrame frame_;
  std::uint32_t source_facet_ = kNone;
  const Plane* source_plane_ = nullptr;
  std::span<const std::uint32_t> coplanar_;  // with the source
  int facing_source_ = 1;
  double per_bearable_angle_ = kFinestPerAngle;
  std::optional<std::span<const std::uint32_t>> added_only_;
  Cone<Real> source_;
  std::vector<std::unique_ptr<Added>> added_;  // count_ of them in use; they may point into themselves
  std::size_t count_ = 0;
  std::vector<std::vector<Stretch<Real>>> covered_source_;  // by source side
  std::vector<std::vector<Stretch<Real>>> covered_;         // by side of the occluder being finished
  Row<Real> row_;
  Columns<Real> columns_;
  LayersOverEdge<Real> layers_;
  std::vector<std::size_t> covered_before_;  // sizes of covered_source_ before a solid was met with the source
  std::vector<Row<Real>> source_rows_;       // of each of the source's sides, at the occluder that is being added
  std::vector<Signed<Real>> weight_;
  std::vector<Stretch<Real>> within_, open_;
  std::vector<const Vec3*> loop_;  // of the source
  const Drop* drop_ = nullptr;
  Sieve sieve_;
  Chart chart_;
};

template <class Real>
bool VisibleRegion<Real>::set_source(std::uint32_t facet, int facing, PointLoop loop, std::span<const int> horizon,
                                     const Drop* drop) {
  source_facet_ = facet;
  source_plane_ = &soup_.facets()[facet].plane;
  coplanar_ = soup_.coplanar(facet);
  drop_ = drop;
  frame_ = drop ? drop->frame : ViewFrame{view_.receiver().point, view_.receiver().normal, source_plane_->points};
  facing_source_ = facing;
  count_ = 0;
  added_only_.reset();
  if (std::none_of(horizon.begin(), horizon.end(), [](int s) { return s > 0; })) return false;
  loop_.assign(loop.begin(), loop.end());
  cones_.set(source_, loop, -facing, drop);
  if (std::any_of(horizon.begin(), horizon.end(), [](int s) { return s < 0; })) {
    ConeSide<Real> closing;
    closing.m = {Real(frame_.normal.x), Real(frame_.normal.y), Real(frame_.normal.z)};
    closing.length = norm(closing.m);
    closing.error = 5 * roundoff<Real>() * closing.length;
    closing.exact = {ViewPlane::Kind::horizon};
    weight_.clear();
    for (std::size_t k = 0; k < loop.size(); ++k) {
      if (horizon[k] == 0) {
        weight_.push_back({Real(0), Real(0), 0});
        continue;
      }
      // Of corners near the horizon, as of an edge shared with the receiver's surface, rounding would leave only noise.
      const Corners<Real>& corners = source_.corners;
      const Real error = closing.error * corners.length(k) + closing.length * corners.error(k);
      const Signed<Real> value{dot(closing.m, corners.w(k)), error, horizon[k]};
      const bool is_clear = value.value * horizon[k] > 0x1p20 * value.error;
      weight_.push_back(is_clear ? value : refined_value_at(closing, corners.exact(k), frame_, view_.counts()));
    }
    clip(source_, weight_, ViewPoint::Kind::at_horizon, closing);
  }
  if (covered_source_.size() < source_.sides.size()) covered_source_.resize(source_.sides.size());
  for (auto& c : covered_source_) c.clear();
  if constexpr (std::is_same_v<Real, double>)
    sieve_.set(view_.receiver(), *source_plane_, facing, source_, soup_.vertices());
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
  side.exact = {ViewPlane::Kind::cut, sign, nullptr, nullptr, &T.points};
  return side;
}

/// Narrows a stretch of an edge of a cone to where it is inside of a side, whose values at the edge's ends are given.
template <class Real>
void VisibleRegion<Real>::narrow_to_crossing(Stretch<Real>& stretch, const Signed<Real>& from, const Signed<Real>& to,
                                             const Cone<Real>& cone, const ConeSide<Real>& edge,
                                             const ConeSide<Real>& side) {
  narrow(stretch, from, to, evaluation().weight(edge.sweep), [&](Signed<Real>& a, Signed<Real>& b, double accuracy) {
    if constexpr (!std::is_floating_point_v<Real>) return;
    a = refined_value_at(side, cone.corners.exact(edge.from), frame_, view_.counts(), accuracy);
    b = refined_value_at(side, cone.corners.exact(edge.to), frame_, view_.counts(), accuracy);
  });
}

template <class Real>
typename VisibleRegion<Real>::Place VisibleRegion<Real>::place_of(const Shell& shell) {
  // Of most shells the whole box lies in front and above.
  const Vec3 m = facing_source_ * source_plane_->normal;
  if (least_height(shell.box, m, source_plane_->origin, source_plane_->normal_error) > 0 &&
      view_.surely_above(shell.box)) {
    return Place::in_front;
  }
  bool in_front = false, behind = false, above = false;
  for (const std::uint32_t v : shell.vertices) {
    above = above || view_.horizon(v) > 0;
    const int s = facing_source_ * side_of(*source_plane_, soup_.vertices()[v], view_.counts());
    in_front = in_front || s > 0;
    behind = behind || s < 0;
    if (above && in_front && behind) break;
  }
  if (!above || !in_front) return Place::nowhere;
  if (behind && !shell.convex) return Place::across;
  const auto backs_source = [&](std::uint32_t f) {
    return dot(soup_.facets()[f].plane.normal, m) > 0 && std::ranges::binary_search(coplanar_, f) &&
           (!shell.convex || backs(soup_, shell, f, source_facet_, facing_source_));
  };
  if (!coplanar_.empty() && std::ranges::any_of(shell.facets, backs_source))
    return shell.convex ? Place::nowhere : Place::across;
  return behind ? Place::across : Place::in_front;
}

template <class Real>
typename VisibleRegion<Real>::Effect VisibleRegion<Real>::add(const OccluderId& occluder) {
  if (occluder.shell == kNone) return add_facet(occluder.facet);
  Added& added = next_added();
  if (soup_.shells()[occluder.shell].convex) {
    added.cone = &cones_.of_shell(occluder.shell);
    return add_cone(added, [](const auto&) { return false; });
  }
  added.silhouette = &cones_.silhouette_of(occluder.shell);
  added.cone = &added.silhouette->cone;
  added.shell = occluder.shell;
  return add_silhouette(added);
}

template <class Real>
typename VisibleRegion<Real>::Effect VisibleRegion<Real>::add_facet(std::uint32_t facet) {
  const auto facets = soup_.facets();
  const Facet& f = facets[facet];
  const int facing = view_.facing(facet);
  if (facing == 0 || facet == source_facet_) return Effect::none;
  const auto loop = soup_.corners(f);
  const bool in_plane = std::ranges::binary_search(coplanar_, facet);
  const bool covers = in_plane && covers_source(facet);
  // Facets of one polygon that lie in one plane only up to rounding may hide each other by as little.
  if (in_plane && !covers && f.polygon != facets[source_facet_].polygon) return Effect::none;
  const Sieve::Verdict verdict = covers ? Sieve::Verdict::unsure : judge(facet, facing);
  if (verdict == Sieve::Verdict::held_back) return Effect::none;
  const bool asks_planes = !covers && verdict == Sieve::Verdict::unsure;
  Added& added = next_added();
  if (verdict == Sieve::Verdict::inside && goes_on_all_round(f, facing)) {
    added.cone = nullptr;
    added.facet = facet;
    added.bounds = false;
    added.has_sides = false;
    chart_.set(count_, chart_.box_of(frame_.x, loop));
    ++count_;
    return Effect::part;
  }

  PlaneSides of_source;
  if (asks_planes) {
    of_source = sides_of_source({f.plane, facing}, loop);
    if (!of_source.behind) return Effect::none;
  }
  for (const Corner& c : loop) {
    if (c.neighbour != kNone) view_.prefetch(c.neighbour);  // for goes_on
  }
  added.cone = &cones_.of_facet(facet);
  if (!ViewCones<Real>::reaches_above(*added.cone)) return Effect::none;
  bool pierces = false;
  if (asks_planes) {
    const auto of_occluder = sides_of_occluder(*added.cone, loop);
    if (!of_occluder.in_front) return Effect::none;
    pierces = of_occluder.behind && of_source.in_front;
  }
  if (pierces) {
    cones_.set_whole(added.clipped, facet);
    Corners<Real>& corners = added.clipped.corners;
    weight_.clear();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      weight_.push_back(plane_value(*source_plane_, *corners.exact(k).a, facing_source_));
    }
    // The corners' weights are S times facing_source_; ViewPoint's weight is S itself.
    clip(added.clipped, weight_, ViewPoint::Kind::at_source_plane, closing_cut(f.plane, facing));
    for (std::size_t k = 0; k < corners.size(); ++k) corners.exact(k).sign_at_a *= facing_source_;
    added.cone = &added.clipped;
  }
  return add_cone(added, [&](const ConeSide<Real>& side) {
    return goes_on(side.across, {side.from, side.to}, f, facing, covers);
  });
}

/// Whether an occluder that does not lie in the source's plane goes on across all of its edges.
template <class Real>
bool VisibleRegion<Real>::goes_on_all_round(const Facet& occluder, int facing) {
  const auto loop = soup_.corners(occluder);
  for (std::uint32_t k = 0; k < loop.size(); ++k) {
    const std::uint32_t next = k + 1 < loop.size() ? k + 1 : 0;
    if (!goes_on(loop[k].neighbour, {k, next}, occluder, facing, false)) return false;
  }
  return true;
}

/// Whether an occluder goes on across an edge, given by its corners, in a neighbour n that faces the same way and hides
/// something of the source, too: then the edge bounds nothing. Of an occluder that lies in the source's plane, and
/// along an edge in that plane, the neighbour may dive behind it or lie in it.
template <class Real>
bool VisibleRegion<Real>::goes_on(std::uint32_t n, std::pair<std::uint32_t, std::uint32_t> edge, const Facet& occluder,
                                  int facing, bool covers) {
  if (n == kNone || n == source_facet_ || view_.facing(n) != facing) return false;
  const Facet& neighbour = soup_.facets()[n];
  const bool of_convex_shell = neighbour.shell != kNone && soup_.shells()[neighbour.shell].convex;
  if (added_only_ && !of_convex_shell && !std::ranges::binary_search(*added_only_, n)) return false;
  const bool in_plane = std::ranges::binary_search(coplanar_, n);
  if (covers) return neighbour.polygon == occluder.polygon && in_plane;
  if (in_plane && neighbour.polygon != soup_.facets()[source_facet_].polygon && !covers_source(n)) return false;
  const auto loop = soup_.corners(occluder);
  const auto side_of_source = [&](const Corner& c) {
    return facing_source_ * side_of(*source_plane_, c.at, view_.counts());
  };
  if (side_of_source(loop[edge.first]) != 0 || side_of_source(loop[edge.second]) != 0) return true;
  const auto corners = soup_.corners(neighbour);
  return std::any_of(corners.begin(), corners.end(), [&](const Corner& k) { return side_of_source(k) > 0; });
}

/// On which sides of an occluder's plane, seen from the side that it faces, the source's corners lie. Those that are
/// the occluder's, too, lie in its plane by identity.
template <class Real>
typename VisibleRegion<Real>::PlaneSides VisibleRegion<Real>::sides_of_source(const FacedPlane& faced,
                                                                              std::span<const Corner> occluder) {
  return sides_of(faced, source_.corners, loop_.size(), drop_ ? drop_->height.data() : nullptr, [&](std::size_t k) {
    const Vec3& v = *loop_[k];
    if (drop_) {  // where S is 0, the plane through x and the line of both planes tells as T does, times S(x)
      const ViewPlane cut{ViewPlane::Kind::cut, facing_source_, nullptr, nullptr, &faced.plane.points};
      return exact_value_at(frame_, cut, source_.corners.exact(k), view_.counts()).sign;
    }
    const bool own = std::ranges::any_of(occluder, [&](const Corner& c) { return c.at == v; });
    return own ? 0 : side_of(faced.plane, v, view_.counts());
  });
}

/// On which sides of the source's plane, seen from the side that it faces, an occluder's corners lie. Those that are
/// the source's, too, lie in its plane by identity.
template <class Real>
typename VisibleRegion<Real>::PlaneSides VisibleRegion<Real>::sides_of_occluder(const Cone<Real>& cone,
                                                                                std::span<const Corner> occluder) {
  return sides_of({*source_plane_, facing_source_}, cone.corners, occluder.size(), nullptr, [&](std::size_t k) {
    const Vec3& v = occluder[k].at;
    const bool own = !drop_ && std::ranges::any_of(loop_, [&](const Vec3* c) { return *c == v; });
    return own ? 0 : side_of(*source_plane_, v, view_.counts());
  });
}

/// On which sides of a plane the first n corners of a cone lie, which are input points, each up to `astray` from where
/// it is meant to be (null: all where they are). decide(k) tells the exact sign, where double precision cannot.
template <class Real>
template <class Decide>
typename VisibleRegion<Real>::PlaneSides VisibleRegion<Real>::sides_of(const FacedPlane& faced,
                                                                       const Corners<Real>& corners, std::size_t n,
                                                                       const double* astray, const Decide& decide) {
  PlaneSides sides;
  const auto ask = [&](std::size_t k) {
    const int s = faced.facing * decide(k);
    sides.in_front = sides.in_front || s > 0;
    sides.behind = sides.behind || s < 0;
  };
  if constexpr (std::is_same_v<Real, double>) {
    // n · w + n · (x − o): the normal is wrong by at most √3 normal_error, w and x − o by u of each component; three
    // roundings each of the products and one of the sum. |n| ≤ √3 normal_size.
    const Plane& plane = faced.plane;
    const Vec3 to_x = frame_.x - plane.origin, n_faced = faced.facing * plane.normal;
    const double height = dot(n_faced, to_x), distance = std::fabs(to_x.x) + std::fabs(to_x.y) + std::fabs(to_x.z);
    const double per_length = 12 * kRoundoff * plane.normal_size + 2 * plane.normal_error;
    for (std::size_t first = 0; first < n; first += kLanes) {
      const auto& c = corners.block(first / kLanes);
      const Doubles value =
          n_faced.x * load(c.x.data()) + n_faced.y * load(c.y.data()) + n_faced.z * load(c.z.data()) + height;
      Doubles error = per_length * (load(c.length.data()) + distance);
      if (astray) error = error + 2 * plane.normal_size * load(astray + first);
      const SignBytes signs = certain_signs(value, error);
      const SignBytes asked = n - first >= kLanes ? kOnes : kOnes & ((SignBytes{1} << (8 * (n - first))) - 1);
      sides.in_front = sides.in_front || (positive_bytes(signs) & asked) != 0;
      sides.behind = sides.behind || (negative_bytes(signs) & asked) != 0;
      if (!sides.in_front || !sides.behind) {
        for_each_byte(zero_bytes(signs) & asked, [&](std::size_t k) { ask(first + k); });
      }
    }
  } else {
    for (std::size_t k = 0; k < n; ++k) ask(k);
  }
  return sides;
}

/// Whether a side of the source keeps a cone apart from it. Leaves each side's values in source_rows_.
template <class Real>
bool VisibleRegion<Real>::is_apart(const Cone<Real>& cone) {
  if (source_rows_.size() < source_.sides.size()) source_rows_.resize(source_.sides.size());
  for (std::size_t k = 0; k < source_.sides.size(); ++k) {
    fill(source_rows_[k], source_.sides[k], cone);
    if (!source_rows_[k].any_positive()) return true;
  }
  return false;
}

/// Meets a cone with the source's: leaves in added.edges what lies within it, of edges of which drops(side) is not
/// true, and in covered_source_ what it covers.
template <class Real>
template <class Drops>
typename VisibleRegion<Real>::Effect VisibleRegion<Real>::add_cone(Added& added, const Drops& drops) {
  const Cone<Real>& cone = *added.cone;
  if (is_apart(cone)) return Effect::none;

  // Of the source's edges those are out of the cone's reach in whose plane it has no corner, nor beyond it.
  within_.clear();
  bool inside = true;
  for (std::size_t k = 0; k < source_.sides.size(); ++k) {
    within_.push_back(source_.sides[k].stretch);
    if (source_rows_[k].all_positive()) {
      within_.back().empty = true;
    } else {
      inside = false;
    }
  }
  // Apart, by a side of the occluder? And of each of the source's edges, which stretch does it cover?
  bool whole = !inside;
  for (const auto& side : std::span(cone.sides).first(inside ? 0 : cone.sides.size())) {
    fill(row_, side, source_);
    if (!row_.any_positive()) return Effect::none;
    if (row_.all_positive()) continue;
    whole = whole && !row_.any_negative();
    for (std::size_t k = 0; k < source_.sides.size(); ++k) {
      // An edge that lies in the side's plane is covered by the occluder, who lies on the source's side of it.
      if (within_[k].empty || lies_in(row_, source_.sides[k])) continue;
      narrow_along(within_[k], row_, source_, source_.sides[k], side);
    }
  }
  if (whole) return Effect::whole;

  for (std::size_t k = 0; k < source_.sides.size(); ++k) {
    if (!within_[k].empty) covered_source_[k].push_back(within_[k]);
  }

  // Of each of the occluder's edges, which stretch lies within the source?
  added.edges.clear();
  added.bounds = false;
  for (const auto& edge : cone.sides) {
    Stretch<Real> stretch = edge.stretch;
    for (std::size_t k = 0; k < source_.sides.size() && !stretch.empty; ++k) {
      if (!source_rows_[k].all_positive()) narrow_along(stretch, source_rows_[k], cone, edge, source_.sides[k]);
    }
    stretch.empty = stretch.empty || drops(edge);
    added.bounds = added.bounds || !stretch.empty;
    added.edges.push_back(stretch);
  }
  added.has_sides = false;
  chart_.set(count_, chart_.box_of(cone));
  ++count_;
  return Effect::part;
}

/// Meets a solid with the source, as add_cone.
template <class Real>
typename VisibleRegion<Real>::Effect VisibleRegion<Real>::add_silhouette(Added& added) {
  const Cone<Real>& cone = *added.cone;
  if (is_apart(cone)) return Effect::none;
  bool any = false, whole = true;
  covered_before_.clear();
  for (std::size_t k = 0; k < source_.sides.size(); ++k) {
    auto& covered = covered_source_[k];
    covered_before_.push_back(covered.size());
    const bool all =
        layers_.find(source_, source_.sides[k], *added.silhouette, Tie::silhouette_moves, evaluation(), covered);
    whole = whole && all;
    any = any || covered.size() > covered_before_.back();
  }
  added.edges.clear();
  added.bounds = false;
  for (std::size_t k = 0; k < cone.sides.size(); ++k) {
    const ConeSide<Real>& edge = cone.sides[k];
    Stretch<Real> stretch = edge.stretch;
    for (std::size_t j = 0; j < source_.sides.size() && !stretch.empty; ++j) {
      const Row<Real>& row = source_rows_[j];
      if (row.all_positive()) continue;
      if (lies_in(row, edge)) {
        stretch.empty = gradient_sign(frame_, source_.sides[j].exact) < 0;
      } else {
        narrow_along(stretch, row, cone, edge, source_.sides[j]);
      }
    }
    stretch.empty = stretch.empty || cones_.hidden_of(added.shell, k).is_all;
    added.bounds = added.bounds || !stretch.empty;
    added.edges.push_back(stretch);
  }
  if (!any && !added.bounds) return Effect::none;
  if (whole && !added.bounds) {
    for (std::size_t k = 0; k < source_.sides.size(); ++k) covered_source_[k].resize(covered_before_[k]);
    return Effect::whole;
  }
  chart_.set(count_, chart_.box_of(cone));
  ++count_;
  return Effect::part;
}

/// Adds to covered_ the stretches of a's edges, those of `open_`, that b covers on their outer sides, or stands for.
/// False when no edge of a is left that is not surely covered from end to end.
template <class Real>
bool VisibleRegion<Real>::cover(const Added& a, Added& b, bool b_first) {
  if (b.silhouette) return cover_by_silhouette(a, b);
  if (!b.has_sides) {
    if (b.cone == nullptr) b.cone = &cones_.of_facet(b.facet);
    b.sides.set(b.cone->sides);
    b.has_sides = true;
  }
  const Cone<Real>& cone = *a.cone;
  bool any_open = false;
  for (std::size_t k = 0; k < cone.sides.size(); ++k) {
    if (open_[k].empty) continue;
    const ConeSide<Real>& edge = cone.sides[k];
    Stretch<Real> within = open_[k];
    within.narrow = false;
    const auto narrow_to = [&](const ConeSide<Real>& side, const Signed<Real>& from, const Signed<Real>& to) {
      if (from.sign * to.sign < 0) {
        narrow_to_crossing(within, from, to, cone, edge, side);
        return true;
      }
      if (from.sign != 0 || to.sign != 0) return false;
      // On one line. On opposite sides of it b covers a's outer side; on the same side, the first stands for both.
      if (a.silhouette) return gradient_sign(frame_, side.exact) >= 0;
      if (b_first) return true;
      fill(row_, side, cone);
      return !row_.any_positive();
    };
    if (columns_.each(b.sides, cone.corners, edge, frame_, view_.counts(), narrow_to)) {
      covered_[k].push_back(within);
      open_[k].empty = !within.narrow;
    }
    any_open = any_open || !open_[k].empty;
  }
  return any_open;
}

/// The same where b is a solid that is not convex. Of two of those the one of lower index moves to break ties.
template <class Real>
bool VisibleRegion<Real>::cover_by_silhouette(const Added& a, const Added& b) {
  const Tie tie = a.silhouette && a.shell < b.shell ? Tie::edge_moves : Tie::silhouette_moves;
  bool any_open = false;
  for (std::size_t k = 0; k < a.cone->sides.size(); ++k) {
    if (open_[k].empty) continue;
    open_[k].empty = layers_.find(*a.cone, a.cone->sides[k], *b.silhouette, tie, evaluation(), covered_[k]);
    any_open = any_open || !open_[k].empty;
  }
  return any_open;
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
    const Added& a = *added_[i];
    if (!a.bounds) continue;
    const std::size_t n = a.edges.size();
    if (covered_.size() < n) covered_.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      covered_[k].clear();
      if (a.silhouette && !a.edges[k].empty) covered_[k] = cones_.hidden_of(a.shell, k).stretches;
    }
    open_ = a.edges;
    ChartBox box;
    for (std::size_t k = 0; k < n; ++k) {
      if (!open_[k].empty) chart_.extend(box, *a.cone, a.cone->sides[k], open_[k]);
    }
    chart_.until_overlap(box, i, count_, [&](std::size_t j) { return !cover(a, *added_[j], j < i); });
    for (std::size_t k = 0; k < n; ++k) {
      if (!open_[k].empty) finish_edge(*a.cone, a.cone->sides[k], a.edges[k], covered_[k], false, sink);
    }
  }
}

}  // namespace exitance
