#include "geometry/contour_form_factor.h"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/area_exchange.h"
#include "geometry/edge_pair.h"

namespace exitance {
namespace {

/// Rounding errors of a pair of edges, in units of what its terms are made of: of the integral, and of the cosine that
/// it is multiplied by. Those of different pairs are independent, so that their squares add. Measured against long
/// double on 33,000 pairs of facets, the error stayed below half the resulting figure.
constexpr double kIntegralRounding = 1.5, kCosineRounding = 0.5;

/// An outline relative to an origin, in units of 2^exponent.
template <class Real>
struct Outline {
  boost::container::small_vector<SpaceEdge<Real>, 8> edges;
  double displacement = 0;  ///< of a corner, at most
  double length = 0;
};

struct Frame {
  Vec3 origin;
  int exponent = 0;
  double extent = 0;  ///< distance of the farthest corner, in units of 2^exponent: 1 to 2
};

Frame frame_of(const RadiatorFacet& a, const RadiatorFacet& b) {
  const RadiatorFacet& smaller = a.radius < b.radius ? a : b;
  Frame frame{smaller.centre, 0, 0};
  const double reach = std::max(norm(a.centre - frame.origin) + a.radius, norm(b.centre - frame.origin) + b.radius);
  frame.exponent = std::ilogb(reach);
  frame.extent = std::ldexp(reach, -frame.exponent);
  return frame;
}

template <class Real>
Outline<Real> outline(const RadiatorFacet& facet, const ClippedLoop& loop, const RadiatorFacet& plane,
                      const Frame& frame) {
  using std::ldexp;
  boost::container::small_vector<Vec<Real>, 8> points;
  Outline<Real> result;
  for (const ClippedCorner& corner : loop) {
    double displacement = 0;
    Vec<Real> p = position<Real>(facet, corner, plane.plane(), frame.origin, displacement);
    p = {Real(ldexp(p.x, -frame.exponent)), Real(ldexp(p.y, -frame.exponent)), Real(ldexp(p.z, -frame.exponent))};
    result.displacement = std::max(result.displacement, std::ldexp(displacement, -frame.exponent));
    points.push_back(p);
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec<Real>&p = points[k], &q = points[k + 1 < points.size() ? k + 1 : 0];
    const Vec<Real> e = q - p;
    const Real length = norm(e);
    if (!(length > 0)) continue;  // corners that rounding made one
    result.edges.push_back({p, q, Real(1 / length) * e, length});
    result.length += static_cast<double>(length);
  }
  return result;
}

/// 1/2π ∮∮ ln r dv·dw, with `tolerance` [m²] to spend on truncation where precision allows.
template <class Real>
Exchange contour_exchange(const FacetPair& pair, double tolerance) {
  using std::fabs;
  const double u = static_cast<double>(std::numeric_limits<Real>::epsilon());
  const Frame frame = frame_of(*pair.a, *pair.b);
  const Outline<Real> a = outline<Real>(*pair.a, pair.of_a, *pair.b, frame),
                      b = outline<Real>(*pair.b, pair.of_b, *pair.a, frame);
  const double unit = std::ldexp(1.0, frame.exponent);
  const double pairs = static_cast<double>(a.edges.size() * b.edges.size());
  const double bearable = tolerance / unit / unit / pairs, coincidence = u * frame.extent;
  Real sum(0);
  double squares = 0, truncation = 0;
  for (const SpaceEdge<Real>& e : a.edges) {
    for (const SpaceEdge<Real>& f : b.edges) {
      const Real cosine = dot(e.direction, f.direction);
      const double share = std::fabs(static_cast<double>(cosine));
      const double product = static_cast<double>(e.length * f.length);
      if (share <= 4 * u) {
        truncation += 4 * share * product;
        continue;
      }
      const double worth = std::max(bearable / share, u * product);
      const LogIntegral<Real> part = log_integral(e, f, worth, coincidence);
      sum += cosine * part.value;
      const double rounding = (kIntegralRounding * share + kCosineRounding) * u * part.size;
      squares += rounding * rounding;
      truncation += share * part.truncation;
    }
  }
  // Moving one outline against the other by δ changes the integral by no more than δ times the shorter one's length.
  const double displacement = a.displacement + b.displacement + 2 * coincidence;
  const double moved = displacement * (std::min(a.length, b.length) + 8 * displacement);
  Exchange result;
  result.integral = std::ldexp(static_cast<double>(sum) / (2 * std::numbers::pi), 2 * frame.exponent);
  result.error = std::ldexp((std::sqrt(squares) + truncation) / (2 * std::numbers::pi) + moved, 2 * frame.exponent) +
                 4 * kRoundoff * std::fabs(result.integral);
  return result;
}

/// A pair of facets on its way to the precision it needs.
struct Measured {
  enum class Way { quick, finer_contour, area, extended };

  FacetPair pair;
  Exchange exchange;
  Way way = Way::quick;

  /// Takes the next way that can bring the error to `wanted`; false if none is left.
  bool refine(double wanted) {
    // Long double has 11 bits more.
    if (way == Way::quick && exchange.error * 0x1p-10 <= wanted) {
      way = Way::finer_contour;
      exchange = contour_exchange<long double>(pair, 0.1 * wanted);
    } else if (way < Way::area) {
      way = Way::area;
      take_better(area_exchange<double>(pair, 0.1 * wanted));
      if (exchange.error > wanted) take_better(area_exchange<long double>(pair, 0.1 * wanted));
    } else if (way == Way::area) {
      way = Way::extended;
      exchange = contour_exchange<Extended>(pair, 0.01 * wanted);
    } else {
      return false;
    }
    return true;
  }

 private:
  void take_better(const std::optional<Exchange>& other) {
    if (other && other->error < exchange.error) exchange = *other;
  }
};

/// Bound of F in either direction between facets that face the same way in nearly one plane: the directions between
/// them are within δ = |n_a − n_b| of both planes, and those carry δ² at most.
double bound_between_neighbours(const RadiatorFacet& a, const RadiatorFacet& b) {
  const double difference = norm(a.normal - b.normal) + 0x1p-47;
  return difference * difference;
}

/// Bound of the area of what is left of a facet, and so of what it exchanges.
double area_bound(const RadiatorFacet& facet, const ClippedLoop& loop, const RadiatorFacet& plane) {
  if (std::none_of(loop.begin(), loop.end(), [](const ClippedCorner& c) { return c.is_crossing(); })) {
    return facet.area;
  }
  Vec<double> first, previous, doubled;
  double displacement = 0, length = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    double moved = 0;
    const Vec<double> p = position<double>(facet, loop[k], plane.plane(), facet.loop[loop.front().from], moved);
    displacement = std::max(displacement, moved);
    if (k == 0) first = p;
    doubled = doubled + cross(previous - first, p - first);
    length += norm(p - previous);
    previous = p;
  }
  return 0.5 * norm(doubled) + 2 * displacement * length;
}

}  // namespace

Exchange unobstructed_exchange(const Radiator& a, const Radiator& b, const ExchangeTolerance& tolerance) {
  const double smaller = std::min(a.area(), b.area());
  Exchange total;
  boost::container::small_vector<Measured, 4> open;
  for (const RadiatorFacet& f : a.facets()) {
    for (const RadiatorFacet& g : b.facets()) {
      Measured m{{&f, &g, clip_in_front(f, g), {}}, {}};
      if (m.pair.of_a.empty()) continue;
      m.pair.of_b = clip_in_front(g, f);
      if (m.pair.of_b.empty()) continue;
      const double bound = std::min(bound_between_neighbours(f, g) * std::min(f.area, g.area),
                                    std::min(area_bound(f, m.pair.of_a, g), area_bound(g, m.pair.of_b, f)));
      if (bound <= tolerance.negligible * std::min(f.area, g.area)) {
        total.error += bound;
        continue;
      }
      const auto apart = separated_exchange(m.pair, 0.1 * tolerance.relative);
      m.exchange = apart ? *apart : contour_exchange<double>(m.pair, 0);
      open.push_back(std::move(m));
    }
  }
  const Exchange counted_none = total;
  for (;;) {
    total = counted_none;
    for (const Measured& m : open) {
      total.integral += m.exchange.integral;
      total.error += m.exchange.error;
    }
    const double wanted = std::max(tolerance.negligible * smaller,
                                   std::min(tolerance.absolute * smaller, tolerance.relative * total.integral));
    if (total.error <= wanted) break;
    const double share = wanted / static_cast<double>(open.size());
    bool refined = false;
    for (Measured& m : open) {
      if (m.exchange.error > share && m.refine(share)) refined = true;
    }
    if (!refined) break;
  }
  total.integral = std::max(total.integral, 0.0);
  return total;
}

}  // namespace exitance
