#include "src/scene/object_materials.h"

namespace exitance {

std::optional<std::uint32_t> ObjectMaterials::of_new_shape(const Material& own) const {
  if (const auto named = by_name.find(own.name); named != by_name.end()) return named->second;
  if (every) return every;
  const bool says = !own.rho.empty() || !own.E.empty();
  return says || used.size() != 1 ? std::nullopt : std::optional(*used.begin());
}

void ObjectMaterials::follow(const MaterialChange& change, const std::string& name) {
  if (change.from == MaterialChange::kEvery) {
    *this = {change.to, {}, {change.to}};
    return;
  }
  if (used.erase(change.from) > 0) used.insert(change.to);
  if (every == change.from) every = change.to;
  for (auto& [of_mesh, number] : by_name) {
    if (number == change.from) number = change.to;
  }
  if (!name.empty()) by_name.insert_or_assign(name, change.to);
}

}  // namespace exitance
