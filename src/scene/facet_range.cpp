#include "src/scene/facet_range.h"

namespace exitance {

Box box_of(const PolygonSoup& soup, std::uint32_t facet) {
  Box box;
  for (const Corner& c : soup.corners(soup.facets()[facet])) box.extend(c.at);
  return box;
}

FacetRange facet_range(const PolygonSoup& soup, std::uint32_t first, std::uint32_t last) {
  FacetRange range{first, last};
  for (std::uint32_t f = first; f < last; ++f) range.box.extend(box_of(soup, f));
  return range;
}

}  // namespace exitance
