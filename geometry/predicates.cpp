#include "geometry/predicates.h"

#include <CGAL/Interval_nt.h>
#include <CGAL/Mpzf.h>

#include <cmath>

namespace exitance {
namespace {

using Interval = CGAL::Interval_nt<false>;
using Exact = CGAL::Mpzf;

template <class NT>
struct Difference {
  NT x, y, z;
  Difference(const Vec3& p, const Vec3& q) : x(NT(p.x) - NT(q.x)), y(NT(p.y) - NT(q.y)), z(NT(p.z) - NT(q.z)) {}
};

template <class NT>
NT determinant(const Difference<NT>& a, const Difference<NT>& b, const Difference<NT>& c) {
  return (a.y * b.z - a.z * b.y) * c.x + (a.z * b.x - a.x * b.z) * c.y + (a.x * b.y - a.y * b.x) * c.z;
}

template <class NT>
NT orientation_value(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& v) {
  return determinant(Difference<NT>(b, a), Difference<NT>(c, a), Difference<NT>(v, a));
}

template <class NT>
NT horizon_value(const Vec3& x, const Vec3& normal, const Vec3& v) {
  const Difference<NT> w(v, x);
  return NT(normal.x) * w.x + NT(normal.y) * w.y + NT(normal.z) * w.z;
}

template <class NT>
NT plane_value(const PlanePoints& plane, const Vec3& v) {
  return orientation_value<NT>(*plane.a, *plane.b, *plane.c, v);
}

template <class NT>
NT functional_at_vertex(const ViewFrame& frame, const ViewPlane& plane, const Vec3& v, bool on_source) {
  switch (plane.kind) {
    case ViewPlane::Kind::edge:
      return determinant(Difference<NT>(*plane.c, frame.x), Difference<NT>(*plane.d, frame.x),
                         Difference<NT>(v, frame.x));
    case ViewPlane::Kind::horizon:
      return horizon_value<NT>(frame.x, frame.normal, v);
    default: {
      const NT first = plane_value<NT>(frame.S, frame.x) * plane_value<NT>(*plane.T, v);
      return on_source ? first : first - plane_value<NT>(*plane.T, frame.x) * plane_value<NT>(frame.S, v);
    }
  }
}

template <class NT>
NT weight(const ViewFrame& frame, const ViewPoint& point, const Vec3& v) {
  return point.kind == ViewPoint::Kind::at_horizon ? horizon_value<NT>(frame.x, frame.normal, v)
                                                   : plane_value<NT>(frame.S, v);
}

/// The functional at the point times `span`, which is positive.
template <class NT>
NT functional(const ViewFrame& frame, const ViewPlane& plane, const ViewPoint& point, NT& span) {
  if (point.kind == ViewPoint::Kind::vertex) {
    span = NT(1);
    return functional_at_vertex<NT>(frame, plane, *point.a, point.on_source);
  }
  const NT a = weight<NT>(frame, point, *point.a), b = weight<NT>(frame, point, *point.b);
  const NT value = a * functional_at_vertex<NT>(frame, plane, *point.b, point.on_source) -
                   b * functional_at_vertex<NT>(frame, plane, *point.a, point.on_source);
  span = point.sign_at_a > 0 ? a - b : b - a;
  return point.sign_at_a > 0 ? value : NT(0) - value;
}

/// Sign of an interval that doesn't hold 0. Overflow gives an interval that does, or one with a NaN, which decides
/// nothing.
std::optional<int> certain_sign(const Interval& value) {
  if (value.inf() > 0) return 1;
  if (value.sup() < 0) return -1;
  if (value.inf() == 0 && value.sup() == 0) return 0;
  return std::nullopt;
}

/// The last two stages for a polynomial given as a generic function of the number type.
template <class Polynomial>
int sign_of(const Polynomial& polynomial, StageCounts& counts) {
  {
    const Interval::Protector rounding;
    if (const auto sign = certain_sign(polynomial.template operator()<Interval>())) {
      ++counts.interval;
      return *sign;
    }
  }
  ++counts.exact;
  return static_cast<int>(CGAL::sign(polynomial.template operator()<Exact>()));
}

/// A value whose error is at most `bound` has a certain sign when it exceeds it. Underflow in a product of three adds
/// less than 2^-1000; NaN and overflow decide nothing.
std::optional<int> certain_sign(double value, double bound) {
  bound += 0x1p-1000;
  if (value > bound) return 1;
  if (value < -bound) return -1;
  return std::nullopt;
}

/// Whether the plane through x and an edge holds the vertex for all to see: all four lie in one plane across an axis,
/// or the edge and the vertex on one line along an axis. In buildings nearly all zeros are of these kinds.
bool is_zero_at_sight(const Vec3& x, const ViewPlane& plane, const ViewPoint& point) {
  if (plane.kind != ViewPlane::Kind::edge || point.kind != ViewPoint::Kind::vertex) return false;
  const Vec3 &c = *plane.c, &d = *plane.d, &v = *point.a;
  const bool x_same = c.x == d.x && c.x == v.x, y_same = c.y == d.y && c.y == v.y, z_same = c.z == d.z && c.z == v.z;
  return (x_same && y_same) || (y_same && z_same) || (z_same && x_same) || (x_same && x.x == v.x) ||
         (y_same && x.y == v.y) || (z_same && x.z == v.z);
}

}  // namespace

std::optional<int> orientation_filter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& v) {
  const Vec3 p = b - a, q = c - a, w = v - a;
  const Vec3 yz{p.y * q.z, p.z * q.x, p.x * q.y}, zy{p.z * q.y, p.x * q.z, p.y * q.x};
  const Vec3 minor = yz - zy;
  const double value = dot(minor, w);
  // Each product of three carries 3 roundings of differences, 2 of products, 1 of the minor, at most 3 of the sum: 9 in
  // all; 10 covers the rounding of the bound itself.
  const double permanent = (std::fabs(yz.x) + std::fabs(zy.x)) * std::fabs(w.x) +
                           (std::fabs(yz.y) + std::fabs(zy.y)) * std::fabs(w.y) +
                           (std::fabs(yz.z) + std::fabs(zy.z)) * std::fabs(w.z);
  return certain_sign(value, 10 * kRoundoff * permanent);
}

std::optional<int> orientation_interval(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& v) {
  const Interval::Protector rounding;
  return certain_sign(orientation_value<Interval>(a, b, c, v));
}

int orientation_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& v) {
  return static_cast<int>(CGAL::sign(orientation_value<Exact>(a, b, c, v)));
}

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& v, StageCounts& counts) {
  if (const auto sign = orientation_filter(a, b, c, v)) {
    ++counts.filter;
    return *sign;
  }
  return sign_of([&]<class NT>() { return orientation_value<NT>(a, b, c, v); }, counts);
}

int horizon_side(const Vec3& x, const Vec3& normal, const Vec3& v, StageCounts& counts) {
  const Vec3 w = v - x;
  const Vec3 terms{normal.x * w.x, normal.y * w.y, normal.z * w.z};
  // One rounding of a difference, one of a product, at most two of the sum; 5 covers the rounding of the bound.
  const double bound = 5 * kRoundoff * (std::fabs(terms.x) + std::fabs(terms.y) + std::fabs(terms.z));
  if (const auto sign = certain_sign(terms.x + terms.y + terms.z, bound)) {
    ++counts.filter;
    return *sign;
  }
  return sign_of([&]<class NT>() { return horizon_value<NT>(x, normal, v); }, counts);
}

ExactValue exact_value_at(const ViewFrame& frame, const ViewPlane& plane, const ViewPoint& point, StageCounts& counts) {
  if (is_zero_at_sight(frame.x, plane, point)) {
    ++counts.filter;
    return {};
  }
  {
    const Interval::Protector rounding;
    Interval span;
    const Interval scaled = functional<Interval>(frame, plane, point, span);
    if (scaled.inf() == 0 && scaled.sup() == 0) {
      ++counts.interval;
      return {};
    }
    if ((scaled.inf() > 0 || scaled.sup() < 0) && span.inf() > 0) {
      const Interval value = scaled / span;
      const double middle = 0.5 * (value.inf() + value.sup()), width = value.sup() - value.inf();
      if (width <= 0x1p-44 * std::fabs(middle)) {
        ++counts.interval;
        return {plane.sign * middle, width, middle > 0 ? plane.sign : -plane.sign};
      }
    }
  }
  ++counts.exact;
  Exact span;
  const Exact scaled = functional<Exact>(frame, plane, point, span);
  const double value = scaled.to_double() / span.to_double();
  return {plane.sign * value, 0x1p-48 * std::fabs(value), plane.sign * static_cast<int>(CGAL::sign(scaled))};
}

ExactValue exact_plane_value(const PlanePoints& plane, const Vec3& v) {
  const Exact exact = plane_value<Exact>(plane, v);
  const double value = exact.to_double();
  return {value, 0x1p-48 * std::fabs(value), static_cast<int>(CGAL::sign(exact))};
}

Vec3 exact_cross(const Vec3& x, const Vec3& c, const Vec3& d) {
  const Difference<Exact> p(c, x), q(d, x);
  return {(p.y * q.z - p.z * q.y).to_double(), (p.z * q.x - p.x * q.z).to_double(),
          (p.x * q.y - p.y * q.x).to_double()};
}

}  // namespace exitance
