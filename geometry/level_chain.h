#pragma once
// Facets that are level with each other by way of others between them: a pile of sheets of which each lies on the next.

#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/polygon_soup.h"

namespace exitance {

using FacetPair = std::pair<std::uint32_t, std::uint32_t>;

/// Whether two facets, not in coplanar() of each other, may be the ends of a chain: they are of different polygons and
/// level within soup.pile().
bool may_end_chain(const PolygonSoup& soup, std::uint32_t f, std::uint32_t g);

/// Of pairs that may be, those that a chain of facets joins of which each lies in coplanar() of the next, unoccluding
/// ones aside. Were these left to their coordinates, three in a pile could cover each other in a ring. In piles that
/// are higher than soup.pile(), topmost and lowest may.
std::vector<FacetPair> ends_of_chains(const PolygonSoup& soup, std::vector<FacetPair> pairs);

}  // namespace exitance
