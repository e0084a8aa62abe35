#include "src/scene/scene_soup.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace exitance {
namespace {

/// Room for what edits bring: so that a soup is made anew once in so many edits that all together bring as much as it
/// has.
constexpr std::uint32_t kLeastSpare = 1024;

struct Surfaces {
  std::vector<Polygon> polygons;
  std::vector<Role> roles;
  std::vector<PolygonSoup::Rank> ranks;  ///< the object's number, then that in the object

  void add(const EditedScene& scene, std::uint32_t object) {
    const EditedScene::Range range = scene.surfaces_of(object);
    for (std::uint32_t k = range.first; k < range.last; ++k) {
      const Surface& surface = scene.scene().surfaces[k];
      polygons.push_back(surface.polygon);
      roles.push_back(surface.obstruction_only ? Role::sheet : Role::patch);
      ranks.push_back((PolygonSoup::Rank{object} << 32) + (k - range.first));
    }
  }
};

}  // namespace

std::vector<std::uint32_t> objects_of(const EditedScene& scene) {
  std::vector<std::uint32_t> objects(scene.scene().objects.size());
  std::iota(objects.begin(), objects.end(), 0);
  return objects;
}

PolygonSoup make_soup(const EditedScene& scene, std::span<const std::uint32_t> order) {
  Surfaces all;
  for (const std::uint32_t object : order) all.add(scene, object);
  const auto count = static_cast<std::uint32_t>(all.polygons.size());
  return PolygonSoup(all.polygons, all.roles, all.ranks, std::max(kLeastSpare, count), Planes::rounded);
}

PolygonSoup soup_after(const PolygonSoup& before, PolygonSoup::PolygonRange gone, const EditedScene& scene,
                       std::uint32_t object, std::span<const std::uint32_t> order) {
  Surfaces arriving;
  arriving.add(scene, object);
  if (auto soup = PolygonSoup::edited(before, gone, {arriving.polygons, arriving.roles, arriving.ranks}))
    return std::move(*soup);
  return make_soup(scene, order);
}

}  // namespace exitance
