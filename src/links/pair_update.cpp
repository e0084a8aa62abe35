#include "src/links/pair_update.h"

#include <algorithm>
#include <utility>

#include "src/links/push_pull.h"

namespace exitance {

using End = LinkCode::End;

namespace {

/// Of a link's visibility, which is known to about 1e-13.
constexpr double kNothing = 0x1p-40;

bool is_blocked(const std::optional<Sight>& sight) {
  return sight && sight->state == Sight::State::blocked;
}

}  // namespace

PairUpdate::PairUpdate(const LinkTask& task, const ChangedObjects& now, const ChangedObjects* before,
                       const RootShadows* shadows)
    : task_(task),
      tree_(*task.tree),
      changed_now_(now),
      changed_before_(before),
      shadows_(shadows),
      sight_(tree_, *task.now, tree_.points_per_edge()) {
  if (before != nullptr) sight_before_.emplace(tree_, *task.before, tree_.points_per_edge());
}

LinkWork PairUpdate::work() const {
  LinkWork work = work_;
  work.sight += sight_.work();
  if (sight_before_) work.sight += sight_before_->work();
  return work;
}

bool PairUpdate::face_each_other(const Ends& ends) const {
  return exitance::face_each_other(tree_.node(ends.receiver), tree_.node(ends.source), task_.now->soup());
}

/// Of the source. Shots leave some of it a little below 0 where it is dark, which is no less than nothing.
double PairUpdate::light(const Ends& ends) const {
  return std::max(0.0, task_.luminance[ends.source]);
}

double PairUpdate::energy(const Ends& ends, double form_factor) const {
  return light(ends) * judged_form_factor(tree_.node(ends.receiver), tree_.node(ends.source), form_factor);
}

/// At any point of the receiver.
double PairUpdate::most_form_factor(const Ends& ends) const {
  return exitance::most_form_factor(tree_.node(ends.receiver), tree_.node(ends.source), task_.now->soup());
}

double PairUpdate::most_energy(const Ends& ends) const {
  return light(ends) * most_form_factor(ends);
}

/// Whether what covers the receiver changes what a link, or a descendant of it, brings.
bool PairUpdate::receives_anew(const Link& link) const {
  const Node& receiver = tree_.node(link.destination);
  return link.ghost ? receiver.covered_anew : receiver.receives_anew;
}

/// Whether a link's energy can neither have been more than B_eps, nor be now. Where it is received at other points than
/// before, the form factor says nothing of them, nor a ghost's of what its descendants may have.
bool PairUpdate::is_insignificant(const Link& link) const {
  if (link.energy >= task_.B_eps) return false;
  if (!receives_anew(link)) return true;
  return !link.ghost && most_energy({link.destination, link.source}) < task_.B_eps;
}

bool PairUpdate::wants_refinement(const Ends& ends, LinkCode code, bool blocked) const {
  return !blocked && task_.luminance[ends.source] > task_.eps2 && divided_end(ends, code).has_value() &&
         most_energy(ends) > task_.eps2;
}

/// Whether it is to be done, too.
bool PairUpdate::divides(const Ends& ends, LinkCode code, bool blocked) const {
  return wants_refinement(ends, code, blocked) && !(task_.scope == LinkScope::refinement && task_.stop && task_.stop());
}

/// The larger end, unless it has no children and the other has.
std::optional<End> PairUpdate::divided_end(const Ends& ends, LinkCode code) const {
  if (code.steps() == LinkCode::kMostSteps) return std::nullopt;
  const Node &to = tree_.node(ends.receiver), &from = tree_.node(ends.source);
  if (!to.has_children() && !from.has_children()) return std::nullopt;
  if (!to.has_children()) return End::source;
  if (!from.has_children()) return End::receiver;
  return to.area >= from.area ? End::receiver : End::source;
}

PairUpdate::Ends PairUpdate::child(const Ends& ends, End end, unsigned k) const {
  if (end == End::receiver) return {tree_.node(ends.receiver).first_child + k, ends.source};
  return {ends.receiver, tree_.node(ends.source).first_child + k};
}

/// Whether refinement, or un-refinement where that is asked, would change any of the links.
bool PairUpdate::wants_change(std::span<const Link> links) const {
  return std::ranges::any_of(links, [&](const Link& link) {
    const Ends ends{link.destination, link.source};
    if (link.ghost) return task_.scope == LinkScope::materials && most_energy(ends) < task_.eps1;
    return wants_refinement(ends, link.code, link.blocked);
  });
}

bool PairUpdate::touches_changed(const Sight& sight) const {
  return std::ranges::any_of(sight_.items(sight),
                             [&](std::uint32_t item) { return std::ranges::binary_search(changed_now_.items, item); });
}

PairUpdate::Need PairUpdate::need(const PatchPair& pair, std::span<const Link> links) const {
  const Root &receiver = tree_.root(pair.receiver), &source = tree_.root(pair.source);
  if (!receiver.present || !source.present || pair.receiver == pair.source)
    return links.empty() ? Need::nothing : Need::removal;
  const bool moved = has_moved(receiver) || has_moved(source);
  if (links.empty()) {
    const bool new_pair = task_.scope == LinkScope::refinement || moved;
    return new_pair && face_each_other({receiver.node_first, source.node_first}) ? Need::work : Need::nothing;
  }
  if (only_refines()) {
    if (task_.scope == LinkScope::materials && task_.relit[source.object] == 0) return Need::nothing;
    return wants_change(links) ? Need::work : Need::nothing;
  }
  if (moved || tests_all()) return Need::work;
  const bool stale = task_.any_stale && std::ranges::any_of(links, [](const Link& link) { return link.stale; });
  if (!stale && !receives_anew(links.front()) && !shadows_->may_change(pair.receiver, pair.source))
    return Need::nothing;
  // What receives anew is raised where it is left, by update().
  const bool skips = only_significant() && !receives_anew(links.front()) && is_insignificant(links.front());
  return skips ? Need::skip : Need::work;
}

double PairUpdate::stake(const PatchPair& pair, std::span<const Link> links) const {
  const Ends ends{tree_.root(pair.receiver).node_first, tree_.root(pair.source).node_first};
  const double F = links.empty() ? 0 : links.front().form_factor;
  return tree_.node(ends.receiver).area * energy(ends, F);
}

bool PairUpdate::update(const PatchPair& pair, std::span<const Link> old, std::vector<Link>& links) {
  const Root &receiver = tree_.root(pair.receiver), &source = tree_.root(pair.source);
  out_.clear();
  most_ = task_.most_links + std::min<std::uint64_t>(old.size(), ~task_.most_links);
  changed_ = false;
  if (!receiver.present || !source.present || pair.receiver == pair.source) {
    changed_ = !old.empty();
  } else if (old.empty()) {
    grow_roots({receiver.node_first, source.node_first});
    changed_ = true;
  } else {
    visit(old, nullptr, !only_refines() && (has_moved(receiver) || has_moved(source)));
  }
  if (changed_) links.assign(out_.begin(), out_.end());
  return changed_;
}

/// Of a link in the scene as it is. What is asked first is forgotten last: links above before those below.
const Sight& PairUpdate::sight_of(Above& link) {
  if (!link.now) {
    const auto [to, from] = link.ends;
    link.now = link.above == nullptr ? sight_.between_roots(to, from)
               : alone()             ? sight_.between_alone(to, from, sight_of(*link.above))
                                     : sight_.between(to, from, sight_of(*link.above));
  }
  return *link.now;
}

/// Whether what moved enters the shaft of a link now. What it does not enter of the link above counts where that is not
/// known, and of one that is blocked: so a descendant that found that changes nothing of what the next ones do.
bool PairUpdate::is_touched(const Above& link) {
  const auto [to, from] = link.ends;
  const Above* above = link.above;
  return above != nullptr && above->now && above->now->state != Sight::State::blocked
             ? sight_.touched(to, from, *above->now, changed_now_.items)
             : sight_.touched(to, from, changed_now_.items);
}

/// Appends to out_ what becomes of a link and its descendants. Of significant ones only, what enters a shaft is sought
/// when a link needs it whose value is found anew, of this link and of those above it.
void PairUpdate::visit(std::span<const Link> old, Above* above, bool renewed) {
  const Link& link = old.front();
  const bool root = above == nullptr;
  Above here{.above = above,
             .ends = {link.destination, link.source},
             .renewed = renewed || link.stale,
             .affected = !root && above->affected,
             .blocked = !root && above->blocked,
             .before = {},
             .now = {}};
  const Ends& ends = here.ends;

  const auto forget = [&] {
    if (here.now) sight_.forget(*here.now);
    if (here.before) sight_before_->forget(*here.before);
  };
  // form_factor: that of the link as it is, where it is known and larger than it was.
  const auto leave_stale = [&](std::optional<double> form_factor = {}) {
    Link& left = out_.emplace_back(link);
    left.stale = true;
    if (!link.ghost && !only_refines() && (renewed || receives_anew(link))) {
      left.raise(form_factor ? *form_factor : most_form_factor(ends));
      left.energy = energy(ends, left.form_factor);
    }
    copy(old.subspan(1));
    changed_ = true;
    ++work_.skipped;
    forget();
  };

  double F = link.form_factor;
  bool evaluate = false, may_change = false;  // its value; whether it is refined
  if (only_refines()) {
    if (!wants_change(old)) return renewed ? leave_stale() : copy(old);
    if (here.renewed) {  // what it was left as tells nothing
      F = sight_.form_factor(ends.receiver, ends.source);
      evaluate = changed_ = true;
    }
    if (link.open && !here.renewed) here.now = sight_.open();
    may_change = true;
  } else if (here.renewed) {
    if (only_significant() && !renewed && is_insignificant(link)) return leave_stale();
    changed_ = true;
    if (!face_each_other(ends)) return;
    const double Y = light(ends);
    if (only_significant() && !link.ghost && Y * link.transfer() < task_.B_eps) {
      if (most_energy(ends) < task_.B_eps) return leave_stale();
    }
    F = sight_.form_factor(ends.receiver, ends.source);
    const double most = std::max(energy(ends, F), Y * link.transfer());
    if (only_significant() && !link.ghost && most < task_.B_eps) return leave_stale(F);
    here.affected = evaluate = true;
    may_change = task_.scope != LinkScope::values;
  } else {
    const bool has_changed = task_.before != nullptr;
    const bool has_stale = task_.any_stale && std::ranges::any_of(old, [](const Link& l) { return l.stale; });
    if (!has_changed && !tests_all() && !has_stale) return copy(old);
    if (only_significant() && is_insignificant(link)) return leave_stale();
    const bool anew = receives_anew(link);
    if (has_changed && !here.blocked) {
      here.before =
          root || !alone()
              ? (root ? sight_before_->between_roots(ends.receiver, ends.source, changed_before_->items)
                      : sight_before_->between(ends.receiver, ends.source, above->before.value()))
              : sight_before_->between_alone(ends.receiver, ends.source, above->before.value(), changed_before_->items);
      if (here.before->state == Sight::State::blocked) here.before->state = Sight::State::partial;
    }
    const bool touched_before = here.before && here.before->count > 0;
    const bool judges = only_significant() && !link.ghost;
    bool touched = false;
    if (has_changed && !tests_all() && here.before && !has_stale && (judges || !touched_before)) {
      // Most shafts are not entered by what moved: that alone is asked first.
      touched = is_touched(here);
      if (!touched && !touched_before && !anew) {
        forget();
        return copy(old);
      }
    }
    if (judges && has_changed && (here.before || above->affected)) {
      // What moved in can only hide, what moved away only reveal.
      const double v = link.visibility;
      const double share = std::max(touched || !here.before ? v : 0, touched_before ? 1 - v : 0);
      if (share * energy(ends, F) < task_.B_eps && !anew) {
        if (share > kNothing) return leave_stale();
        forget();  // it brings what it did: nothing, or all of it
        return copy(old);
      }
    }
    const bool asks = !only_significant() || !link.ghost || has_stale;
    if (asks) touched = has_changed && touches_changed(sight_of(here));
    const bool below_blocked = !root && (here.blocked || is_blocked(above->now));
    here.affected = below_blocked ? above->affected : touched_before || touched || anew;
    may_change = task_.scope != LinkScope::values && here.affected;
    evaluate = tests_all() || here.affected;
    if (!evaluate && !has_stale) {
      forget();
      return copy(old);
    }
    if (tests_all() || anew) F = sight_.form_factor(ends.receiver, ends.source);
    changed_ = changed_ || evaluate;
  }

  if (!link.ghost) {
    const bool blocked = evaluate || may_change ? sight_of(here).state == Sight::State::blocked : link.blocked;
    if (may_change && divides(ends, link.code, blocked)) {
      changed_ = true;
      grow(ends, link.code, sight_of(here));
    } else if (evaluate) {
      work_.links_affected += here.affected || here.renewed;
      add_leaf(ends, link.code, F, sight_of(here));
    } else {
      copy(old);
    }
    return forget();
  }

  if (!only_significant()) sight_of(here);
  here.blocked = here.blocked || is_blocked(here.now);
  const std::size_t at = out_.size();
  const std::uint64_t skipped = work_.skipped;
  out_.push_back(link);
  const End end = *divided_end(ends, link.code);
  std::size_t next = 1;
  bool all_leaves = true;
  for (unsigned k = 0; k < 4; ++k) {
    const LinkCode code = link.code.descend(end, k);
    const Ends to = child(ends, end, k);
    const std::size_t child_at = out_.size();
    if (next < old.size() && old[next].code == code) {
      const std::span<const Link> of_child = old.subspan(next, old[next].next);
      next += of_child.size();
      visit(of_child, &here, here.renewed);
    } else if (here.renewed && face_each_other(to)) {
      const Sight sight = sight_.between(to.receiver, to.source, sight_of(here));
      grow(to, code, sight);
      sight_.forget(sight);
    }
    if (out_.size() > child_at) all_leaves = all_leaves && !out_[child_at].ghost;
  }
  if (evaluate) {
    const bool known = here.now || work_.skipped == skipped;  // else something may enter
    out_[at] = ghost(ends, link.code, F, known ? sight_of(here) : Sight{Sight::State::partial, 0, 0});
  }
  close(at);
  if (may_change && task_.scope != LinkScope::refinement && all_leaves && most_energy(ends) < task_.eps1) {
    out_.resize(at);
    add_leaf(ends, link.code, F, sight_of(here));
    changed_ = true;
    ++work_.unrefined;
  }
  forget();
}

/// Appends the links between two patches that had none.
void PairUpdate::grow_roots(const Ends& ends) {
  const Sight sight = sight_.between_roots(ends.receiver, ends.source);
  grow(ends, {}, sight);
  sight_.forget(sight);
}

/// Appends a new link and, where its energy asks for it, what it is refined to.
void PairUpdate::grow(const Ends& ends, LinkCode code, const Sight& sight) {
  if (out_.size() >= most_) refuse_more_links(task_);
  const double F = sight_.form_factor(ends.receiver, ends.source);
  if (!divides(ends, code, sight.state == Sight::State::blocked)) {
    ++work_.links_affected;
    return add_leaf(ends, code, F, sight);
  }
  ++work_.refined;
  const std::size_t at = out_.size();
  out_.push_back(ghost(ends, code, F, sight));
  const End end = *divided_end(ends, code);
  for (unsigned k = 0; k < 4; ++k) {
    const Ends to = child(ends, end, k);
    if (!face_each_other(to)) continue;
    const Sight of_child = sight_.between(to.receiver, to.source, sight);
    grow(to, code.descend(end, k), of_child);
    sight_.forget(of_child);
  }
  close(at);
}

/// Sets the extent and the energy of a ghost whose descendants have been appended.
void PairUpdate::close(std::size_t at) {
  out_[at].next = static_cast<std::uint32_t>(out_.size() - at);
  out_[at].energy = 0;
  for (std::size_t k = at + 1; k < out_.size(); k += out_[k].next)
    out_[at].energy = std::max(out_[at].energy, out_[k].energy);
}

Link PairUpdate::ghost(const Ends& ends, LinkCode code, double form_factor, const Sight& sight) const {
  Link link;
  link.code = code;
  link.source = ends.source;
  link.destination = ends.receiver;
  link.form_factor = form_factor;
  link.visibility = 1;
  link.ghost = true;
  link.open = sight.state == Sight::State::open;
  link.blocked = sight.state == Sight::State::blocked;
  return link;
}

void PairUpdate::add_leaf(const Ends& ends, LinkCode code, double form_factor, const Sight& sight) {
  Link link = ghost(ends, code, form_factor, sight);
  link.ghost = false;
  if (link.blocked || form_factor == 0) {
    link.visibility = 0;
  } else if (!link.open) {
    link.visibility = std::min(1.0, sight_.visible_form_factor(ends.receiver, ends.source, sight) / form_factor);
  }
  link.energy = energy(ends, form_factor);
  ++work_.links_updated;
  out_.push_back(link);
}

}  // namespace exitance
