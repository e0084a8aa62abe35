#pragma once
// What polygon soups that edits make from one another share.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/huge_pages.h"
#include "geometry/matter.h"
#include "geometry/polygon_soup.h"

namespace exitance {

/// Each soup has all before an end of its own. A place is written by the soup that first has it and not again as long
/// as one that has it is there; arrays never move once they are shared.
struct PolygonSoup::Store : std::enable_shared_from_this<PolygonSoup::Store> {
  LargeArray<Vec3> vertices;
  LargeArray<Facet> facets;  ///< with spare ones at the end
  std::uint32_t used = 0;    ///< of them
  LargeArray<Corner> corners;
  LargeArray<FirstCorners> first_corners;
  std::vector<Shell> shells;
  std::vector<Role> roles;
  std::vector<Rank> ranks;
  std::vector<std::uint32_t> first_facet;
  /// By polygon; known only where patches lie against each other, else nothing.
  std::vector<Behind> behind;
  bool behind_known = false;

  /// Sizes of the arrays.
  struct End {
    std::uint32_t facets = 0;
    std::size_t vertices = 0, corners = 0, shells = 0, polygons = 0;
  };
  struct Part {
    std::shared_ptr<Store> store;
    End end;
  };
  std::vector<std::weak_ptr<const Part>> parts;  ///< of soups, some of which are gone; ends ascend

  /// The store for a soup that has all that is in it by now.
  std::shared_ptr<Store> whole() {
    auto part = std::make_shared<const Part>(
        Part{shared_from_this(), {used, vertices.size(), corners.size(), shells.size(), roles.size()}});
    parts.push_back(part);
    return {part, this};
  }

  /// Gives up what no soup has any more: of soups that are gone, or that have thrown or were given up while they were
  /// being made.
  void take_back() {
    while (!parts.empty() && parts.back().expired()) parts.pop_back();
    const std::shared_ptr<const Part> last = parts.empty() ? nullptr : parts.back().lock();
    if (!last) return;
    const End& end = last->end;
    const auto shrink = [](auto& array, std::size_t size) {
      if (array.size() > size) array.erase(array.begin() + static_cast<std::ptrdiff_t>(size), array.end());
    };
    std::fill(facets.begin() + end.facets, facets.begin() + used, Facet{});
    std::fill(first_corners.begin() + end.facets, first_corners.begin() + used, FirstCorners{});
    used = end.facets;
    shrink(vertices, end.vertices);
    shrink(corners, end.corners);
    shrink(shells, end.shells);
    shrink(roles, end.polygons);
    shrink(ranks, end.polygons);
    shrink(first_facet, end.polygons + 1);
    shrink(behind, end.polygons);
  }

  /// Whether so much fits without moving anything.
  bool has_room(std::size_t polygons, std::size_t more_facets, std::size_t more_corners) const {
    const auto fits = [](const auto& array, std::size_t more) { return array.size() + more <= array.capacity(); };
    return used + more_facets <= facets.size() && fits(corners, more_corners) && fits(vertices, more_corners) &&
           fits(shells, more_facets / 4) && fits(roles, polygons) && fits(ranks, polygons) &&
           fits(first_facet, polygons) && fits(behind, polygons);
  }
};

}  // namespace exitance
