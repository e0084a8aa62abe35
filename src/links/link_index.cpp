#include "src/links/link_index.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace exitance {

/// Where the links from a source patch stand in a block.
std::pair<std::size_t, std::size_t> LinkIndex::range(const Block& block, std::uint32_t source) {
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

/// Moves the links of pairs that are not replaced to where they stand among `size` links, and puts the others there.
/// REQUIRES: there is capacity for them. Allocates nothing.
void LinkIndex::arrange(Block& block, std::vector<Pair>&& pairs, std::size_t size, std::span<const Replacement> put) {
  std::vector<Link>& links = block.links;
  std::swap(block.pairs, pairs);  // those before are in `pairs` now
  const std::size_t old_size = links.size();
  if (size > old_size) links.resize(size);
  const auto stays = [&](std::uint32_t source) {
    return !std::ranges::binary_search(put, source, {}, &Replacement::source);
  };
  const auto at = [&](std::size_t k) { return links.begin() + static_cast<std::ptrdiff_t>(k); };
  // What moves down from the first to the last, then what moves up from the last to the first: nothing is run over.
  const auto old_last = [&](std::size_t k) { return k + 1 < pairs.size() ? pairs[k + 1].first : old_size; };
  std::size_t n = 0, k = 0;
  for (; n < block.pairs.size(); ++n) {
    const auto [source, first] = block.pairs[n];
    while (k < pairs.size() && pairs[k].source < source) ++k;
    if (k < pairs.size() && pairs[k].source == source && first < pairs[k].first && stays(source))
      std::copy(at(pairs[k].first), at(old_last(k)), at(first));
  }
  for (k = pairs.size(); n-- > 0;) {
    const auto [source, first] = block.pairs[n];
    while (k > 0 && pairs[k - 1].source > source) --k;
    if (k == 0 || pairs[k - 1].source != source || first <= pairs[k - 1].first || !stays(source)) continue;
    const std::size_t last = old_last(k - 1);
    std::copy_backward(at(pairs[k - 1].first), at(last), at(first + last - pairs[k - 1].first));
  }
  links.resize(size);
  for (const Replacement& r : put) std::ranges::copy(r.links, at(range(block, r.source).first));
}

void LinkIndex::replace(std::uint32_t receiver, std::span<const Replacement> replacements) {
  Block& block = blocks_[receiver];
  std::vector<Pair> pairs;
  pairs.reserve(block.pairs.size() + replacements.size());
  std::size_t size = 0, pair = 0;
  const auto keep = [&](std::uint32_t below) {
    for (; pair < block.pairs.size() && block.pairs[pair].source < below; ++pair) {
      const std::size_t last = pair + 1 < block.pairs.size() ? block.pairs[pair + 1].first : block.links.size();
      pairs.push_back({block.pairs[pair].source, static_cast<std::uint32_t>(size)});
      size += last - block.pairs[pair].first;
    }
  };
  for (const Replacement& r : replacements) {
    keep(r.source);
    if (pair < block.pairs.size() && block.pairs[pair].source == r.source) ++pair;
    if (r.links.empty()) continue;
    pairs.push_back({r.source, static_cast<std::uint32_t>(size)});
    size += r.links.size();
  }
  keep(0xffffffffu);
  // What an edit makes more of it is likely to change again.
  if (size > block.links.capacity()) block.links.reserve(keeping_ ? size + size / 64 : size);
  if (keeping_) {
    Replaced kept{{}, block.pairs, block.links.size()};
    kept.links.reserve(replacements.size());
    for (const Replacement& r : replacements) {
      const std::span<const Link> old = std::as_const(*this).between(receiver, r.source);
      kept.links.push_back({r.source, {old.begin(), old.end()}});
    }
    changes_[receiver].emplace_back(std::move(kept));
  }
  arrange(block, std::move(pairs), size, replacements);
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
      if (auto* replaced = std::get_if<Replaced>(&change)) {
        arrange(blocks_[r], std::move(replaced->pairs), replaced->size, replaced->links);
      } else if (const auto* judged = std::get_if<Replacement>(&change)) {
        std::ranges::copy(judged->links,
                          links.begin() + static_cast<std::ptrdiff_t>(range(blocks_[r], judged->source).first));
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
