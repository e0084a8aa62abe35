#include "src/stress/shaft_question.h"

#include <algorithm>

#include "src/stress/shaft_oracle.h"

namespace exitance {
namespace {

constexpr int kLines = 12;

ShaftClass class_of(Shaft::Overlap overlap) {
  return overlap == Shaft::Overlap::outside   ? ShaftClass::outside
         : overlap == Shaft::Overlap::partial ? ShaftClass::partial
                                              : ShaftClass::blocking;
}

Visibility visibility_of(ShaftClass c) {
  switch (c) {
    case ShaftClass::outside:
      return Visibility::open;
    case ShaftClass::blocking:
      return Visibility::blocked;
    case ShaftClass::away:
      return Visibility::away;
    case ShaftClass::partial:
    case ShaftClass::torn:
      break;
  }
  return Visibility::partial;
}

/// Of all shafts but those that are away.
class AllShafts {
 public:
  void add(Visibility one) {
    if (one == Visibility::away) return;
    all_ = all_ == Visibility::away || all_ == one ? one : Visibility::partial;
  }
  Visibility visibility() const { return all_; }

 private:
  Visibility all_ = Visibility::away;
};

/// What the oracle allows to be said of one shaft, and then of each item.
std::vector<Classes> allowed_of(const PolygonSoup& soup, const ShaftOracle& oracle, const AreaScene::Ends& ends,
                                Random& random) {
  const ExactEnd a = oracle.end({ends.receiver, {}}), b = oracle.end({ends.source, {}});
  if (!oracle.face_each_other(a, b)) return {bits(ShaftClass::away)};
  const auto sides = sides_of_hull(a, b);
  std::vector<Classes> allowed{0};
  ShaftClass most = ShaftClass::outside;
  bool undecided = false, in_plane = false, has_certain_block = false;
  ExactItem all;
  for (const std::uint32_t index : items_of(soup)) {
    const ExactItem item = oracle.item(index);
    const ShaftClass c = class_of(oracle.overlap(a, b, sides, index));
    const bool is_blocking = c == ShaftClass::blocking;
    const bool is_open_to_doubt = is_blocking && item.solid && !plainly_separated(a, b, item);
    allowed.push_back(is_open_to_doubt ? bits(c, ShaftClass::partial) : bits(c));
    undecided = undecided || is_open_to_doubt;
    has_certain_block = has_certain_block || (is_blocking && !is_open_to_doubt);
    most = std::max(most, c);
    if (index == a.facet || index == b.facet) continue;
    if (oracle.touches_plane(index, a.facet) || oracle.touches_plane(index, b.facet)) {
      in_plane = true;  // other facets of a bent end are so by identity, though lines may cross them
      if (!item.solid) continue;
    }
    all.loops.insert(all.loops.end(), item.loops.begin(), item.loops.end());
    all.planes.insert(all.planes.end(), item.planes.begin(), item.planes.end());
  }
  const bool is_open_to_doubt = undecided && !has_certain_block;
  allowed[0] = is_open_to_doubt ? bits(most, ShaftClass::partial) : bits(most);
  const auto remove = [&](ShaftClass c) { allowed[0] = static_cast<Classes>(allowed[0] & ~bits(c)); };
  const Lines lines = look_along_lines(a, b, all, kLines, random);
  if (lines.blocked > 0) remove(ShaftClass::outside);
  // Where a line ends in a contact, nothing stands strictly between.
  if (lines.blocked < lines.seen && !in_plane) remove(ShaftClass::blocking);
  return allowed;
}

}  // namespace

Opinion ask_shafts(const Question& question) {
  const AreaScene scene(question);
  Shaft shaft(scene.soup);
  const std::vector<std::uint32_t> items = items_of(scene.soup);
  Opinion opinion;
  AllShafts all;
  std::vector<std::uint32_t> found;
  for (const auto& [receiver, source] : scene.ends()) {
    shaft.reset({receiver, {}}, {source, {}});
    const bool facing = shaft.face_each_other();
    const ShaftClass most = facing ? class_of(shaft.find_occluders(found)) : ShaftClass::away;
    opinion.classes.push_back(static_cast<std::uint8_t>(most));
    all.add(visibility_of(most));
    if (!facing) continue;
    for (const std::uint32_t item : items) {
      const ShaftClass c = class_of(shaft.overlap(item));
      const bool is_found = std::ranges::binary_search(found, item);
      opinion.classes.push_back(
          static_cast<std::uint8_t>(is_found == (c != ShaftClass::outside) ? c : ShaftClass::torn));
    }
  }
  opinion.visibility = all.visibility();
  opinion.stages = shaft.stage_counts();
  return opinion;
}

Truth shaft_truth(const Question& question) {
  const AreaScene scene(question);
  const ShaftOracle oracle(scene.soup);
  Random random("lines");
  std::vector<Classes> allowed;
  AllShafts all;
  for (const AreaScene::Ends& ends : scene.ends()) {
    const std::vector<Classes> one = allowed_of(scene.soup, oracle, ends, random);
    allowed.insert(allowed.end(), one.begin(), one.end());
    for (const ShaftClass c : {ShaftClass::outside, ShaftClass::partial, ShaftClass::blocking, ShaftClass::away}) {
      if (one[0] == bits(c)) all.add(visibility_of(c));
    }
  }
  const Visibility seen = all.visibility();
  return {seen == Visibility::open      ? Truth::Seen::all
          : seen == Visibility::partial ? Truth::Seen::some
                                        : Truth::Seen::none,
          std::nullopt, [allowed](const Opinion& opinion) { return judge(opinion, allowed); }};
}

}  // namespace exitance
