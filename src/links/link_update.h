#pragma once
// What becomes of links when a scene changes: shadow detection, un-refinement and refinement (Feng et al., sections 3,
// 5 and 6.1).
//
// The listing of section 3 puts links that nothing affects into the shadow set; they keep their kind here, as is meant.
// A ghost is un-refined when B F falls below eps1 and nothing below it is refined; the listing asks its children.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "src/links/link_index.h"
#include "src/links/link_sight.h"
#include "src/links/push_pull.h"

namespace exitance {

/// Which links are looked at.
enum class LinkScope : std::uint8_t {
  refinement,    ///< none is tested again; those whose B F exceeds eps2 are refined. Pairs without links get them
  materials,     ///< the same of those from objects that changed their materials, and un-refinement
  all,           ///< Direct: every link is tested again, on its own
  hierarchical,  ///< HVT: none below one that nothing affects, nor below one that something blocks
  significant,   ///< HVT + PEU: nor those whose energy could not change by more than B_eps
  values         ///< every link is tested again and none is refined or un-refined
};

/// Everything that decides what becomes of the links. Luminances and thresholds in [W/m²] or what the scene has.
struct LinkTask {
  const PatchTree* tree = nullptr;
  const Obstacles* now = nullptr;              ///< of the scene as it is
  const Obstacles* before = nullptr;           ///< as it was; null where no geometry has changed
  std::span<const std::uint8_t> moved, relit;  ///< by object: whether its geometry, its materials have changed
  std::span<const double> luminance;           ///< of B, by node, as it stood at the edit
  double eps1 = 0, eps2 = 0, B_eps = 0;
  unsigned points_per_edge = 2;
  LinkScope scope = LinkScope::refinement;
  bool any_stale = false;  ///< whether some link may be stale
  /// Asked by any thread before each link that refinement (the scope) would divide: whether none is to be divided any
  /// more.
  std::function<bool()> stop;
};

struct LinkWork {
  std::uint64_t links_updated = 0;   ///< active and shadow links whose value was found anew, new ones included
  std::uint64_t links_affected = 0;  ///< of those, that an object's old or new place affects, or an end that moved
  std::uint64_t skipped = 0;         ///< by B_eps: links, or ghosts with all their descendants
  std::uint64_t refined = 0, unrefined = 0;
  SightWork sight;

  LinkWork& operator+=(const LinkWork& other);
};

/// Brings the links up to date, in parallel; the same bits for any number of threads. A link's values depend on its
/// nodes and the scene only, and which links there are on those, the links before, and the luminances: `all` and
/// `hierarchical` leave the same. With `differences`, what links bring more than before is handed to it
/// (NodeRadiosity::receive).
LinkWork update_links(const LinkTask& task, LinkIndex& links, NodeRadiosity* differences = nullptr);

}  // namespace exitance
