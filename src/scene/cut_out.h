#pragma once
// What is left of a polygon when others that lie on it are taken out: a wall without its window and its door.

#include <optional>
#include <span>
#include <vector>

#include "geometry/polygon.h"

namespace exitance {

/// The base less the parts, as polygons that face the way the base does: with holes where parts lie within it, several
/// where parts divide it, none where they tile it. Parts face like the base, lie in it and not on one another; their
/// edges may run along its boundary and along each other. Boundaries are added up, not intersected: every vertex of
/// the result is a vertex of the input, and edges shared with the parts have the same ends, so that nothing leaks
/// between them however the coordinates are rounded. `tolerance` [m] is how far a vertex may lie from the edge (or the
/// vertex) of another loop that it is meant to lie on. None where the parts cross the base's boundary or one another,
/// lie outside the base, or touch a boundary with a corner only (no simple polygon is left). REQUIRES: polygons
/// without defects, the base and the parts without holes.
std::optional<std::vector<Polygon>> cut_out(const Polygon& base, std::span<const Polygon> parts, double tolerance);

}  // namespace exitance
