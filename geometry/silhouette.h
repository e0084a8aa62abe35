#pragma once
// The silhouette of a solid that need not be convex, and which stretches of an edge the solid covers.
//
// The faces of a solid that are seen from the front form layers over the directions from the point of view. Their
// number changes by one across every edge of the silhouette (edges between a face seen from the front and one that is
// not), up towards the front face, and is 0 below the horizon, above which the whole solid must lie. So along an edge
// pq of anything, p an end above the horizon, it is found by going on from p along the great circle through q, half way
// round, to below the horizon: where a silhouette edge cd crosses, the signs of c and d against the plane of pq differ,
// and the sign of p against that of cd tells whether it crosses before or behind p, and which way. No corner of the
// chain, no depth and no other layer matters: of 1,000 faces of a vase 60 edges are left (Appel 1967 counts layers in
// front of an edge in the same way).
//
// Ties of a corner of a solid with an edge of another body are broken by moving the one of them by an infinitesimal
// (gradient_sign), the same for all edges, so that all answers are those of one and the same scene, whose form factor
// has the true one as its limit; an end of pq in the plane of cd is no tie, because it decides over no length. Along
// its own edges the solid is asked on their outer sides; where that does not break a tie, because two of its edges
// coincide, there is no silhouette, and the solid's facets must be taken one by one.

#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/cone.h"

namespace exitance {

template <class Real>
struct Silhouette {
  /// What the solid itself covers of an edge, on its outer side.
  struct Hidden {
    bool is_known = false;
    bool is_all = false;
    std::vector<Stretch<Real>> stretches;
  };
  Cone<Real> cone;             ///< its edges, in any order; the solid on their inner sides
  std::vector<Hidden> hidden;  ///< of each, once it is asked for (hidden_of)
  bool is_usable = false;      ///< above the horizon, without edges that coincide
};

/// [1/rad] Where nothing coarser is asked for, crossings are known to 2^-46.
inline constexpr double kFinestPerAngle = 0x1p46;

/// What the functionals of one view are evaluated with.
struct Evaluation {
  const ViewFrame& frame;
  StageCounts& counts;
  double per_bearable_angle;  ///< of a crossing [1/rad]

  /// What the error of a crossing on an edge is to be multiplied by, to exceed 1 where it is not bearable: beyond the
  /// angle, or 2^-20 of the edge.
  template <class Real>
  Real weight(const Real& sweep) const {
    return Real(sweep * Real(per_bearable_angle) + Real(0x1p20));
  }
};

/// Which way ties are broken between an edge and a silhouette.
enum class Tie {
  silhouette_moves,
  edge_moves,
  own_edge  ///< the edge is the silhouette's own, and asked about on its outer side
};

/// Stretches of an edge over which a solid has layers, appended to `covered`; true if that is all of it, exactly.
/// Stretches overlap where there are several layers.
template <class Real>
class LayersOverEdge {
 public:
  bool find(const Cone<Real>& cone, const ConeSide<Real>& edge, const Silhouette<Real>& silhouette, Tie tie,
            const Evaluation& evaluation, std::vector<Stretch<Real>>& covered) {
    if (edge.exact.kind == ViewPlane::Kind::horizon) return false;  // all of the solid is above
    const Cone<Real>& solid = silhouette.cone;
    row_.fill(edge, solid.corners, evaluation.frame, evaluation.counts);
    changes_.clear();
    int before = 0;  // layers at the edge's start
    int anchor = -1, broken_tie = 0;
    const auto side_of = [&](std::uint32_t corner) {
      if (const int sign = row_.sign(corner); sign != 0) return sign;
      if (broken_tie == 0) broken_tie = break_tie(edge, tie, evaluation.frame);
      return broken_tie;
    };
    for (const ConeSide<Real>& crossed : solid.sides) {
      const int side_from = side_of(crossed.from), side_to = side_of(crossed.to);
      if (side_from == side_to) continue;
      // Below the horizon is the end of the way from an end that is above.
      if (anchor < 0) anchor = is_above(cone.corners, edge.from, evaluation) ? 0 : 1;
      const std::uint32_t ends[] = {edge.from, edge.to};
      const Signed<Real> near = value_at(crossed, cone.corners, ends[anchor], evaluation.frame, evaluation.counts);
      if (near.sign == 0) continue;  // crosses at the very end that the way leaves, or far below
      const int ahead = side_to * cone.turn * near.sign * solid.turn * (anchor == 0 ? 1 : -1);
      if (ahead < 0) continue;
      const Signed<Real> far = value_at(crossed, cone.corners, ends[1 - anchor], evaluation.frame, evaluation.counts);
      if (far.sign == -near.sign) {
        changes_.push_back(
            crossing(crossed, cone, edge, anchor == 0 ? near : far, anchor == 0 ? far : near, evaluation));
        changes_.back().step = anchor == 0 ? -near.sign : near.sign;
        if (anchor == 0) before += near.sign;
      } else {
        before += near.sign;  // beyond the other end, or there
      }
    }
    return append(before, covered);
  }

 private:
  struct Change {
    Real t{}, error{};
    int step = 0;
  };

  /// The side of the edge on which corners of the solid are taken to lie that are in its plane.
  static int break_tie(const ConeSide<Real>& edge, Tie tie, const ViewFrame& frame) {
    if (tie == Tie::own_edge) return 1;
    const int moved = gradient_sign(frame, edge.exact);
    return moved == 0 ? 1 : tie == Tie::silhouette_moves ? moved : -moved;
  }

  static bool is_above(const Corners<Real>& corners, std::uint32_t k, const Evaluation& evaluation) {
    const ViewFrame& frame = evaluation.frame;
    const Vec<Real> n{Real(frame.normal.x), Real(frame.normal.y), Real(frame.normal.z)};
    const Real value = dot(n, corners.w(k)), size = norm(n),
               error = 5 * roundoff<Real>() * size * corners.length(k) + 2 * size * corners.error(k);
    if (value > error || value < -error) return value > 0;
    return exact_value_at(frame, {ViewPlane::Kind::horizon}, corners.exact(k), evaluation.counts).sign > 0;
  }

  static Change crossing(const ConeSide<Real>& crossed, const Cone<Real>& cone, const ConeSide<Real>& edge,
                         const Signed<Real>& at_from, const Signed<Real>& at_to, const Evaluation& evaluation) {
    Stretch<Real> stretch;
    narrow(stretch, at_from, at_to, evaluation.weight(edge.sweep),
           [&](Signed<Real>& a, Signed<Real>& b, double accuracy) {
             if constexpr (!std::is_floating_point_v<Real>) return;
             const auto refined = [&](std::uint32_t end) {
               return refined_value_at(crossed, cone.corners.exact(end), evaluation.frame, evaluation.counts, accuracy);
             };
             a = refined(edge.from);
             b = refined(edge.to);
           });
    return at_from.sign > 0 ? Change{stretch.hi, stretch.hi_error, 0} : Change{stretch.lo, stretch.lo_error, 0};
  }

  /// A stretch for every layer, the first that begins the first to end, whatever order rounding has put the crossings
  /// in: so each end of what is covered keeps its error.
  bool append(int layers, std::vector<Stretch<Real>>& covered) {
    if (changes_.empty()) {
      if (layers > 0) covered.emplace_back();
      return layers > 0;
    }
    std::ranges::stable_sort(changes_, {}, &Change::t);
    begun_.assign(static_cast<std::size_t>(std::max(layers, 0)), Change{});
    ended_.clear();
    for (const Change& c : changes_) (c.step > 0 ? begun_ : ended_).push_back(c);
    if (ended_.size() < begun_.size()) ended_.resize(begun_.size(), Change{Real(1), Real(0), -1});
    for (std::size_t k = 0; k < begun_.size(); ++k) {
      covered.push_back({begun_[k].t, ended_[k].t, begun_[k].error, ended_[k].error, false});
    }
    return false;
  }

  Row<Real> row_;
  std::vector<Change> changes_, begun_, ended_;
};

/// Whether edges that lie in one plane through the point of view run the same way and overlap.
inline bool coincide(const Vec3& x, const ViewPlane& a, const ViewPlane& b) {
  const auto run_along = [&](const Vec3& u, const Vec3& v) {  // from u to v the way that a runs
    const Vec3 n = exact_cross(x, *a.c, *a.d), m = exact_cross(x, u, v);
    const double along = n.x != 0 ? n.x * m.x : n.y != 0 ? n.y * m.y : n.z * m.z;
    return along > 0;
  };
  return run_along(*b.c, *b.d) && run_along(*a.c, *b.d) && run_along(*b.c, *a.d);
}

/// Whether edges of the silhouette coincide. Those that do have one and the same side, so that one component of its
/// unit normal, known to within 1.1 error / |m| and 4 roundings, sorts them next to each other.
template <class Real>
bool has_edges_that_coincide(const Silhouette<Real>& silhouette, const Evaluation& evaluation) {
  const auto& sides = silhouette.cone.sides;
  struct Range {
    double lo, hi;
    std::uint32_t edge;
  };
  std::vector<Range> ranges;
  ranges.reserve(sides.size());
  for (std::uint32_t k = 0; k < sides.size(); ++k) {
    const ConeSide<Real>& side = sides[k];
    const double x = static_cast<double>(Real(side.m.x / side.length)),
                 error = static_cast<double>(Real(side.error / side.length)) * 1.1 + 8 * kRoundoff;
    ranges.push_back(error < 0.01 ? Range{x - error, x + error, k} : Range{-2, 2, k});
  }
  std::ranges::sort(ranges, {}, [](const Range& r) { return std::pair(r.lo, r.edge); });
  const auto in_plane_of = [&](const ConeSide<Real>& side, std::uint32_t corner) {
    return value_at(side, silhouette.cone.corners, corner, evaluation.frame, evaluation.counts).sign == 0;
  };
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    for (std::size_t j = i + 1; j < ranges.size() && ranges[j].lo <= ranges[i].hi; ++j) {
      const ConeSide<Real>&a = sides[ranges[i].edge], &b = sides[ranges[j].edge];
      if (in_plane_of(a, b.from) && in_plane_of(a, b.to) && coincide(evaluation.frame.x, a.exact, b.exact)) return true;
    }
  }
  return false;
}

}  // namespace exitance
