#pragma once
// The cone of directions in which a convex polygon is seen from a point: its sides are planes through the point. All
// values are held in a number type Real (double, or extended precision) with proven error bounds; signs are always
// exact.

#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/predicates.h"

namespace exitance {

template <class Real>
struct Vec {
  Real x{}, y{}, z{};
};
template <class Real>
Vec<Real> operator-(const Vec<Real>& a, const Vec<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Real>
Vec<Real> operator+(const Vec<Real>& a, const Vec<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Real>
Vec<Real> operator*(const Real& s, const Vec<Real>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class Real>
Real dot(const Vec<Real>& a, const Vec<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
Vec<Real> cross(const Vec<Real>& a, const Vec<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Real>
Real norm(const Vec<Real>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}
template <class Real>
Vec<Real> difference(const Vec3& a, const Vec3& b) {
  return {Real(a.x) - Real(b.x), Real(a.y) - Real(b.y), Real(a.z) - Real(b.z)};
}

/// A value, a bound of its error, and the exact sign of the true value. A true zero is held as 0 ± 0.
template <class Real>
struct Signed {
  Real value{}, error{};
  int sign = 0;
};

/// A stretch of an edge, by its parameter from 0 (first corner) to 1, each end with a bound of its error.
template <class Real>
struct Stretch {
  Real lo{0}, hi{1}, lo_error{0}, hi_error{0};
  bool empty = false;  ///< by an exact decision
};

template <class Real>
struct ConeCorner {
  Vec<Real> w;       ///< from the point of view
  Real length{};     ///< |w|
  Real error{0};     ///< bound of |error of w| beyond the rounding of the difference of input coordinates
  bool kept = true;  ///< a corner of the cone; false where a clip cut it off and only an edge's line still needs it
  ViewPoint exact;
};

template <class Real>
struct ConeSide {
  Vec<Real> m;    ///< inward normal, not of unit length
  Real length{};  ///< |m|
  Real error{};   ///< |m − true m| ≤ error and |m · w − true| ≤ error |w| for a corner without error
  ViewPlane exact;
  Real sweep{1};                       ///< bound of |dθ/dt| along the edge, θ the angle under which x sees it
  std::uint32_t from = 0, to = 0;      ///< corners
  Stretch<Real> stretch;               ///< of the edge between them that bounds the cone
  std::uint32_t across = 0xffffffffu;  ///< facet that shares the edge; none: kNone
  bool below_horizon = false;          ///< neither corner is above the receiver's horizon
};

template <class Real>
struct Cone {
  std::vector<ConeCorner<Real>> corners;
  std::vector<ConeSide<Real>> sides;

  void clear() {
    corners.clear();
    sides.clear();
  }
};

/// Unit roundoff of the number type: 2^-53 for double.
template <class Real>
Real roundoff() {
  return std::numeric_limits<Real>::epsilon() / 2;
}

/// The plane through x and the edge between two corners. w has relative error u in each component, so has their
/// difference e when taken from the input; the cross product w × e adds two roundings: each component is wrong by at
/// most 4.01 u |w||e| (Cauchy–Schwarz on its two products), the vector by √3 times that, 7 u |w||e|. Its product with
/// w_v adds at most (1 + 3.01) u |w||e||w_v|: 11 u in all; 12 covers the rounding of the bound.
template <class Real>
void set_edge_plane(ConeSide<Real>& side, const Vec3& x, const ConeCorner<Real>& c, const ConeCorner<Real>& d,
                    int sign) {
  const Vec<Real> e = difference<Real>(*d.exact.a, *c.exact.a);
  const Vec<Real>& w = c.length < d.length ? c.w : d.w;
  side.m = sign > 0 ? cross(w, e) : cross(e, w);
  side.length = norm(side.m);
  side.error = 12 * roundoff<Real>() * (c.length < d.length ? c.length : d.length) * norm(e);
  side.exact = {ViewPlane::Kind::edge, sign, c.exact.a, d.exact.a, {}};
  // dθ/dt = |m| / |w(t)|², and the nearest that the edge comes is |m| / |e| when its foot lies between its corners.
  const Real length = norm(e);
  const bool foot_between = dot(c.w, e) < 0 && dot(d.w, e) > 0;
  const Real nearest = foot_between ? Real(side.length / length) : (c.length < d.length ? c.length : d.length);
  side.sweep = side.length / (nearest * nearest);
  if constexpr (std::is_same_v<Real, double>) {
    if (side.error > 0x1p-44 * side.length) {  // the edge's line passes near x
      const Vec3 m = sign * exact_cross(x, *c.exact.a, *d.exact.a);
      side.m = {m.x, m.y, m.z};
      side.length = norm(side.m);
      side.error = 8 * kRoundoff * side.length;  // 2^-50 of each component, and u in each of w
    }
  }
}

/// The side's functional at a corner, from exact arithmetic.
template <class Real>
Signed<Real> refined_value_at(const ConeSide<Real>& side, const ConeCorner<Real>& corner, const ViewFrame& frame,
                              StageCounts& counts) {
  const ExactValue v = exact_value_at(frame, side.exact, corner.exact, counts);
  // A value that underflows still has its sign.
  if (v.sign != 0 && v.value == 0) return {v.sign * std::numeric_limits<Real>::min(), Real(1), v.sign};
  return {Real(v.value), Real(v.error), v.sign};
}

/// The side's functional at a corner, its sign exact.
template <class Real>
Signed<Real> value_at(const ConeSide<Real>& side, const ConeCorner<Real>& corner, const ViewFrame& frame,
                      StageCounts& counts) {
  using std::fabs;
  Signed<Real> s{dot(side.m, corner.w), side.error * corner.length + (side.length + side.error) * corner.error, 0};
  if (s.value > s.error || s.value < -s.error) {
    ++counts.filter;
    s.sign = s.value > 0 ? 1 : -1;
    return s;
  }
  const bool own_vertex = side.exact.kind == ViewPlane::Kind::edge && corner.exact.kind == ViewPoint::Kind::vertex &&
                          (*side.exact.c == *corner.exact.a || *side.exact.d == *corner.exact.a);
  return own_vertex ? Signed<Real>{} : refined_value_at(side, corner, frame, counts);
}

/// Narrows the stretch to where the linear function from a (at 0) to b (at 1) is positive. Both zero is the caller's
/// case. refine(): called to make a and b more exact when the error of the crossing exceeds `bearable`.
template <class Real, class Refine>
void narrow(Stretch<Real>& stretch, Signed<Real>& a, Signed<Real>& b, const Real& bearable, const Refine& refine) {
  using std::fabs;
  if (a.sign <= 0 && b.sign <= 0) {
    stretch.empty = true;
  } else if (a.sign * b.sign < 0) {
    // t = |a| / (|a| + |b|): |δt| ≤ (|b| δa + |a| δb) / (|a| + |b|)² to first order; where the errors are not small
    // against the sum, all is open.
    const auto error_of_crossing = [&] {
      const Real size_a = fabs(a.value), size_b = fabs(b.value), span = size_a + size_b;
      return 100 * (a.error + b.error) < span
                 ? Real(Real(1.05) * (size_b / span * a.error + size_a / span * b.error) / span)
                 : Real(1);
    };
    Real error = error_of_crossing();
    if (error > bearable) {
      refine();
      error = error_of_crossing();
    }
    error += 3 * roundoff<Real>();
    const Real t = fabs(a.value) / (fabs(a.value) + fabs(b.value));
    if (a.sign > 0) {
      if (t - error < stretch.hi + stretch.hi_error && error > stretch.hi_error) stretch.hi_error = error;
      if (t < stretch.hi) stretch.hi = t;
    } else {
      if (t + error > stretch.lo - stretch.lo_error && error > stretch.lo_error) stretch.lo_error = error;
      if (t > stretch.lo) stretch.lo = t;
    }
  }
}

/// Cuts the cone of a convex polygon (side i runs from corner i to corner i + 1) down to where `weight`, a functional
/// known at its corners, is positive; `closing` is the side that the cut makes, without its corners. New corners stay
/// implicit. A polygon that only touches the plane is not changed; one without a positive corner must not be given.
template <class Real>
void clip(Cone<Real>& cone, const std::vector<Signed<Real>>& weight, ViewPoint::Kind kind,
          const ConeSide<Real>& closing) {
  const auto n = static_cast<std::uint32_t>(cone.sides.size());
  std::uint32_t start = 0;
  while (weight[start].sign <= 0) ++start;
  bool inside = true;
  std::uint32_t exit = 0;
  std::vector<ConeSide<Real>> sides;

  const auto crossing = [&](const ConeSide<Real>& side, const Stretch<Real>& s, const Real& t) {
    const ConeCorner<Real>&a = cone.corners[side.from], &b = cone.corners[side.to];
    ConeCorner<Real> c;
    const Vec<Real> e = b.w - a.w;
    c.w = a.w + t * e;
    c.length = norm(c.w);
    const Real dt = s.lo_error > s.hi_error ? s.lo_error : s.hi_error;
    c.error = norm(e) * dt + 8 * roundoff<Real>() * (a.length + b.length);
    c.exact = {kind, a.exact.on_source, weight[side.from].sign, a.exact.a, b.exact.a};
    cone.corners.push_back(c);
    return static_cast<std::uint32_t>(cone.corners.size() - 1);
  };
  const auto close = [&](std::uint32_t from, std::uint32_t to) {
    sides.push_back(closing);
    sides.back().from = from;
    sides.back().to = to;
  };

  for (std::uint32_t k = 0; k < n; ++k) {
    ConeSide<Real> side = cone.sides[(start + k) % n];
    const Signed<Real>&a = weight[side.from], &b = weight[side.to];
    if (a.sign * b.sign < 0) {
      Signed<Real> from = a, to = b;
      narrow(side.stretch, from, to, Real(1), [] {});
      const std::uint32_t point = crossing(side, side.stretch, inside ? side.stretch.hi : side.stretch.lo);
      if (!inside) close(exit, point);
      exit = point;
      inside = !inside;
      sides.push_back(side);
    } else if (inside && b.sign < 0) {  // leaves through its corner a
      exit = side.from;
      inside = false;
    } else if (!inside && b.sign > 0) {  // comes back through its corner a
      close(exit, side.from);
      inside = true;
      sides.push_back(side);
    } else if (inside) {
      sides.push_back(side);
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) cone.corners[i].kept = weight[i].sign >= 0;
  cone.sides = std::move(sides);
}

}  // namespace exitance
