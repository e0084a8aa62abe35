#pragma once
// What becomes of the links between two patches: shadow detection, un-refinement and refinement (Feng et al., sections
// 3, 5 and 6.1).
//
// F, by which B F is held against eps1 and eps2, is the bound of most_form_factor: no point of its receiver gets more
// by a link that stands and could be divided. The form factor itself, a mean, would let stand what is bright for some
// of a large receiver and dark for most of it.
//
// The listing of section 3 puts links that nothing affects into the shadow set; they keep their kind here, as is meant.
// A ghost is un-refined when B F falls below eps1 and nothing below it is refined; the listing asks its children.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "src/links/link_sight.h"
#include "src/links/link_task.h"
#include "src/links/root_shadows.h"

namespace exitance {

/// Works for one thread. A link's values depend on its nodes and the scene only, and which links there are on those,
/// the links before, and the luminances.
class PairUpdate {
 public:
  /// before: null where no geometry has changed; shadows: where pairs that they exclude are to be left out, else null.
  /// All must live as long.
  PairUpdate(const LinkTask& task, const ChangedObjects& now, const ChangedObjects* before, const RootShadows* shadows);

  /// What is to be done about two patches.
  enum class Need : std::uint8_t {
    nothing,
    work,    ///< update() may find a change
    skip,    ///< something may have changed, by less than B_eps
    removal  ///< one of them is not there any more
  };
  /// links: those between them, maybe none.
  Need need(const PatchPair& pair, std::span<const Link> links) const;
  /// What they could bring at most, B F A of the receiver in luminance.
  double stake(const PatchPair& pair, std::span<const Link> links) const;

  /// Whether what becomes of the old links differs; then fills `links` with it, in order. Throws LimitError as soon as
  /// one pair takes more new links than the task allows for all, those that un-refinement would take away included.
  bool update(const PatchPair& pair, std::span<const Link> old, std::vector<Link>& links);

  LinkWork work() const;

 private:
  struct Ends {
    std::uint32_t receiver = 0, source = 0;  ///< nodes
  };
  /// What is known of a link when its descendants are looked at.
  struct Above {
    Above* above = nullptr;  ///< null: of whole patches
    Ends ends;
    bool renewed = false;         ///< an end has moved, or it was left stale: everything about it is new
    bool affected = false;        ///< by the old or the new place of an object
    bool blocked = false;         ///< in the scene as it is, as was known before any descendant was looked at
    std::optional<Sight> before;  ///< in the scene as it was, among the objects that moved; where one has, not blocked
    std::optional<Sight> now;     ///< in the scene as it is, where that was asked, maybe by a descendant
  };

  // Of a scope.
  bool tests_all() const { return task_.scope == LinkScope::all || task_.scope == LinkScope::values; }
  bool alone() const { return task_.scope == LinkScope::all; }
  bool only_refines() const { return task_.scope == LinkScope::refinement || task_.scope == LinkScope::materials; }
  bool only_significant() const { return task_.scope == LinkScope::significant; }

  bool has_moved(const Root& root) const { return !task_.moved.empty() && task_.moved[root.object] != 0; }
  bool face_each_other(const Ends& ends) const;
  double light(const Ends& ends) const;
  double energy(const Ends& ends, double form_factor) const;
  double most_form_factor(const Ends& ends) const;
  double most_energy(const Ends& ends) const;
  bool receives_anew(const Link& link) const;
  bool is_insignificant(const Link& link) const;
  std::optional<LinkCode::End> divided_end(const Ends& ends, LinkCode code) const;
  Ends child(const Ends& ends, LinkCode::End end, unsigned k) const;
  bool wants_refinement(const Ends& ends, LinkCode code, bool blocked) const;
  bool divides(const Ends& ends, LinkCode code, bool blocked) const;
  bool wants_change(std::span<const Link> links) const;
  bool touches_changed(const Sight& sight) const;
  const Sight& sight_of(Above& link);
  bool is_touched(const Above& link);

  void visit(std::span<const Link> old, Above* above, bool renewed);
  void grow_roots(const Ends& ends);
  void grow(const Ends& ends, LinkCode code, const Sight& sight);
  Link ghost(const Ends& ends, LinkCode code, double form_factor, const Sight& sight) const;
  void add_leaf(const Ends& ends, LinkCode code, double form_factor, const Sight& sight);
  void copy(std::span<const Link> links) { out_.insert(out_.end(), links.begin(), links.end()); }
  void close(std::size_t at);

  const LinkTask& task_;
  const PatchTree& tree_;
  const ChangedObjects& changed_now_;
  const ChangedObjects* changed_before_;
  const RootShadows* shadows_;
  LinkSight sight_;
  std::optional<LinkSight> sight_before_;
  std::vector<Link> out_;
  std::uint64_t most_ = 0;  ///< that may be in it
  bool changed_ = false;    ///< whether what is in out_ differs from what was
  LinkWork work_;
};

}  // namespace exitance
