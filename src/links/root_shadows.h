#pragma once
// Where whole patches see their own shadows of the objects that an edit has moved: most pairs of patches lie beside
// all of these, and what one sees of the other has not changed.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/shadow_volume.h"
#include "src/links/link_sight.h"
#include "src/links/link_task.h"

namespace exitance {

/// Where the changed objects stand at one time: what of them can enter a shaft.
struct ChangedObjects {
  /// moved: by object. The obstacles must live as long.
  ChangedObjects(const Obstacles& obstacles, std::span<const std::uint8_t> moved);

  std::vector<std::uint32_t> items;  ///< of the soup's index, ascending
  std::vector<std::unique_ptr<ShadowCaster>> casters;
};

/// By whole patch. Conservative. The tree of the task must live as long.
class RootShadows {
 public:
  RootShadows(const LinkTask& task, const ChangedObjects& now, const ChangedObjects* before);

  /// Whether what one sees of the other may have changed. Neither has moved.
  bool may_change(std::uint32_t a, std::uint32_t b) const;

 private:
  struct Shadow {
    bool covers = false;
    std::vector<HalfSpace> region;  ///< unit normals
  };

  bool reaches(std::uint32_t root, const std::vector<HalfSpace>& region) const;

  const PatchTree& tree_;
  std::size_t count_ = 0;
  std::vector<Shadow> shadows_;  ///< [root][caster]
  std::vector<Ball> balls_;
};

}  // namespace exitance
