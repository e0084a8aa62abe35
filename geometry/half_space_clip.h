#pragma once
// A convex facet clipped by another one's plane. The corners stay implicit: they are rounded only where they are used.

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cmath>

#include "geometry/cone.h"
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

/// det(b − a, c − a, v − a) for the points of a plane with a bound of its error.
template <class Real>
Real plane_functional(const PlanePoints& plane, const Vec3& v, double& error) {
  const Vec<Real> p = difference<Real>(*plane.b, *plane.a), q = difference<Real>(*plane.c, *plane.a),
                  w = difference<Real>(v, *plane.a);
  const double size = static_cast<double>(norm(p)) * static_cast<double>(norm(q)) * static_cast<double>(norm(w));
  error = 12 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * size;
  return dot(cross(p, q), w);
}

/// The position of a corner relative to an origin. displacement: how far it may lie from the true one.
template <class Real>
Vec<Real> position(const RadiatorFacet& facet, const ClippedCorner& corner, const PlanePoints& plane,
                   const Vec3& origin, double& displacement) {
  using std::fabs;
  const double u = static_cast<double>(std::numeric_limits<Real>::epsilon());
  const Vec3& from = facet.loop[corner.from];
  const Vec<Real> start = difference<Real>(from, origin);
  displacement = u * static_cast<double>(norm(start));
  if (!corner.is_crossing()) return start;
  const Vec3& to = facet.loop[corner.to];
  double from_error = 0, to_error = 0;
  const Real at_from = fabs(plane_functional<Real>(plane, from, from_error)),
             at_to = fabs(plane_functional<Real>(plane, to, to_error));
  const Real span = at_from + at_to;
  const Vec<Real> edge = difference<Real>(to, from);
  const double length = static_cast<double>(norm(edge));
  const double error = from_error + to_error;
  const bool known = span > 0 && error < static_cast<double>(span);
  const Real t = span > 0 ? Real(at_from / span) : Real(0.5);
  displacement += known ? (2 * error / static_cast<double>(span) + 4 * u) * length : length;
  return start + t * edge;
}

}  // namespace exitance
