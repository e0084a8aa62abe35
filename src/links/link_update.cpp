#include "src/links/link_update.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "geometry/shadow_volume.h"

namespace exitance {
namespace {

using End = LinkCode::End;

/// Where the changed objects stand at one time: what of them can enter a shaft.
struct ChangedObjects {
  ChangedObjects(const Obstacles& obstacles, std::span<const std::uint8_t> moved) {
    for (std::uint32_t object = 0; object < moved.size(); ++object) {
      const auto [first, last] = obstacles.facets_of(object);
      if (moved[object] == 0 || first == last) continue;
      const std::vector<std::uint32_t> of_object = obstacles.items_of(object);
      items.insert(items.end(), of_object.begin(), of_object.end());
      casters.push_back(std::make_unique<ShadowCaster>(obstacles.soup(), first, last));
    }
    std::ranges::sort(items);
  }

  std::vector<std::uint32_t> items;
  std::vector<std::unique_ptr<ShadowCaster>> casters;
};

/// Whole patches, and where each sees its own shadows of the changed objects, old and new. Conservative.
class RootShadows {
 public:
  RootShadows(const LinkTask& task, const ChangedObjects& now, const ChangedObjects* before) : tree_(*task.tree) {
    std::vector<const ShadowCaster*> casters;
    for (const auto& caster : now.casters) casters.push_back(caster.get());
    const std::size_t of_now = casters.size();
    if (before != nullptr) {
      for (const auto& caster : before->casters) casters.push_back(caster.get());
    }
    count_ = casters.size();
    const std::size_t roots = tree_.roots().size();
    shadows_.resize(roots * count_);
    balls_.resize(roots);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(roots)), [&](const auto& range) {
      for (std::size_t k = 0; k < count_; ++k) {
        ShadowVolume volume(*casters[k]);
        for (std::uint32_t r = range.begin(); r < range.end(); ++r) {
          const Root& root = tree_.root(r);
          if (!root.present || task.moved[root.object] != 0) continue;
          ShaftEnd shooter = shaft_end(tree_.node(root.node_first));
          const Obstacles& obstacles = k < of_now ? *task.now : *task.before;
          shooter.facet += obstacles.facets_of(root.object).first - tree_.facet_first(root.object);
          volume.set_shooter(shooter);
          Shadow& shadow = shadows_[r * count_ + k];
          shadow.covers = volume.covers_shooter();
          for (HalfSpace h : volume.region()) {
            const double per_length = 1 / norm(h.normal);
            shadow.region.push_back({per_length * h.normal, per_length * h.offset});
          }
        }
      }
      for (std::uint32_t r = range.begin(); r < range.end(); ++r) {
        const auto loop = tree_.node(tree_.root(r).node_first).loop();
        Ball& ball = balls_[r];
        for (const Vec3& v : loop) ball.centre = ball.centre + (1.0 / static_cast<double>(loop.size())) * v;
        for (const Vec3& v : loop) ball.radius = std::max(ball.radius, norm(v - ball.centre));
        ball.radius *= 1 + 1e-9;
      }
    });
  }

  /// Whether what one sees of the other may have changed.
  bool may_change(std::uint32_t a, std::uint32_t b) const {
    for (std::size_t k = 0; k < count_; ++k) {
      const Shadow &of_a = shadows_[a * count_ + k], &of_b = shadows_[b * count_ + k];
      if (of_a.covers || of_b.covers || (reaches(b, of_a.region) && reaches(a, of_b.region))) return true;
    }
    return false;
  }

 private:
  struct Shadow {
    bool covers = false;
    std::vector<HalfSpace> region;  ///< unit normals
  };
  struct Ball {
    Vec3 centre;
    double radius = 0;
  };

  bool reaches(std::uint32_t r, const std::vector<HalfSpace>& region) const {
    const Ball& ball = balls_[r];
    const auto beyond = [&](const HalfSpace& h) {
      const double height = dot(h.normal, ball.centre) - h.offset;
      if (height >= 0) return false;
      return height < -ball.radius - 1e-12 * std::fabs(h.offset) ||
             std::ranges::all_of(tree_.node(tree_.root(r).node_first).loop(), [&](const Vec3& v) {
               return dot(h.normal, v) < h.offset - 1e-12 * std::fabs(h.offset);
             });
    };
    return std::ranges::none_of(region, beyond);
  }

  const PatchTree& tree_;
  std::size_t count_ = 0;
  std::vector<Shadow> shadows_;  ///< [root][caster]
  std::vector<Ball> balls_;
};

/// Works for one thread.
class Updater {
 public:
  Updater(const LinkTask& task, const ChangedObjects& now, const ChangedObjects* before, const RootShadows* shadows)
      : task_(task),
        tree_(*task.tree),
        changed_now_(now),
        changed_before_(before),
        shadows_(shadows),
        sight_(tree_, *task.now, task.points_per_edge) {
    if (before != nullptr) sight_before_.emplace(tree_, *task.before, task.points_per_edge);
  }

  void update(std::uint32_t receiver, LinkIndex& links, NodeRadiosity* differences);

  LinkWork work() const {
    LinkWork work = work_;
    work.sight += sight_.work();
    if (sight_before_) work.sight += sight_before_->work();
    return work;
  }

 private:
  struct Pair {
    std::uint32_t receiver = 0, source = 0;
  };
  /// What is known of a link when its descendants are looked at.
  struct Above {
    bool moved = false;           ///< an end has: everything about it is new
    bool affected = false;        ///< by the old or the new place of an object
    bool forced = false;          ///< it, or one above it, was left stale
    std::optional<Sight> before;  ///< in the scene as it was, among the objects that moved, where that was asked
    Sight sight;                  ///< in the scene as it is
  };

  // Of a scope.
  bool tests_all() const { return task_.scope == LinkScope::all || task_.scope == LinkScope::values; }
  bool alone() const { return task_.scope == LinkScope::all; }
  bool only_refines() const { return task_.scope == LinkScope::refinement || task_.scope == LinkScope::materials; }
  bool only_significant() const { return task_.scope == LinkScope::significant; }

  double energy(const Pair& pair, double form_factor) const {
    const Node &to = tree_.node(pair.receiver), &from = tree_.node(pair.source);
    return task_.luminance[pair.source] * judged_form_factor(to, from, form_factor);
  }
  std::optional<End> divided_end(const Pair& pair, LinkCode code) const;
  Pair child(const Pair& pair, End end, unsigned k) const;
  bool wants_refinement(const Pair& pair, LinkCode code, double energy, bool blocked) const {
    return !blocked && energy > task_.eps2 && divided_end(pair, code).has_value();
  }
  /// Whether it is to be done, too.
  bool divides(const Pair& pair, LinkCode code, double energy, bool blocked) const {
    return wants_refinement(pair, code, energy, blocked) &&
           !(task_.scope == LinkScope::refinement && task_.stop && task_.stop());
  }
  bool wants_change(std::span<const Link> links) const;

  bool touches_changed(const Sight& sight) const;

  void visit(std::span<const Link> old, const Above& above, bool root);
  void grow_roots(const Pair& pair);
  void grow(const Pair& pair, LinkCode code, const Sight& sight);
  Link ghost(const Pair& pair, LinkCode code, double form_factor, const Sight& sight) const;
  void add_leaf(const Pair& pair, LinkCode code, double form_factor, const Sight& sight);
  void copy(std::span<const Link> links) { out_.insert(out_.end(), links.begin(), links.end()); }
  void close(std::size_t at);

  const LinkTask& task_;
  const PatchTree& tree_;
  const ChangedObjects& changed_now_;
  const ChangedObjects* changed_before_;
  const RootShadows* shadows_;  ///< where most pairs are to be left out
  LinkSight sight_;
  std::optional<LinkSight> sight_before_;
  std::vector<Link> out_;
  bool changed_ = false;  ///< whether what is in out_ differs from what was
  LinkWork work_;
};

/// The larger end, unless it has no children and the other has.
std::optional<End> Updater::divided_end(const Pair& pair, LinkCode code) const {
  if (code.steps() == LinkCode::kMostSteps) return std::nullopt;
  const Node &to = tree_.node(pair.receiver), &from = tree_.node(pair.source);
  if (!to.has_children() && !from.has_children()) return std::nullopt;
  if (!to.has_children()) return End::source;
  if (!from.has_children()) return End::receiver;
  return to.area >= from.area ? End::receiver : End::source;
}

Updater::Pair Updater::child(const Pair& pair, End end, unsigned k) const {
  if (end == End::receiver) return {tree_.node(pair.receiver).first_child + k, pair.source};
  return {pair.receiver, tree_.node(pair.source).first_child + k};
}

/// Whether refinement, or un-refinement where that is asked, would change any of the links.
bool Updater::wants_change(std::span<const Link> links) const {
  return std::ranges::any_of(links, [&](const Link& link) {
    const Pair pair{link.destination, link.source};
    const double B_F = energy(pair, link.form_factor);
    if (link.ghost) return task_.scope == LinkScope::materials && B_F < task_.eps1;
    return wants_refinement(pair, link.code, B_F, link.blocked);
  });
}

bool Updater::touches_changed(const Sight& sight) const {
  return std::ranges::any_of(sight_.items(sight),
                             [&](std::uint32_t item) { return std::ranges::binary_search(changed_now_.items, item); });
}

void Updater::update(std::uint32_t r, LinkIndex& links, NodeRadiosity* differences) {
  const Root& receiver = tree_.root(r);
  const auto has_moved = [&](const Root& root) { return !task_.moved.empty() && task_.moved[root.object] != 0; };

  std::vector<LinkIndex::Replacement> replacements;
  std::vector<std::size_t> stale;  // records to be marked
  const std::span<Link> all = links.of_receiver(r);
  std::size_t at = 0;
  for (std::uint32_t s = 0; s < tree_.roots().size(); ++s) {
    std::size_t last = at;
    while (last < all.size() && tree_.node(all[last].source).root == s) last += all[last].next;
    const std::span<const Link> old = all.subspan(at, last - at);
    const std::size_t first = std::exchange(at, last);
    const Root& source = tree_.root(s);
    const bool moved = has_moved(receiver) || has_moved(source);
    const Pair roots{receiver.node_first, source.node_first};
    out_.clear();
    changed_ = false;
    if (!receiver.present || !source.present || s == r) {
      changed_ = !old.empty();
    } else if (old.empty()) {
      if ((task_.scope != LinkScope::refinement && !moved) ||
          !face_each_other(tree_.node(roots.receiver), tree_.node(roots.source), task_.now->soup())) {
        continue;
      }
      grow_roots(roots);
      changed_ = true;
    } else if (only_refines()) {
      if (task_.scope == LinkScope::materials && task_.relit[source.object] == 0) continue;
      if (!wants_change(old)) continue;
      visit(old, {}, true);
    } else if (moved || tests_all()) {
      Above ends;
      ends.moved = moved;
      visit(old, ends, true);
    } else {
      const bool forced = task_.any_stale && std::ranges::any_of(old, [](const Link& link) { return link.stale; });
      if (!forced && !shadows_->may_change(r, s)) continue;
      if (only_significant() && old.front().energy < task_.B_eps) {
        stale.push_back(first);
        ++work_.skipped;
        continue;
      }
      visit(old, {}, true);
    }
    if (!changed_) continue;
    if (differences != nullptr) {
      for (const Link& link : old) {
        if (!link.ghost && link.visibility > 0) differences->receive(link.destination, -link.transfer(), link.source);
      }
      for (const Link& link : out_) {
        if (!link.ghost && link.visibility > 0) differences->receive(link.destination, link.transfer(), link.source);
      }
    }
    replacements.push_back({s, std::vector<Link>(out_.begin(), out_.end())});
  }
  for (const std::size_t k : stale) all[k].stale = true;
  if (!replacements.empty()) links.replace(r, replacements);
}

/// Appends to out_ what becomes of a link and its descendants.
void Updater::visit(std::span<const Link> old, const Above& above, bool root) {
  const Link& link = old.front();
  const Pair pair{link.destination, link.source};
  Above here = above;
  here.forced = above.forced || link.stale;
  here.before.reset();
  here.sight = {};
  bool known = false;  // here.sight is; else nothing enters, or nothing needs it

  const auto find_sight = [&] {
    here.sight = root      ? sight_.between_roots(pair.receiver, pair.source)
                 : alone() ? sight_.between_alone(pair.receiver, pair.source, above.sight)
                           : sight_.between(pair.receiver, pair.source, above.sight);
    known = true;
  };
  const auto forget = [&] {
    if (known) sight_.forget(here.sight);
    if (here.before) sight_before_->forget(*here.before);
  };
  const auto leave_stale = [&] {
    copy(old);
    out_[out_.size() - old.size()].stale = true;
    changed_ = true;
    ++work_.skipped;
    forget();
  };

  double F = link.form_factor;
  bool evaluate = false, may_change = false;  // its value; whether it is refined
  if (only_refines()) {
    if (!wants_change(old)) return above.forced ? leave_stale() : copy(old);
    if (here.forced) {  // what it was left as tells nothing
      F = sight_.form_factor(pair.receiver, pair.source);
      evaluate = changed_ = true;
    }
    if (!link.open || here.forced) find_sight();
    may_change = true;
  } else if (above.moved) {
    changed_ = true;
    if (!face_each_other(tree_.node(pair.receiver), tree_.node(pair.source), task_.now->soup())) return;
    F = sight_.form_factor(pair.receiver, pair.source);
    const double most = std::max(energy(pair, F), task_.luminance[pair.source] * link.transfer());
    if (only_significant() && !link.ghost && most < task_.B_eps) return leave_stale();
    find_sight();
    here.affected = evaluate = may_change = true;
  } else {
    if (only_significant() && link.energy < task_.B_eps) return leave_stale();
    const bool blocked_above = !root && above.sight.state == Sight::State::blocked;
    const bool has_changed = task_.before != nullptr;
    if (has_changed && !blocked_above) {
      here.before =
          root || !alone()
              ? (root ? sight_before_->between_roots(pair.receiver, pair.source, changed_before_->items)
                      : sight_before_->between(pair.receiver, pair.source, *above.before))
              : sight_before_->between_alone(pair.receiver, pair.source, *above.before, changed_before_->items);
      if (here.before->state == Sight::State::blocked) here.before->state = Sight::State::partial;
    }
    const bool touched_before = here.before && here.before->count > 0;
    const bool has_stale = task_.any_stale && std::ranges::any_of(old, [](const Link& l) { return l.stale; });
    bool touched = false;
    if (has_changed && !tests_all() && !blocked_above && !touched_before && !has_stale && !here.forced) {
      // Most shafts are not entered by what moved: that alone is asked first.
      if (root) {
        const Sight of_changed = sight_.between_roots(pair.receiver, pair.source, changed_now_.items);
        touched = of_changed.count > 0;
        sight_.forget(of_changed);
      } else {
        touched = sight_.touched(pair.receiver, pair.source, above.sight, changed_now_.items);
      }
      if (!touched) {
        forget();
        return copy(old);
      }
    }
    find_sight();
    touched = has_changed && touches_changed(here.sight);
    here.affected = blocked_above ? above.affected : touched_before || touched;
    may_change = task_.scope != LinkScope::values && (here.affected || here.forced);
    evaluate = tests_all() || here.affected || here.forced;
    if (!evaluate && !has_stale) {
      forget();
      return copy(old);
    }
    // What was left stale may have moved then.
    if (tests_all() || here.forced) F = sight_.form_factor(pair.receiver, pair.source);
    if (only_significant() && evaluate && !link.ghost) {
      // What moved in can only hide, what moved away only reveal.
      const double v = link.visibility;
      const bool may_hide = touched || blocked_above || here.forced, may_reveal = touched_before || here.forced;
      const double most = std::max(may_hide ? v : 0, may_reveal ? 1 - v : 0);
      if (most * energy(pair, F) < task_.B_eps) return leave_stale();
    }
    changed_ = changed_ || evaluate;
  }

  const bool blocked = known ? here.sight.state == Sight::State::blocked : link.blocked;
  if (!link.ghost) {
    if (may_change && divides(pair, link.code, energy(pair, F), blocked)) {
      changed_ = true;
      grow(pair, link.code, here.sight);
    } else if (evaluate) {
      work_.links_affected += here.affected || here.forced;
      add_leaf(pair, link.code, F, here.sight);
    } else {
      copy(old);
    }
    return forget();
  }

  const std::size_t at = out_.size();
  out_.push_back(evaluate ? ghost(pair, link.code, F, here.sight) : link);
  const End end = *divided_end(pair, link.code);
  std::size_t next = 1;
  bool all_leaves = true;
  for (unsigned k = 0; k < 4; ++k) {
    const LinkCode code = link.code.descend(end, k);
    const Pair to = child(pair, end, k);
    const std::size_t child_at = out_.size();
    if (next < old.size() && old[next].code == code) {
      const std::span<const Link> of_child = old.subspan(next, old[next].next);
      next += of_child.size();
      visit(of_child, here, false);
    } else if (above.moved && face_each_other(tree_.node(to.receiver), tree_.node(to.source), task_.now->soup())) {
      const Sight sight = sight_.between(to.receiver, to.source, here.sight);
      grow(to, code, sight);
      sight_.forget(sight);
    }
    if (out_.size() > child_at) all_leaves = all_leaves && !out_[child_at].ghost;
  }
  close(at);
  if (may_change && task_.scope != LinkScope::refinement && all_leaves && energy(pair, F) < task_.eps1) {
    out_.resize(at);
    add_leaf(pair, link.code, F, here.sight);
    changed_ = true;
    ++work_.unrefined;
  }
  forget();
}

/// Appends the links between two patches that had none.
void Updater::grow_roots(const Pair& pair) {
  const Sight sight = sight_.between_roots(pair.receiver, pair.source);
  grow(pair, {}, sight);
  sight_.forget(sight);
}

/// Appends a new link and, where its energy asks for it, what it is refined to.
void Updater::grow(const Pair& pair, LinkCode code, const Sight& sight) {
  const double F = sight_.form_factor(pair.receiver, pair.source);
  if (!divides(pair, code, energy(pair, F), sight.state == Sight::State::blocked)) {
    ++work_.links_affected;
    return add_leaf(pair, code, F, sight);
  }
  ++work_.refined;
  const std::size_t at = out_.size();
  out_.push_back(ghost(pair, code, F, sight));
  const End end = *divided_end(pair, code);
  for (unsigned k = 0; k < 4; ++k) {
    const Pair to = child(pair, end, k);
    if (!face_each_other(tree_.node(to.receiver), tree_.node(to.source), task_.now->soup())) continue;
    const Sight of_child = sight_.between(to.receiver, to.source, sight);
    grow(to, code.descend(end, k), of_child);
    sight_.forget(of_child);
  }
  close(at);
}

/// Sets the extent and the energy of a ghost whose descendants have been appended.
void Updater::close(std::size_t at) {
  out_[at].next = static_cast<std::uint32_t>(out_.size() - at);
  out_[at].energy = 0;
  for (std::size_t k = at + 1; k < out_.size(); k += out_[k].next)
    out_[at].energy = std::max(out_[at].energy, out_[k].energy);
}

Link Updater::ghost(const Pair& pair, LinkCode code, double form_factor, const Sight& sight) const {
  Link link;
  link.code = code;
  link.source = pair.source;
  link.destination = pair.receiver;
  link.form_factor = form_factor;
  link.visibility = 1;
  link.ghost = true;
  link.open = sight.state == Sight::State::open;
  link.blocked = sight.state == Sight::State::blocked;
  return link;
}

void Updater::add_leaf(const Pair& pair, LinkCode code, double form_factor, const Sight& sight) {
  Link link = ghost(pair, code, form_factor, sight);
  link.ghost = false;
  link.energy = energy(pair, form_factor);
  if (link.blocked || form_factor == 0) {
    link.visibility = 0;
  } else if (!link.open) {
    const double seen = sight_.visible_form_factor(pair.receiver, pair.source, sight);
    link.visibility = std::min(1.0, seen / form_factor);
  }
  ++work_.links_updated;
  out_.push_back(link);
}

}  // namespace

LinkWork& LinkWork::operator+=(const LinkWork& other) {
  links_updated += other.links_updated;
  links_affected += other.links_affected;
  skipped += other.skipped;
  refined += other.refined;
  unrefined += other.unrefined;
  sight += other.sight;
  return *this;
}

LinkWork update_links(const LinkTask& task, LinkIndex& links, NodeRadiosity* differences) {
  links.grow(task.tree->roots().size());
  const ChangedObjects now(*task.now, task.moved);
  std::optional<ChangedObjects> before;
  if (task.before != nullptr) before.emplace(*task.before, task.moved);
  std::optional<RootShadows> shadows;
  if (task.scope == LinkScope::hierarchical || task.scope == LinkScope::significant)
    shadows.emplace(task, now, before ? &*before : nullptr);
  tbb::enumerable_thread_specific<std::unique_ptr<Updater>> updaters(
      [&] { return std::make_unique<Updater>(task, now, before ? &*before : nullptr, shadows ? &*shadows : nullptr); });
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(task.tree->roots().size()), 1),
                    [&](const auto& range) {
                      for (std::uint32_t r = range.begin(); r < range.end(); ++r)
                        updaters.local()->update(r, links, differences);
                    });
  LinkWork work;
  for (const auto& updater : updaters) work += updater->work();
  return work;
}

}  // namespace exitance
