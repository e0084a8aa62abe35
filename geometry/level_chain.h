#pragma once
// Facets that are level with each other by way of others between them: a pile of sheets of which each lies on the next.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/polygon_soup.h"

namespace exitance {

/// Whether two facets of different polygons may be the ends of a chain: they are level within soup.pile().
bool may_end_chain(const PolygonSoup& soup, std::uint32_t f, std::uint32_t g);

/// Pairs f < g of those, not in coplanar() of each other, which a chain of facets joins that are so one by one. Were
/// these left to their coordinates, three in a pile could cover each other in a ring. boxes: of all facets; index: of
/// the boxes.
std::vector<std::pair<std::uint32_t, std::uint32_t>> ends_of_chains(const PolygonSoup& soup, std::span<const Box> boxes,
                                                                    const SpatialIndex& index);

}  // namespace exitance
