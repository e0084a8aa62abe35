#pragma once
// What polygon soups that edits make from one another share.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/polygon_soup.h"

namespace exitance {

/// Each place is written once, by the soup that first has it; arrays never move once they are shared.
struct PolygonSoup::Store {
  std::vector<Vec3> vertices;
  std::vector<Facet> facets;  ///< with spare ones at the end
  std::uint32_t used = 0;     ///< of them
  std::vector<Corner> corners;
  std::vector<FirstCorners> first_corners;
  std::vector<Shell> shells;
  std::vector<Role> roles;
  std::vector<Rank> ranks;
  std::vector<std::uint32_t> first_facet;
  /// By polygon: part of a closed surface; known only where patches lie against each other.
  std::vector<char> closed;
  bool closed_known = false;

  /// Whether so much fits without moving anything.
  bool has_room(std::size_t polygons, std::size_t more_facets, std::size_t more_corners) const {
    const auto fits = [](const auto& array, std::size_t more) { return array.size() + more <= array.capacity(); };
    return used + more_facets <= facets.size() && fits(corners, more_corners) && fits(vertices, more_corners) &&
           fits(shells, more_facets / 4) && fits(roles, polygons) && fits(ranks, polygons) &&
           fits(first_facet, polygons) && fits(closed, polygons);
  }
};

}  // namespace exitance
