#pragma once
// Level: convex facets that lie in one plane but for the rounding of their coordinates, as turned ones do.

#include <cstdint>

#include "geometry/polygon_soup.h"

namespace exitance {

/// Of a scene's extent: how far turning it moves what lay in one plane out of it, and some more.
inline constexpr double kLevel = 0x1p-47;

/// Whether two facets overlap with more than 2^-30 of the smaller one's area and in more than a strip of 2 `near` [m]
/// and lie, wherever they do, no more than `near` apart, as far as double precision tells; the same in either order.
/// Elsewhere they may lie farther apart: narrow ones are turned by more than rounding. Facets that meet along an edge,
/// also where rounding lets them overlap there, and those without a normal are level with none.
bool are_level(const PolygonSoup& soup, std::uint32_t f, std::uint32_t g, double near);

/// Whether any facets of different polygons are, whichever way they face.
bool any_are_level(const PolygonSoup& soup, double near);

}  // namespace exitance
