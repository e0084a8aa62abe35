#pragma once
// The exact answer to "what does a point see of a polygon" by another route than the kernel's: the occluders' shadows
// are constructed as polygons with rational corners in the source's plane and taken away by CGAL's Boolean set
// operations.

#include <vector>

#include "geometry/polygon.h"

namespace exitance {

/// A pure occluder: polygons, or the faces of a closed polyhedron, outward.
struct Occluder {
  std::vector<Polygon> faces;
  bool solid = false;
};

struct OracleAnswer {
  long double F = 0;             ///< form factor, right to all its digits
  long double visible_area = 0;  ///< of the part of the source above the horizon that is not hidden [m²]
};

/// Form factor from a point, whose surface's normal has this direction (any length but zero), to the visible part of
/// the front of a polygon. Takes milliseconds. A source seen from behind or edge-on gives 0.
OracleAnswer oracle_form_factor(const Vec3& point, const Vec3& direction, const Polygon& source,
                                const std::vector<Occluder>& occluders);

}  // namespace exitance
