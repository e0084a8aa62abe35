#include "geometry/predicates.h"

#include <CGAL/Mpzf.h>

#include <cmath>

#include "geometry/bounded.h"

namespace exitance {
namespace {

using Exact = CGAL::Mpzf;

template <class NT>
struct Difference {
  NT x, y, z;
  Difference(const Vec3& p, const Vec3& q) : x(NT(p.x) - NT(q.x)), y(NT(p.y) - NT(q.y)), z(NT(p.z) - NT(q.z)) {}
  NT& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
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

/// |N|, by which a dropped point's difference is scaled.
template <class NT>
NT drop_scale(const ViewFrame& frame) {
  const Difference<NT> p(*frame.S.b, *frame.S.a), q(*frame.S.c, *frame.S.a);
  const NT N = frame.axis == 0   ? NT(p.y * q.z - p.z * q.y)
               : frame.axis == 1 ? NT(p.z * q.x - p.x * q.z)
                                 : NT(p.x * q.y - p.y * q.x);
  return frame.axis_sign > 0 ? N : NT(0) - N;
}

/// v − p, or |N| times that where v is dropped.
template <class NT>
Difference<NT> difference(const ViewFrame& frame, const Vec3& v, const Vec3& p, bool dropped) {
  Difference<NT> w(v, p);
  if (!dropped) return w;
  const NT N = drop_scale<NT>(frame), S = plane_value<NT>(frame.S, v);
  w.x = N * w.x;
  w.y = N * w.y;
  w.z = N * w.z;
  NT& along = w[frame.axis];
  along = frame.axis_sign > 0 ? NT(along - S) : NT(along + S);
  return w;
}

/// By what functional_at_vertex is scaled, positive.
template <class NT>
NT functional_scale(const ViewFrame& frame, const ViewPlane& plane, bool dropped) {
  NT scale(1);
  if (!dropped && !plane.dropped) return scale;
  const NT N = drop_scale<NT>(frame);
  if (dropped) scale = N;
  if (plane.dropped) scale = scale * N * N;
  return scale;
}

template <class NT>
NT functional_at_vertex(const ViewFrame& frame, const ViewPlane& plane, const Vec3& v, bool dropped) {
  switch (plane.kind) {
    case ViewPlane::Kind::edge:
      return determinant(difference<NT>(frame, *plane.c, frame.x, plane.dropped),
                         difference<NT>(frame, *plane.d, frame.x, plane.dropped),
                         difference<NT>(frame, v, frame.x, dropped));
    case ViewPlane::Kind::horizon: {
      const Difference<NT> w = difference<NT>(frame, v, frame.x, dropped);
      return NT(frame.normal.x) * w.x + NT(frame.normal.y) * w.y + NT(frame.normal.z) * w.z;
    }
    default: {
      const PlanePoints& T = *plane.T;
      const NT first =
          plane_value<NT>(frame.S, frame.x) *
          determinant(Difference<NT>(*T.b, *T.a), Difference<NT>(*T.c, *T.a), difference<NT>(frame, v, *T.a, dropped));
      return dropped ? first : first - plane_value<NT>(T, frame.x) * plane_value<NT>(frame.S, v);
    }
  }
}

template <class NT>
NT weight(const ViewFrame& frame, const ViewPoint& point, const Vec3& v) {
  if (point.kind == ViewPoint::Kind::at_source_plane) return plane_value<NT>(frame.S, v);
  return functional_at_vertex<NT>(frame, {ViewPlane::Kind::horizon}, v, point.dropped);
}

/// The functional at the point times `span`, which is positive.
template <class NT>
NT functional(const ViewFrame& frame, const ViewPlane& plane, const ViewPoint& point, NT& span) {
  span = functional_scale<NT>(frame, plane, point.dropped);
  if (point.kind == ViewPoint::Kind::vertex) return functional_at_vertex<NT>(frame, plane, *point.a, point.dropped);
  const NT a = weight<NT>(frame, point, *point.a), b = weight<NT>(frame, point, *point.b);
  const NT value = a * functional_at_vertex<NT>(frame, plane, *point.b, point.dropped) -
                   b * functional_at_vertex<NT>(frame, plane, *point.a, point.dropped);
  span = span * (point.sign_at_a > 0 ? NT(a - b) : NT(b - a));
  return point.sign_at_a > 0 ? value : NT(0) - value;
}

/// The last two stages for a polynomial given as a generic function of the number type.
template <class Polynomial>
int sign_of(const Polynomial& polynomial, StageCounts& counts) {
  if (const auto sign = certain_sign(polynomial.template operator()<Bounded>())) {
    ++counts.interval;
    return *sign;
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
  if (plane.dropped || point.dropped) return false;
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
  return certain_sign(orientation_value<Bounded>(a, b, c, v));
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

ExactValue exact_value_at(const ViewFrame& frame, const ViewPlane& plane, const ViewPoint& point, StageCounts& counts,
                          double accuracy) {
  if (is_zero_at_sight(frame.x, plane, point)) {
    ++counts.filter;
    return {};
  }
  {
    Bounded span(0);
    const Bounded scaled = functional<Bounded>(frame, plane, point, span);
    const auto sign = certain_sign(scaled);
    if (sign == 0) {
      ++counts.interval;
      return {};
    }
    if (sign && span.value() > span.certain_error()) {
      const long double relative = scaled.certain_error() / std::fabs(scaled.value()) +
                                   1.01L * span.certain_error() / (span.value() - span.certain_error());
      if (relative <= static_cast<long double>(accuracy)) {
        ++counts.interval;
        const auto value = static_cast<double>(scaled.value() / span.value());
        const double error = (static_cast<double>(relative) * 1.01 + 0x1p-52) * std::fabs(value);
        return {plane.sign * value, error, plane.sign * *sign};
      }
    }
  }
  ++counts.exact;
  Exact span;
  const Exact scaled = functional<Exact>(frame, plane, point, span);
  const double value = scaled.to_double() / span.to_double();
  return {plane.sign * value, 0x1p-48 * std::fabs(value), plane.sign * static_cast<int>(CGAL::sign(scaled))};
}

int gradient_sign(const ViewFrame& frame, const ViewPlane& plane) {
  using Vector = Difference<Exact>;
  const auto product = [](const Vector& a, const Vector& b) {
    Vector c = a;
    c.x = a.y * b.z - a.z * b.y;
    c.y = a.z * b.x - a.x * b.z;
    c.z = a.x * b.y - a.y * b.x;
    return c;
  };
  const auto first_sign = [&](const Vector& v) {
    for (const Exact* component : {&v.x, &v.y, &v.z}) {
      if (const int sign = static_cast<int>(CGAL::sign(*component)); sign != 0) return plane.sign * sign;
    }
    return 0;
  };
  switch (plane.kind) {
    case ViewPlane::Kind::edge:
      return first_sign(product(difference<Exact>(frame, *plane.c, frame.x, plane.dropped),
                                difference<Exact>(frame, *plane.d, frame.x, plane.dropped)));
    case ViewPlane::Kind::horizon:
      return first_sign(Vector(frame.normal, Vec3{}));
    default: {
      const auto normal = [&](const PlanePoints& p) { return product(Vector(*p.b, *p.a), Vector(*p.c, *p.a)); };
      const Exact S = plane_value<Exact>(frame.S, frame.x), T = plane_value<Exact>(*plane.T, frame.x);
      Vector of_T = normal(*plane.T), of_S = normal(frame.S);
      for (int axis = 0; axis < 3; ++axis) of_T[axis] = S * of_T[axis] - T * of_S[axis];
      return first_sign(of_T);
    }
  }
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

Vec3 exact_cross(const ViewFrame& frame, const ViewPlane& plane) {
  const auto p = difference<Exact>(frame, *plane.c, frame.x, true);
  const auto q = difference<Exact>(frame, *plane.d, frame.x, true);
  const double N = drop_scale<Exact>(frame).to_double(), scale = 1 / (N * N);
  return {scale * (p.y * q.z - p.z * q.y).to_double(), scale * (p.z * q.x - p.x * q.z).to_double(),
          scale * (p.x * q.y - p.y * q.x).to_double()};
}

double exact_drop(const ViewFrame& frame, const Vec3& v) {
  return frame.axis_sign * (plane_value<Exact>(frame.S, v).to_double() / drop_scale<Exact>(frame).to_double());
}

}  // namespace exitance
