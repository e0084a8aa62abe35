#pragma once
// Polygons as they are given: loops of points in space. Coordinates are doubles and mean exactly those numbers.

#include <string_view>
#include <vector>

#include "geometry/vec3.h"

namespace exitance {

/// A simple polygon, possibly non-convex, possibly with holes. The outer loop runs counter-clockwise seen from the
/// front; holes may run either way. It need not be exactly planar: facets.h says what it then is.
struct Polygon {
  std::vector<Vec3> outer;
  std::vector<std::vector<Vec3>> holes;
};

enum class PolygonDefect {
  none,
  non_finite,         ///< a coordinate is NaN or infinite
  too_few_vertices,   ///< a loop with fewer than three vertices
  zero_area,          ///< all vertices on one line, exactly
  self_intersecting,  ///< a loop crosses or touches itself or another loop, or a hole lies outside the outer loop
};

/// The first defect that applies, in the order of the enumeration. Decided exactly, on the polygon's projection along
/// the dominant axis of its area vector. Repeated and collinear vertices are no defect.
PolygonDefect find_defect(const Polygon& polygon);

/// What a defect is called in messages, e.g. "a coordinate is not a finite number".
std::string_view describe(PolygonDefect defect);

/// Half the sum of the cross products around the loop (Newell): along the front normal, as long as the area [m²]. Zero
/// for a degenerate loop.
Vec3 area_vector(const std::vector<Vec3>& loop);

/// Area vector of the outer loop less the holes'.
Vec3 area_vector(const Polygon& polygon);

}  // namespace exitance
