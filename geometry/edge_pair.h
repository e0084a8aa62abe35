#pragma once
// The integral of ln r over two straight edges, r the distance between a point of one and a point of the other.
//
//  - Edges on lines that meet: from there f = ln r² is homogeneous up to a constant, so that Euler's theorem turns the
//    integral into two over single edges.
//  - Parallel edges: the second difference of an elementary function.
//  - Otherwise the integral along one edge is elementary, and Gauss–Legendre panels do the other. As a function of the
//    outer parameter the inner integral is analytic but for three pairs of complex points: where the outer line is at
//    distance zero from a corner of the inner edge, and from its line. A panel's rule converges like ρ^-2n, ρ the sum
//    of the half axes of the ellipse around the panel that passes through the nearest of them; panels shrink towards
//    them until that suffices, or until they are too short to matter.

#include <algorithm>
#include <array>
#include <boost/container/small_vector.hpp>
#include <boost/container/static_vector.hpp>
#include <cmath>

#include "geometry/cone.h"
#include "geometry/gauss_rule.h"

namespace exitance {

/// An edge of positive length.
template <class Real>
struct SpaceEdge {
  Vec<Real> from, to, direction;  ///< of unit length
  Real length{};
};

/// A sum with what its terms add up to in size, of which roundings are a share, and its truncation error.
template <class Real>
struct LogIntegral {
  Real value{0};
  double size = 0, truncation = 0;
};

template <class Real>
Real log_or_zero(const Real& x) {
  using std::log;
  return x > 0 ? Real(log(x)) : Real(0);
}

/// ∫∫ ln |s u − t v| ds dt, s from 0 to S, t from 0 to T; u · v = c, |u × v| = sine, R the distance of the far ends.
template <class Real>
LogIntegral<Real> from_common_corner(const Real& S, const Real& T, const Real& c, const Real& sine, const Real& R) {
  using std::atan2;
  using std::fabs;
  using std::log;
  using std::log1p;
  const Real ln_S = log(S), ln_T = log(T), ln_R = log_or_zero(R);
  // ln(R²/S²), without cancellation where T is short against S.
  const auto log_ratio = [&](const Real& s, const Real& t, const Real& ln_s) {
    const Real x = t * (t - 2 * s * c) / (s * s);
    return fabs(x) < Real(0.25) ? Real(log1p(x)) : Real(2 * (ln_R - ln_s));
  };
  const Real of_S = S * S * (2 * sine * atan2(T * sine, S - T * c) - c * log_ratio(S, T, ln_S)),
             of_T = T * T * (2 * sine * atan2(S * sine, T - S * c) - c * log_ratio(T, S, ln_T)), product = S * T;
  LogIntegral<Real> result;
  result.value = Real(0.25) * (of_S + of_T) + product * (ln_R - Real(1.5));
  result.size = static_cast<double>(fabs(of_S) + fabs(of_T) + product * (fabs(ln_R) + 2));
  return result;
}

/// The same for edges on lines that meet, s from s0 to s1 and t from t0 to t1 in the distance from where they do.
template <class Real>
LogIntegral<Real> between_meeting(const std::array<Real, 2>& s, const std::array<Real, 2>& t, const Real& c,
                                  const Real& sine) {
  using std::fabs;
  using std::sqrt;
  LogIntegral<Real> result;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      const Real S = fabs(s[i]), T = fabs(t[j]);
      if (!(S > 0) || !(T > 0)) continue;
      const bool same_side = (s[i] > 0) == (t[j] > 0);
      const Real cosine = same_side ? c : Real(-c);
      const Real along = T - S * cosine, R = sqrt(along * along + S * S * sine * sine);
      const LogIntegral<Real> part = from_common_corner(S, T, cosine, sine, R);
      // ∫ from s0 to s1 is that to s1 less that to s0, and one that runs backwards counts negative.
      const bool positive = (i == j) == same_side;
      result.value = positive ? Real(result.value + part.value) : Real(result.value - part.value);
      result.size += part.size;
    }
  }
  return result;
}

/// Φ with Φ'' = ln √(h² + x²).
template <class Real>
Real second_antiderivative(const Real& x, const Real& h, double& size) {
  using std::atan2;
  using std::fabs;
  const Real first = Real(0.25) * (x * x - h * h) * log_or_zero(Real(h * h + x * x));
  const Real second = h > 0 ? Real(h * fabs(x) * atan2(fabs(x), h)) : Real(0);
  const Real third = Real(0.75) * x * x;
  size += static_cast<double>(fabs(first) + second + third);
  return first + second - third;
}

/// Edges along one direction: from x0 to x1 and from y0 to y1, at the distance h across.
template <class Real>
LogIntegral<Real> between_parallels(const Real& x0, const Real& x1, const Real& y0, const Real& y1, const Real& h) {
  LogIntegral<Real> result;
  const auto phi = [&](const Real& x) { return second_antiderivative(x, h, result.size); };
  result.value = (phi(x1 - y0) - phi(x0 - y0)) - (phi(x1 - y1) - phi(x0 - y1));
  return result;
}

/// ∫ ln |x − y| dy along an edge.
template <class Real>
Real seen_edge(const Vec<Real>& x, const SpaceEdge<Real>& edge, double& size) {
  using std::atan2;
  using std::fabs;
  using std::sqrt;
  const Vec<Real> w = edge.from - x;
  const Real s0 = dot(w, edge.direction), s1 = s0 + edge.length;
  const Vec<Real> across = w - s0 * edge.direction;
  const Real square = dot(across, across), d = sqrt(square);
  const Real end = Real(0.5) * s1 * log_or_zero(Real(square + s1 * s1)),
             start = Real(0.5) * s0 * log_or_zero(Real(square + s0 * s0));
  const Real angle = d > 0 ? Real(d * atan2(edge.length * d, square + s0 * s1)) : Real(0);
  size = static_cast<double>(fabs(end) + fabs(start) + angle + edge.length);
  return end - start - edge.length + angle;
}

/// Where the inner integral stops being analytic, in the outer parameter: x ± i y.
template <class Real>
struct SingularPair {
  Real x{};
  double y = 0;
};
template <class Real>
using SingularPairs = boost::container::static_vector<SingularPair<Real>, 3>;

template <class Real>
SingularPairs<Real> singular_pairs(const SpaceEdge<Real>& outer, const SpaceEdge<Real>& inner) {
  using std::sqrt;
  SingularPairs<Real> pairs;
  const auto near_point = [&](const Vec<Real>& v) {
    const Vec<Real> w = v - outer.from;
    const Real along = dot(w, outer.direction);
    const Vec<Real> across = w - along * outer.direction;
    pairs.push_back({along, static_cast<double>(norm(across))});
  };
  near_point(inner.from);
  near_point(inner.to);
  // The lines are nearest at outer parameter x and inner parameter s.
  const Vec<Real> w = inner.from - outer.from, normal = cross(outer.direction, inner.direction);
  const Real sine_square = dot(normal, normal);
  if (sine_square > 0) {
    const Real x = dot(cross(w, inner.direction), normal) / sine_square;
    const double s = static_cast<double>(Real(dot(cross(w, outer.direction), normal) / sine_square)),
                 length = static_cast<double>(inner.length);
    const double y = std::fabs(static_cast<double>(dot(w, normal))) / static_cast<double>(sine_square);
    if (-0.1 * length < s && s < 1.1 * length) pairs.push_back({x, y});
  }
  return pairs;
}

/// ρ of the ellipse with foci lo and hi through x ± i y.
template <class Real>
double ellipse(const Real& lo, const Real& hi, const SingularPair<Real>& z) {
  const double sum =
      (std::hypot(static_cast<double>(Real(z.x - lo)), z.y) + std::hypot(static_cast<double>(Real(z.x - hi)), z.y)) /
      static_cast<double>(Real(hi - lo));
  return sum > 1 ? sum + std::sqrt(sum * sum - 1) : 1;
}

/// By panels, to about `tolerance`.
template <class Real>
LogIntegral<Real> by_panels(const SpaceEdge<Real>& outer, const SpaceEdge<Real>& inner, double tolerance) {
  constexpr int highest = kHighestOrder<Real>;
  const SingularPairs<Real> singular = singular_pairs(outer, inner);
  const double inner_length = static_cast<double>(inner.length);
  struct Panel {
    Real lo, hi;
  };
  boost::container::small_vector<Panel, 64> pending{{Real(0), outer.length}};
  LogIntegral<Real> result;
  while (!pending.empty()) {
    const Panel panel = pending.back();
    pending.pop_back();
    const Real centre = Real(0.5) * (panel.lo + panel.hi), reach = Real(0.5) * (panel.hi - panel.lo);
    const double half = static_cast<double>(reach);
    double rho = 1e300;
    const SingularPair<Real>* nearest = nullptr;
    for (const SingularPair<Real>& z : singular) {
      const double r = ellipse(panel.lo, panel.hi, z);
      if (r < rho) {
        rho = r;
        nearest = &z;
      }
    }
    // The inner integral behaves like (t − z) ln(t − z) or √(t − z): on the ellipse it varies by no more than the
    // ellipse's size, nor than the inner edge's length.
    const double amplitude = 4 * half * std::min(half * rho, inner_length);
    const double wanted = amplitude > tolerance ? 0.5 * std::log(amplitude / tolerance) / std::log(rho) : 1;
    int order = highest;
    if (wanted <= highest) {
      order = std::max(1, static_cast<int>(std::ceil(wanted)));
      result.truncation += std::min(tolerance, amplitude);
    } else if (amplitude <= tolerance * highest * highest) {
      result.truncation += tolerance;
    } else {
      const double place = static_cast<double>(Real(nearest->x - centre)) / half;
      const Real cut = place > 0.8    ? Real(panel.hi - Real(0.5) * reach)
                       : place < -0.8 ? Real(panel.lo + Real(0.5) * reach)
                                      : nearest->x;
      pending.push_back({panel.lo, cut});
      pending.push_back({cut, panel.hi});
      continue;
    }
    const GaussRule<Real>& rule = gauss_rule<Real>(order);
    for (std::size_t k = 0; k < rule.node.size(); ++k) {
      const Real t = centre + rule.node[k] * reach, weight = reach * rule.weight[k];
      double size = 0;
      result.value += weight * seen_edge(Vec<Real>(outer.from + t * outer.direction), inner, size);
      result.size += static_cast<double>(weight) * size;
    }
  }
  return result;
}

/// ∫∫ ln r, to about `tolerance`; points nearer to each other than `coincidence` may be taken as one.
template <class Real>
LogIntegral<Real> log_integral(const SpaceEdge<Real>& a, const SpaceEdge<Real>& b, double tolerance,
                               double coincidence) {
  using std::fabs;
  using std::sqrt;
  const Vec<Real> normal = cross(a.direction, b.direction);
  const Real sine = norm(normal), cosine = dot(a.direction, b.direction);
  const Real shorter = a.length < b.length ? a.length : b.length;
  if (static_cast<double>(sine * shorter) <= coincidence) {
    // The shorter edge is turned about its middle; the longer one's direction is the better known.
    const SpaceEdge<Real>&base = a.length < b.length ? b : a, &other = a.length < b.length ? a : b;
    const Vec<Real> w = Real(0.5) * ((other.from - base.from) + (other.to - base.from));
    const Real middle = dot(w, base.direction);
    const Real h = norm(Vec<Real>(w - middle * base.direction)), half = Real(0.5) * other.length;
    return between_parallels<Real>(Real(0), base.length, middle - half, middle + half, h);
  }
  const auto same = [&](const Vec<Real>& p, const Vec<Real>& q) {
    const Vec<Real> d = p - q;
    return static_cast<double>(fabs(d.x) + fabs(d.y) + fabs(d.z)) <= coincidence;
  };
  const auto corner = [&](bool a_reversed, bool b_reversed) {
    const Real c = a_reversed == b_reversed ? cosine : Real(-cosine);
    const Real R = norm(Vec<Real>((a_reversed ? a.from : a.to) - (b_reversed ? b.from : b.to)));
    return from_common_corner(a.length, b.length, c, sine, R);
  };
  if (same(a.from, b.from)) return corner(false, false);
  if (same(a.from, b.to)) return corner(false, true);
  if (same(a.to, b.from)) return corner(true, false);
  if (same(a.to, b.to)) return corner(true, true);
  // Elsewhere lines may meet within the edges or near them; farther away the terms would cancel.
  if (static_cast<double>(sine) > 0.01) {
    const Vec<Real> w = b.from - a.from;
    const Real sine_square = sine * sine;
    if (static_cast<double>(fabs(dot(w, normal)) / sine) <= coincidence) {
      const Real s = dot(cross(w, b.direction), normal) / sine_square,
                 t = dot(cross(w, a.direction), normal) / sine_square;
      const Real reach_a = s < 0 ? Real(-s) : Real(s - a.length), reach_b = t < 0 ? Real(-t) : Real(t - b.length);
      if (reach_a < a.length && reach_b < b.length) {
        return between_meeting<Real>({-s, a.length - s}, {-t, b.length - t}, cosine, sine);
      }
    }
  }
  return a.length < b.length ? by_panels(a, b, tolerance) : by_panels(b, a, tolerance);
}

}  // namespace exitance
