#include "geometry/level_chain.h"

#include <algorithm>

#include "geometry/disjoint_sets.h"
#include "geometry/level_facets.h"

namespace exitance {

bool may_end_chain(const PolygonSoup& soup, std::uint32_t f, std::uint32_t g) {
  return soup.facets()[f].polygon != soup.facets()[g].polygon && are_level(soup, f, g, soup.pile());
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> ends_of_chains(const PolygonSoup& soup, std::span<const Box> boxes,
                                                                    const SpatialIndex& index) {
  DisjointSets piles(boxes.size());
  for (std::uint32_t f = 0; f < boxes.size(); ++f) {
    for (const std::uint32_t t : soup.coplanar(f)) piles.unite(f, t);
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
  std::vector<std::uint32_t> near;
  for (std::uint32_t f = 0; f < boxes.size(); ++f) {
    if (soup.coplanar(f).empty()) continue;
    near.clear();
    index.find(boxes[f].grown(soup.pile()), near);
    std::ranges::sort(near);
    for (const std::uint32_t g : near) {
      if (g > f && piles.root(f) == piles.root(g) && !std::ranges::binary_search(soup.coplanar(f), g) &&
          may_end_chain(soup, f, g))
        ends.emplace_back(f, g);
    }
  }
  return ends;
}

}  // namespace exitance
