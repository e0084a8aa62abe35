#include "src/scene/facet_range.h"

namespace exitance {

FacetRange facet_range(const PolygonSoup& soup, std::uint32_t first, std::uint32_t last) {
  FacetRange range{first, last};
  for (std::uint32_t f = first; f < last; ++f) range.box.extend(soup.box_of(f));
  return range;
}

}  // namespace exitance
