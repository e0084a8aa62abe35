#pragma once
// Where an object's facets stand in a soup.

#include <cstdint>

#include "geometry/polygon_soup.h"

namespace exitance {

/// The facets of an object, first … last − 1; empty where it is not there.
struct FacetRange {
  std::uint32_t first = 0, last = 0;
  Box box = {};  ///< around them
};

/// With its box.
FacetRange facet_range(const PolygonSoup& soup, std::uint32_t first, std::uint32_t last);

}  // namespace exitance
