#pragma once
// Lambert's form factor from a point to a region, summed along the region's boundary.

#include <boost/math/constants/constants.hpp>

#include "geometry/visible_region.h"

namespace exitance {

/// F = 1/2π Σ θ (n·m): over the arcs of the boundary, θ the angle that an arc subtends at the point and m the unit
/// normal of the plane through point and arc, towards the region (Lambert 1760). Add arcs, then ask.
template <class Real>
class LambertSum {
 public:
  explicit LambertSum(const Vec3& normal) : n_{Real(normal.x), Real(normal.y), Real(normal.z)}, n_length_(norm(n_)) {}

  /// Gives the angle [rad] under which the arc is seen.
  Real add(const Arc<Real>& arc) {
    using std::atan2;
    using std::fabs;
    const Real u = roundoff<Real>();
    const ConeSide<Real>& side = *arc.side;
    const Corners<Real>& corners = arc.cone->corners;
    const std::uint32_t from = side.from, to = side.to;
    const Vec<Real> p = corners.w(from);
    const Real p_length = corners.length(from);
    const bool of_vertices = side.exact.kind == ViewPlane::Kind::edge;
    const Vec<Real> e = of_vertices && !side.exact.dropped
                            ? difference<Real>(*corners.exact(to).a, *corners.exact(from).a)
                            : corners.w(to) - p;
    const Real e_length = norm(e);
    const Vec<Real> w0 = p + arc.t0 * e, w1 = p + arc.t1 * e;
    const Real length0 = norm(w0), length1 = norm(w1);
    // For an edge of input vertices |p × e| is the length of the side's normal, if that is known.
    const bool normal_is_known = 20 * side.error < side.length, by_normal = of_vertices && normal_is_known;
    const Real C = by_normal ? side.length : norm(cross(p, e));
    const Real S = (arc.t1 - arc.t0) * C, D = dot(w0, w1);
    const Real theta = atan2(S, D);

    // δw: three roundings on parts no longer than |p| + |e|, and what the corners carry. δC: that of the side's normal,
    // or 7 u |p||e| and the corners'. δθ ≤ (δS + δD) / (|w0||w1|), as S² + D² = |w0|²|w1|²; 1.1 covers the second
    // order, which the comparison keeps small. δg ≤ 1.1 δm / |m| and 8 roundings.
    const Real corner = corners.error(from) + corners.error(to);
    const Real dw = 4 * u * (p_length + e_length) + corner;
    const Real dC = by_normal ? side.error : Real(8 * u * p_length * e_length + corner * (e_length + p_length));
    const Real product = length0 * length1;
    Real dtheta = ((arc.t1 - arc.t0) * dC + 4 * u * S) / product + dw * (1 / length0 + 1 / length1) + 8 * u;
    // An end that is wrong by δt moves by |dw/dt| δt across, seen under C / |w|².
    dtheta += C * (arc.t0_error / (length0 * length0) + arc.t1_error / (length1 * length1));
    dtheta *= Real(1.1);
    const bool ends_are_known = 20 * dw < (length0 < length1 ? length0 : length1) &&
                                20 * arc.t0_error * e_length < length0 && 20 * arc.t1_error * e_length < length1;
    ++arcs_;
    if (!ends_are_known) {  // nothing is known; an arc is shorter than π
      error_ += boost::math::constants::pi<Real>();
      return theta;
    }
    if (!normal_is_known) {  // as of a cut by a plane that is the source's but for rounding; |g| ≤ 1
      error_ += theta + dtheta;
      return theta;
    }
    const Real g = dot(n_, side.m) / (n_length_ * side.length), dg = Real(1.1) * side.error / side.length + 8 * u;
    const Real term = g * theta;
    add(arc.of_source ? term : Real(-term));
    error_ += fabs(g) * dtheta + theta * dg + 4 * u * fabs(term);
    size_ += fabs(term);
    return theta;
  }

  std::size_t arcs() const { return arcs_; }
  Real value() const { return (sum_ + lost_) / (2 * boost::math::constants::pi<Real>()); }
  /// Proven bound of |value − true value|. What is lost in each addition is at most u times a partial sum, n size u in
  /// all, is kept exactly and summed with n roundings: n² u² size, and 4 u size for the last steps.
  Real error() const {
    const Real u = roundoff<Real>(), n = static_cast<double>(arcs_) + 1;
    return (error_ + (4 + n * n * u) * u * size_) / (2 * boost::math::constants::pi<Real>());
  }

 private:
  /// Adds a term and keeps what rounding loses (Neumaier 1974).
  void add(const Real& term) {
    using std::fabs;
    const Real sum = sum_ + term;
    lost_ += fabs(sum_) >= fabs(term) ? Real((sum_ - sum) + term) : Real((term - sum) + sum_);
    sum_ = sum;
  }

  Vec<Real> n_;
  Real n_length_;
  Real sum_{0}, lost_{0}, error_{0}, size_{0};
  std::size_t arcs_ = 0;
};

}  // namespace exitance
