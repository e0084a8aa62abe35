#pragma once
// A convex facet clipped by another one's plane. The corners stay implicit: they are rounded only where they are used.

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <limits>
#include <type_traits>

#include "geometry/cone.h"
#include "geometry/extended.h"
#include "geometry/radiator.h"

namespace exitance {

/// A corner of what is left: vertex `from` of the facet, or the point in which its edge from – to meets the plane.
struct ClippedCorner {
  std::uint32_t from = 0, to = 0;
  bool is_crossing() const { return from != to; }
};

/// The corners of the part of a facet that lies in front of a plane, counter-clockwise. Empty if no part of it does:
/// also if it lies in the plane, or touches it from behind.
using ClippedLoop = boost::container::small_vector<ClippedCorner, 8>;

/// Every sign is exact. Vertices on the plane are kept, never made anew.
ClippedLoop clip_in_front(const RadiatorFacet& facet, const RadiatorFacet& plane);

/// Where the edge from – to, which a plane separates strictly, meets it: 0 at `from`, 1 at `to`. A value and a bound of
/// its error; where that exceeds what is bearable in Real, finer arithmetic tells it.
template <class Real>
Real crossing_parameter(const PlanePoints& plane, const Vec3& from, const Vec3& to, double bearable, double& error) {
  using std::fabs;
  const double u = static_cast<double>(std::numeric_limits<Real>::epsilon());
  const Vec<Real> p = difference<Real>(*plane.b, *plane.a), q = difference<Real>(*plane.c, *plane.a),
                  v = difference<Real>(from, *plane.a), w = difference<Real>(to, *plane.a), normal = cross(p, q);
  const Real at_from = fabs(dot(normal, v)), at_to = fabs(dot(normal, w)), span = at_from + at_to;
  // Of each determinant, and so of the quotient: 12 roundings of a product of lengths.
  const double size = static_cast<double>(norm(p)) * static_cast<double>(norm(q)) *
                      (static_cast<double>(norm(v)) + static_cast<double>(norm(w)));
  error = span > 0 ? 12 * u * size / static_cast<double>(span) : 1;
  if constexpr (!std::is_same_v<Real, Extended>) {
    using Finer = std::conditional_t<std::is_same_v<Real, double>, long double, Extended>;
    if (error > bearable) {
      const Real t = static_cast<Real>(crossing_parameter<Finer>(plane, from, to, bearable, error));
      error += u;
      return t;
    }
  }
  return span > 0 ? Real(at_from / span) : Real(0.5);
}

/// The position of a corner relative to an origin. displacement: how far it may lie from the true one.
template <class Real>
Vec<Real> position(const RadiatorFacet& facet, const ClippedCorner& corner, const PlanePoints& plane,
                   const Vec3& origin, double& displacement) {
  const double u = static_cast<double>(std::numeric_limits<Real>::epsilon());
  const Vec3& from = facet.loop[corner.from];
  const Vec<Real> start = difference<Real>(from, origin);
  displacement = 0.5 * u * static_cast<double>(norm(start));
  if (!corner.is_crossing()) return start;
  const Vec3& to = facet.loop[corner.to];
  double error = 0;
  const Real t = crossing_parameter<Real>(plane, from, to, 8 * u, error);
  const Vec<Real> edge = difference<Real>(to, from);
  displacement += (error + 4 * u) * static_cast<double>(norm(edge));
  return start + t * edge;
}

}  // namespace exitance
