#pragma once
// What an object of a scene file is made of, for new shapes that do not say.

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "src/scene/edit.h"
#include "src/scene/scene.h"

namespace exitance {

/// Materials are their numbers in the scene.
struct ObjectMaterials {
  std::optional<std::uint32_t> every;            ///< what all is made of that is not named
  std::map<std::string, std::uint32_t> by_name;  ///< of its mesh's materials, those that became others
  std::set<std::uint32_t> used;                  ///< by its surfaces

  /// What stands for a material of a new shape. Nothing where that is its own, if it says how it reflects or emits;
  /// if it does not, the object is of several materials, or of none, and which is meant cannot be told.
  std::optional<std::uint32_t> of_new_shape(const Material& own) const;

  /// Follows a change of materials. name: of the one that changes, where it is a mesh's own; else empty.
  void follow(const MaterialChange& change, const std::string& name);
};

}  // namespace exitance
