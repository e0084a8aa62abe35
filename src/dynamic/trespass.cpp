#include "src/dynamic/trespass.h"

#include "src/scene/trespass.h"

namespace exitance {

std::vector<std::string> find_trespass(const EditedScene& scene, const SceneVersion& version, std::uint32_t object) {
  std::vector<FacetRange> facets(version.objects());
  for (std::uint32_t o = 0; o < facets.size(); ++o) {
    const ObjectSlot& slot = version.slot(o);
    if (slot.present) facets[o] = {slot.facet_first, slot.facet_last, slot.box};
  }
  if (facets[object].first == facets[object].last) return {};
  return find_trespass(scene, version.soup(), facets, object);
}

}  // namespace exitance
