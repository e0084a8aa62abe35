#include "src/scene/trespass.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace exitance {
namespace {

/// Whether the open segment pq passes through the interior of a facet, not along it.
bool passes(const Vec3& p, const Vec3& q, const PolygonSoup& soup, const Facet& facet, StageCounts& counts) {
  const int at_p = side_of(facet.plane, p, counts);
  if (at_p == 0 || side_of(facet.plane, q, counts) != -at_p) return false;
  const auto corners = soup.corners(facet);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 &u = corners[k].at, &v = corners[k + 1 < corners.size() ? k + 1 : 0].at;
    if (orientation(u, v, p, q, counts) != -at_p) return false;
  }
  return true;
}

bool cross_each_other(const PolygonSoup& soup, const Facet& a, const Facet& b, StageCounts& counts) {
  const auto edges_pass = [&](const Facet& of, const Facet& through) {
    const auto corners = soup.corners(of);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (passes(corners[k].at, corners[k + 1 < corners.size() ? k + 1 : 0].at, soup, through, counts)) return true;
    }
    return false;
  };
  return edges_pass(a, b) || edges_pass(b, a);
}

}  // namespace

std::vector<std::string> find_trespass(const EditedScene& scene, const PolygonSoup& soup,
                                       std::span<const FacetRange> ranges, std::uint32_t object) {
  std::vector<std::string> said;
  const FacetRange range = ranges[object];
  if (!scene.is_present(object)) return said;
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  const auto is_own = [&](std::uint32_t f) { return range.first <= f && f < range.last; };
  const std::string& name = scene.scene().objects[object].name;
  if (range.first == range.last) return said;  // nothing of it has an area
  Box others;
  bool is_alone = true;
  for (std::uint32_t k = 0; k < ranges.size(); ++k) {
    if (k == object || ranges[k].first == ranges[k].last) continue;
    others.extend(ranges[k].box);
    is_alone = false;
  }
  if (is_alone) return said;
  if (!range.box.overlaps(others)) {
    said.push_back(fmt::format("object '{}' has left the scene: nothing of it is between the other objects", name));
    return said;
  }
  std::set<std::uint32_t> crossed;
  std::vector<std::uint32_t> found;
  StageCounts counts;
  for (std::uint32_t f = range.first; f < range.last; ++f) {
    found.clear();
    soup.index().find(soup.box_of(f), found);
    const auto look = [&](std::uint32_t other) {
      if (is_own(other)) return;
      const auto of = static_cast<std::uint32_t>(
          std::ranges::find_if(ranges, [&](const FacetRange& r) { return r.first <= other && other < r.last; }) -
          ranges.begin());
      if (!crossed.contains(of) && cross_each_other(soup, soup.facets()[f], soup.facets()[other], counts))
        crossed.insert(of);
    };
    for (const std::uint32_t item : found) {
      if (item < facets) {
        look(item);
      } else {
        std::ranges::for_each(soup.shells()[item - facets].facets, look);
      }
    }
  }
  for (const std::uint32_t other : crossed)
    said.push_back(fmt::format("object '{}' passes through '{}'", name, scene.scene().objects[other].name));
  return said;
}

}  // namespace exitance
