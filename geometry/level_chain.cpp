#include "geometry/level_chain.h"

#include "geometry/disjoint_sets.h"
#include "geometry/level_facets.h"

namespace exitance {

bool may_end_chain(const PolygonSoup& soup, std::uint32_t f, std::uint32_t g) {
  return soup.pile() > 0 && soup.facets()[f].polygon != soup.facets()[g].polygon && are_level(soup, f, g, soup.pile());
}

std::vector<FacetPair> ends_of_chains(const PolygonSoup& soup, std::vector<FacetPair> pairs) {
  if (pairs.empty()) return pairs;
  DisjointSets piles(soup.facets().size());
  for (std::uint32_t f = 0; f < soup.facets().size(); ++f) {
    if (!soup.is_present(f) || soup.role(soup.facets()[f].polygon) == Role::unoccluding) continue;
    for (const std::uint32_t t : soup.coplanar(f)) piles.unite(f, t);
  }
  std::erase_if(pairs, [&](const FacetPair& pair) { return piles.root(pair.first) != piles.root(pair.second); });
  return pairs;
}

}  // namespace exitance
