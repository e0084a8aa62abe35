#pragma once
// Facets of a soup that are level with each other (level.h), and what that tells of the solids behind them.

#include <cstdint>

#include "geometry/polygon_soup.h"

namespace exitance {

/// Whether two facets are level within `near` [m]; the same in either order.
bool are_level(const PolygonSoup& soup, std::uint32_t f, std::uint32_t g, double near);

/// Whether a convex shell lies behind facet f, nowhere more than soup.pile() before it, as the shell's facet `own`,
/// which is coplanar() with f and faces the same way as its side, says: by the corners of the shell or, where f is the
/// narrower one, by those of f. side: 1 for the front of f, −1 for its back.
bool backs(const PolygonSoup& soup, const Shell& shell, std::uint32_t own, std::uint32_t f, int side);

}  // namespace exitance
