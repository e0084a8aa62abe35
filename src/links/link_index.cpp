#include "src/links/link_index.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace exitance {

/// Where the links from a source patch stand in a block.
std::pair<std::size_t, std::size_t> LinkIndex::range(const Block& block, std::uint32_t source) const {
  const auto at = std::ranges::lower_bound(block.pairs, source, {}, &Pair::source);
  const std::size_t first = at == block.pairs.end() ? block.links.size() : at->first;
  if (at == block.pairs.end() || at->source != source) return {first, first};
  return {first, at + 1 == block.pairs.end() ? block.links.size() : (at + 1)->first};
}

std::span<const Link> LinkIndex::between(std::uint32_t receiver, std::uint32_t source) const {
  const Block& block = blocks_[receiver];
  const auto [first, last] = range(block, source);
  return {block.links.data() + first, last - first};
}

void LinkIndex::grow(std::size_t roots) {
  blocks_.resize(roots);
  changes_.resize(roots);
}

void LinkIndex::replace(std::uint32_t receiver, std::span<const Replacement> replacements) {
  Block& block = blocks_[receiver];
  std::vector<Change>& changes = changes_[receiver];
  const bool in_place = std::ranges::all_of(replacements, [&](const Replacement& r) {
    const auto [first, last] = range(block, r.source);
    return last - first == r.links.size();
  });
  if (in_place) {
    if (keeping_) {
      std::vector<Change> kept;
      for (const Replacement& r : replacements) {
        const std::span<const Link> old = between(receiver, r.source);
        kept.emplace_back(Replacement{r.source, {old.begin(), old.end()}});
      }
      changes.reserve(changes.size() + kept.size());
      std::ranges::move(kept, std::back_inserter(changes));
    }
    for (const Replacement& r : replacements)
      std::ranges::copy(r.links, block.links.begin() + static_cast<std::ptrdiff_t>(range(block, r.source).first));
    return;
  }
  Block made;
  std::size_t size = block.links.size();
  for (const Replacement& r : replacements) {
    const auto [first, last] = range(block, r.source);
    size += r.links.size() - (last - first);
  }
  made.links.reserve(size);
  std::size_t pair = 0;
  const auto keep = [&](std::uint32_t below) {
    for (; pair < block.pairs.size() && block.pairs[pair].source < below; ++pair) {
      const auto [first, last] = range(block, block.pairs[pair].source);
      made.pairs.push_back({block.pairs[pair].source, static_cast<std::uint32_t>(made.links.size())});
      made.links.insert(made.links.end(), block.links.begin() + static_cast<std::ptrdiff_t>(first),
                        block.links.begin() + static_cast<std::ptrdiff_t>(last));
    }
  };
  for (const Replacement& r : replacements) {
    keep(r.source);
    if (pair < block.pairs.size() && block.pairs[pair].source == r.source) ++pair;
    if (r.links.empty()) continue;
    made.pairs.push_back({r.source, static_cast<std::uint32_t>(made.links.size())});
    made.links.insert(made.links.end(), r.links.begin(), r.links.end());
  }
  keep(0xffffffffu);
  std::swap(block, made);
  if (!keeping_) return;
  try {
    changes.emplace_back(std::move(made));
  } catch (...) {
    std::swap(block, made);  // growing the list left it where it was
    throw;
  }
}

void LinkIndex::mark_stale(std::uint32_t receiver, std::uint32_t source) {
  const std::size_t at = range(blocks_[receiver], source).first;
  bool& stale = blocks_[receiver].links[at].stale;
  if (stale) return;
  if (keeping_) changes_[receiver].emplace_back(at);
  stale = true;
}

std::span<Link> LinkIndex::energies_of(std::uint32_t receiver, std::uint32_t source) {
  Block& block = blocks_[receiver];
  const auto [first, last] = range(block, source);
  const std::span<Link> links = std::span(block.links).subspan(first, last - first);
  if (keeping_ && !links.empty()) changes_[receiver].emplace_back(Replacement{source, {links.begin(), links.end()}});
  return links;
}

void LinkIndex::keep_changes() {
  keeping_ = true;
  roots_kept_ = blocks_.size();
}

void LinkIndex::commit() noexcept {
  for (std::vector<Change>& changes : changes_) changes.clear();
  keeping_ = false;
}

void LinkIndex::roll_back() noexcept {
  for (std::size_t r = 0; r < blocks_.size(); ++r) {
    std::vector<Link>& links = blocks_[r].links;
    for (std::size_t k = changes_[r].size(); k-- > 0;) {  // the last one first
      Change& change = changes_[r][k];
      if (auto* block = std::get_if<Block>(&change)) {
        std::swap(blocks_[r], *block);
      } else if (const auto* replaced = std::get_if<Replacement>(&change)) {
        std::ranges::copy(replaced->links,
                          links.begin() + static_cast<std::ptrdiff_t>(range(blocks_[r], replaced->source).first));
      } else {
        links[std::get<std::size_t>(change)].stale = false;
      }
    }
  }
  blocks_.resize(roots_kept_);
  changes_.resize(roots_kept_);
  commit();
}

LinkCounts LinkIndex::count(const PatchTree& tree, std::span<const std::uint8_t> moves) const {
  LinkCounts counts;
  counts.bytes = blocks_.capacity() * sizeof(Block) + changes_.capacity() * sizeof(std::vector<Change>);
  for (const Block& block : blocks_) {
    counts.patch_pairs += block.pairs.size();
    counts.bytes += block.links.capacity() * sizeof(Link) + block.pairs.capacity() * sizeof(Pair);
    for (const Link& link : block.links) {
      if (link.ghost) {
        ++counts.ghost;
        continue;
      }
      ++(link.shadow() ? counts.shadow : counts.active);
      const int dynamic = moves[tree.object_of(link.source)] + moves[tree.object_of(link.destination)];
      ++(dynamic == 0 ? counts.environment : dynamic == 1 ? counts.mixed : counts.dynamic);
    }
  }
  return counts;
}

}  // namespace exitance
