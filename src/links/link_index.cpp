#include "src/links/link_index.h"

#include <algorithm>

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

const Link* LinkIndex::find(std::uint32_t receiver, std::uint32_t source, LinkCode code) const {
  const std::span<const Link> links = between(receiver, source);
  const auto at = std::ranges::lower_bound(links, code, {}, &Link::code);
  return at != links.end() && at->code == code ? &*at : nullptr;
}

void LinkIndex::replace(std::uint32_t receiver, std::span<const Replacement> replacements) {
  Block& block = blocks_[receiver];
  const bool in_place = std::ranges::all_of(replacements, [&](const Replacement& r) {
    const auto [first, last] = range(block, r.source);
    return last - first == r.links.size();
  });
  if (in_place) {
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
  block = std::move(made);
}

LinkCounts LinkIndex::count(const PatchTree& tree, std::span<const std::uint8_t> moves) const {
  LinkCounts counts;
  counts.bytes = blocks_.capacity() * sizeof(Block);
  for (const Block& block : blocks_) {
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
