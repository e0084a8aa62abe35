#pragma once
// The Hierarchical Link Index: a flat record a link, found by its code (Feng et al., section 4 and Table 1).

#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "src/links/patch_tree.h"
#include "src/links/quad_code.h"

namespace exitance {

/// A link: light goes from its source to its destination.
struct Link {
  LinkCode code;                  ///< from the pair of whole patches to these nodes
  std::uint32_t source = 0;       ///< node that emits
  std::uint32_t destination = 0;  ///< node that gathers
  /// From what is open of the destination to the source as if nothing stood between; of a stale link at least.
  double form_factor = 0;
  double visibility = 0;  ///< what of that is seen, 0 … 1; of a ghost 1, as it is not looked at
  /// What it could transfer at most, B F, in luminance [W/m²], as of the last exchange of energy; of a ghost the
  /// largest of its descendants'.
  double energy = 0;
  /// How far it is to the next record of the same level or a higher one: 1 and the number of descendants.
  std::uint32_t next = 1;
  bool ghost = false;    ///< refined: its descendants carry the energy
  bool open = false;     ///< nothing enters its shaft, nor those of its descendants
  bool blocked = false;  ///< something alone blocks its shaft or that of a link that it descends from
  bool stale = false;    ///< an update left it, and its descendants, as it was, though it may have changed

  double transfer() const { return visibility * form_factor; }
  /// Has a link that is left stale tell that its form factor may be so large, while it brings what it did, to the bit:
  /// it becomes the next power of two.
  void raise(double most) {
    if (most <= form_factor) return;
    const double brings = transfer();
    form_factor = std::exp2(std::ceil(std::log2(most)));
    visibility = brings / form_factor;
  }
  bool shadow() const { return !ghost && visibility == 0; }
};
static_assert(sizeof(Link) <= 48);

/// Two whole patches, by their roots.
struct PatchPair {
  std::uint32_t receiver = 0, source = 0;

  friend auto operator<=>(const PatchPair&, const PatchPair&) = default;
};

/// Links by what they are. A link is active, shadow (nothing of it is seen) or ghost (refined).
struct LinkCounts {
  std::uint64_t active = 0, shadow = 0, ghost = 0;
  /// Active and shadow links between what does not move (E-E), from or to what does (E-O), and within that (O-O).
  std::uint64_t environment = 0, mixed = 0, dynamic = 0;
  std::uint64_t patch_pairs = 0;  ///< pairs of whole patches between which there are links
  std::uint64_t bytes = 0;        ///< of the records and of what finds them

  std::uint64_t links() const { return active + shadow; }
};

/// Links of each receiving patch side by side, by emitting patch and then by code: descendants are contiguous, and any
/// link is found in O(log n). No object is special: links between any objects are ranges of it, found the same way.
class LinkIndex {
 public:
  /// roots: how many the tree has. Empty.
  explicit LinkIndex(std::size_t roots = 0) : blocks_(roots), changes_(roots) {}

  /// Makes room for roots that the tree has got.
  void grow(std::size_t roots);
  std::size_t roots() const { return blocks_.size(); }

  /// All that a patch receives.
  std::span<const Link> of_receiver(std::uint32_t receiver) const { return blocks_[receiver].links; }

  /// The link between two whole patches and all its descendants; empty where there is none.
  std::span<const Link> between(std::uint32_t receiver, std::uint32_t source) const;

  /// visit(source patch, its links), ascending, of all that a patch receives.
  template <class Visit>
  void for_each_source(std::uint32_t receiver, const Visit& visit) const {
    const Block& block = blocks_[receiver];
    for (std::size_t k = 0; k < block.pairs.size(); ++k) {
      const std::size_t first = block.pairs[k].first;
      const std::size_t last = k + 1 < block.pairs.size() ? block.pairs[k + 1].first : block.links.size();
      visit(block.pairs[k].source, std::span(block.links).subspan(first, last - first));
    }
  }

  /// Puts `links`, in order and with all descendants, in place of those between two patches.
  struct Replacement {
    std::uint32_t source = 0;  ///< patch
    std::vector<Link> links;
  };
  // Different receivers may be changed by different threads. All or nothing.
  /// sources ascending, each once.
  void replace(std::uint32_t receiver, std::span<const Replacement> replacements);
  /// The first of the links from a source patch is marked stale. REQUIRES: there are some.
  void mark_stale(std::uint32_t receiver, std::uint32_t source);
  /// All that a patch receives, or of it what comes from one patch: the energies may be set. REQUIRES of the first: no
  /// changes are kept.
  std::span<Link> energies_of(std::uint32_t receiver) { return blocks_[receiver].links; }
  std::span<Link> energies_of(std::uint32_t receiver, std::uint32_t source);

  /// From here on, what changes is kept, until all of it stays or is undone.
  void keep_changes();
  void commit() noexcept;
  void roll_back() noexcept;

  /// moves[object]: whether it is dynamic.
  LinkCounts count(const PatchTree& tree, std::span<const std::uint8_t> moves) const;

 private:
  struct Pair {
    std::uint32_t source = 0, first = 0;
  };
  struct Block {
    std::vector<Link> links;
    std::vector<Pair> pairs;  ///< ascending
  };
  /// What was in place of links that were replaced, and all pairs as they stood.
  struct Replaced {
    std::vector<Replacement> links;
    std::vector<Pair> pairs;
    std::size_t size = 0;  ///< of the block
  };
  /// The same of energies, and the place of a link that was not stale.
  using Change = std::variant<Replaced, Replacement, std::size_t>;

  static std::pair<std::size_t, std::size_t> range(const Block& block, std::uint32_t source);
  static void arrange(Block& block, std::vector<Pair>&& pairs, std::size_t size, std::span<const Replacement> put);

  std::vector<Block> blocks_;
  std::vector<std::vector<Change>> changes_;  ///< by receiver
  bool keeping_ = false;
  std::size_t roots_kept_ = 0;  ///< how many there were
};

}  // namespace exitance
