#include "src/dynamic/trespass.h"

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

std::vector<std::string> find_trespass(const EditedScene& scene, const SceneVersion& version, std::uint32_t object) {
  std::vector<std::string> said;
  const ObjectSlot& slot = version.slot(object);
  if (!slot.present || !scene.is_present(object)) return said;
  const PolygonSoup& soup = version.soup();
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  const auto is_own = [&](std::uint32_t f) { return slot.facet_first <= f && f < slot.facet_last; };
  const auto box_of = [&](std::uint32_t f) {
    Box box;
    for (const Corner& c : soup.corners(soup.facets()[f])) box.extend(c.at);
    return box;
  };
  const std::string& name = scene.scene().objects[object].name;
  if (slot.facet_first == slot.facet_last) return said;  // nothing of it has an area
  Box others;
  bool is_alone = true;
  for (std::uint32_t k = 0; k < version.objects(); ++k) {
    if (k == object || !version.slot(k).present) continue;
    others.extend(version.slot(k).box);
    is_alone = false;
  }
  if (is_alone) return said;
  if (!slot.box.overlaps(others)) {
    said.push_back(fmt::format("object '{}' has left the scene: nothing of it is between the other objects", name));
    return said;
  }
  std::set<std::uint32_t> crossed;
  std::vector<std::uint32_t> found;
  StageCounts counts;
  for (std::uint32_t f = slot.facet_first; f < slot.facet_last; ++f) {
    found.clear();
    soup.index().find(box_of(f), found);
    const auto look = [&](std::uint32_t other) {
      if (is_own(other)) return;
      const std::uint32_t of = version.object_of_facet(other);
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
