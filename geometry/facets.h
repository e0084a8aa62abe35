#pragma once
// Facets: the exactly planar, convex pieces that a polygon consists of.

#include <vector>

#include "geometry/polygon.h"

namespace exitance {

using Loop = std::vector<Vec3>;

/// Cuts a polygon into facets without making new points. Every facet is convex (collinear vertices allowed), exactly
/// planar, counter-clockwise seen from the polygon's front.
///  - an exactly planar, convex polygon without holes is one facet;
///  - a quadrilateral that is not exactly planar, and convex in the projection along the dominant axis of its area
///    vector, is cut along its shorter diagonal, of two equal ones along the one that holds the lexicographically
///    smallest vertex: the same cut whatever vertex comes first and whichever side is front;
///  - anything else is triangulated (constrained Delaunay in that projection).
/// Repeated vertices are dropped, facets of exactly zero area are left out, so a zero-area polygon has no facets.
/// The polygon must be free of the other defects of find_defect.
std::vector<Loop> cut_into_facets(const Polygon& polygon);

}  // namespace exitance
