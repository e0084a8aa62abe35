#pragma once
// Level: convex polygons that lie in one plane but for the rounding of their coordinates, as turned ones do.

#include "geometry/facets.h"

namespace exitance {

/// Of a scene's extent: how far turning it moves what lay in one plane out of it, and some more.
inline constexpr double kLevel = 0x1p-47;

/// Area [m²] of the overlap of two convex loops that are level, as far as double precision tells; the same in either
/// order; 0: they are not. They are where they overlap with more than 2^-30 of the smaller one's area and in more than
/// a strip of 2 `near` [m] and lie, wherever they do, no more than `near` apart. Elsewhere they may lie farther apart,
/// as much as rounding turns the narrower one. Loops that meet along an edge, also where rounding lets them overlap
/// there, and those without an area are level with none.
double level_area(const Loop& f, const Loop& g, double near);

/// Whether planes with these normals may be one but for rounding, whichever way they face.
bool may_be_level(const Vec3& n, const Vec3& m);

}  // namespace exitance
