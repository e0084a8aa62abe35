#pragma once
// What is to become of links, and what that took.

#include <cstdint>
#include <functional>
#include <limits>
#include <span>

#include "src/links/abandon.h"
#include "src/links/link_index.h"
#include "src/links/link_sight.h"

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

/// In which order the pairs of patches are worked on, where that can be interrupted.
enum class LinkOrder : std::uint8_t {
  importance,  ///< those first that could bring the most
  index,       ///< by receiving patch and then by source, as links are kept
  any          ///< receiving patches in parallel: the least work. The task's `stop` is asked by any thread
};

/// Everything that decides what becomes of the links. Luminances and thresholds in [W/m²] or what the scene has.
struct LinkTask {
  const PatchTree* tree = nullptr;
  const Obstacles* now = nullptr;              ///< of the scene as it is
  const Obstacles* before = nullptr;           ///< as it was; null where no geometry has changed
  std::span<const std::uint8_t> moved, relit;  ///< by object: whether its geometry, its materials have changed
  std::span<const double> luminance;           ///< of B, by node, as it stood at the edit
  double eps1 = 0, eps2 = 0, B_eps = 0;
  LinkScope scope = LinkScope::refinement;
  bool any_stale = false;  ///< whether some link may be stale
  /// Of refinement: the pairs that are to get links, ascending and none twice; null: all that have none.
  const std::vector<PatchPair>* new_pairs = nullptr;
  /// Where no object has moved: the patches, ascending, whose links to others are looked at; null: all.
  const std::vector<std::uint32_t>* sources = nullptr;
  /// How many links the index may get beyond those that it has.
  std::uint64_t most_links = std::numeric_limits<std::uint64_t>::max();
  /// Asked by any thread before each link that refinement (the scope) would divide: whether none is to be divided any
  /// more. Of others, where pairs may be left pending, asked now and then: whether what has not been looked at is left.
  std::function<bool()> stop;
  LinkOrder order = LinkOrder::importance;  ///< where pairs may be left pending
  /// Asked by any thread before each receiving patch, while it is sought what there is to do and while that is done.
  Abandon abandon;
};

struct LinkWork {
  std::uint64_t links_updated = 0;   ///< active and shadow links whose value was found anew, new ones included
  std::uint64_t links_affected = 0;  ///< of those, that an object's old or new place affects, or an end that moved
  std::uint64_t skipped = 0;         ///< by B_eps: links, or ghosts with all their descendants
  std::uint64_t refined = 0, unrefined = 0;
  SightWork sight;

  LinkWork& operator+=(const LinkWork& other);
};

/// Throws LimitError: the task would make more links than it may.
[[noreturn]] void refuse_more_links(const LinkTask& task);

}  // namespace exitance
