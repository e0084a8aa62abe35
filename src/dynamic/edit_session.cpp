#include "src/dynamic/edit_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace exitance {
namespace {

using Clock = std::chrono::steady_clock;

void count(const DynamicShot& shot, SessionWork& work) {
  switch (shot.kind) {
    case DynamicShot::Kind::propagation:
      ++work.propagations;
      work.propagation += shot.work;
      return;
    case DynamicShot::Kind::redistribution:
      ++work.redistributions;
      work.redistribution += shot.work;
      return;
    case DynamicShot::Kind::gathering:
      ++work.gatherings;
      work.gathering += shot.work;
  }
}

}  // namespace

EditSession::EditSession(Scene scene, const SessionOptions& options)
    : scene_(std::move(scene)),
      base_(std::make_shared<SceneVersion>(scene_, options.mesh), scene_.scene(), options.column_memory) {
  set_options(options);
}

EditSession::EditSession(const EditSession& other, const SessionOptions& options) : EditSession(other) {
  set_options(options);
}

void EditSession::set_options(const SessionOptions& options) {
  options_ = options;
  if (!(options_.tolerance > 0)) throw std::invalid_argument("a session's tolerance must be positive");
  if (!(options_.threshold >= 0)) throw std::invalid_argument("a session's threshold must not be negative");
  if (options_.method == UpdateMethod::restart) options_.importance.kind = ImportanceOptions::Kind::total;
  base_.set_importance(options_.importance);
  if (shown_) shown_->set_importance(options_.importance);
}

std::string EditSession::name_of_edit(const Edit& edit) const {
  return fmt::format("{} {}", name_of(edit.operation), scene_.scene().objects[edit.object].name);
}

void EditSession::change_geometry(DynamicRadiosity& of, std::uint32_t object, const std::string& name) {
  if (!options_.log) of.forget_changes();
  of.change_geometry(std::make_shared<SceneVersion>(of.version(), scene_, options_.mesh, object), scene_.scene(),
                     object, name);
  if (versions_) versions_->push_back(of.shared_version());
}

/// The object that is taken out of the solution as it is selected. From scratch there is nothing to hold.
std::optional<std::uint32_t> EditSession::held() const {
  return options_.method == UpdateMethod::scratch ? std::nullopt : scene_.selected();
}

/// An object that is held, where it is now, in a copy of the solution without it.
void EditSession::open_temporary(std::uint32_t object) {
  shown_ = base_;
  change_geometry(*shown_, object, fmt::format("add {}", scene_.scene().objects[object].name));
}

void EditSession::apply(const Edit& edit) {
  const std::optional<std::uint32_t> held_before = held();
  const bool of_held = held_before == edit.object;
  if (edit.operation == Operation::select && of_held) return;
  const EditedScene::Effect effect = scene_.apply(edit);
  edited_ = edit.object;
  if (edit.operation == Operation::deselect || edit.operation == Operation::select) {
    if (held_before) {
      if (!shown_) open_temporary(*held_before);
      if (shown_) base_ = *std::exchange(shown_, std::nullopt);
    }
    if (!held()) return;
    // Taken out for now; where it stands is remembered by the scene.
    EditedScene with = scene_;
    scene_.apply({Operation::remove, edit.object, {}, {}, {}});
    change_geometry(base_, edit.object, name_of_edit({Operation::remove, edit.object, {}, {}, {}}));
    scene_ = std::move(with);
    return;
  }
  if (of_held) {
    shown_.reset();
    return;
  }
  if (options_.method == UpdateMethod::scratch && effect.geometry) base_.start_over();
  if (effect.geometry) change_geometry(base_, edit.object, name_of_edit(edit));
  if (effect.materials) base_.change_materials(scene_.scene(), edit.object);
  if (options_.method == UpdateMethod::scratch) base_.start_over();
}

/// Whether there is something to propagate; strongest: of the unshot energies.
bool EditSession::propagates(const DynamicRadiosity& of, double strongest) const {
  return strongest > 0 && of.error_bound() > options_.tolerance;
}

/// One shot, the one that comes next; false when nothing is left to do.
bool EditSession::step(DynamicRadiosity& of, SessionWork& work) {
  const auto propagate = [&](std::uint32_t patch) { count(of.propagate(patch), work); };
  const auto redistribute = [&](const DynamicRadiosity::StrongestChange& change) {
    const auto search = options_.method == UpdateMethod::restart ? VersionDifference::Search::everywhere
                                                                 : VersionDifference::Search::shadow_volumes;
    count(of.redistribute(change.change, change.patch, search), work);
  };
  if (edited_) {
    const auto emitter = of.strongest_of(*edited_);
    if (emitter.energy > 0 && of.pending_changes() > 0 && !of.has_shot(emitter.patch)) {
      propagate(emitter.patch);
      return true;
    }
  }
  const bool gathers = options_.object_terms == ObjectTerms::gathered && options_.method == UpdateMethod::redistribute;
  const std::uint32_t to_gather = gathers ? of.patches_to_gather() : 0;
  // Exact importance needs what is gathered: it is not asked for before.
  if (to_gather > 0 && options_.importance.kind == ImportanceOptions::Kind::exact) {
    count(of.gather(), work);
    return true;
  }
  const auto change = of.strongest_change();
  if (to_gather > 0) {
    if (change.energy * to_gather > change.of_all) {
      redistribute(change);
    } else {
      count(of.gather(), work);
    }
    return true;
  }
  const auto unshot = of.strongest();
  const bool can_propagate = propagates(of, unshot.energy);
  if (change.energy < 0 && !can_propagate) return false;
  const bool first = options_.strategy == Strategy::redistribute_first && change.energy >= 0 &&
                     change.energy >= options_.threshold * of.power_of_sources();
  if (first || !can_propagate || change.energy >= unshot.energy) {
    redistribute(change);
  } else {
    propagate(unshot.patch);
  }
  return true;
}

SessionWork EditSession::work(const Budget& budget, SessionWork so_far) {
  auto start = Clock::now();
  const double before = so_far.seconds;
  SessionWork work = std::move(so_far);
  const auto seconds = [&] { return before + std::chrono::duration<double>(Clock::now() - start).count(); };
  const std::optional<std::uint32_t> temporary = held();
  for (;;) {
    if (budget.shots && work.shots() >= *budget.shots) break;
    if (budget.seconds && seconds() >= *budget.seconds) break;
    if (temporary && !shown_) {
      const double left = base_.strongest_change().energy;
      if (left < 0 || left < options_.threshold * base_.power_of_sources()) open_temporary(*temporary);
    }
    if (!step(state(), work)) break;
    if (budget.after_shot) {
      work.seconds = seconds();
      const auto told = Clock::now();
      budget.after_shot(work);
      start += Clock::now() - told;
    }
    if (budget.interrupted && budget.interrupted()) {
      work.interrupted = true;
      break;
    }
  }
  if (temporary && !shown_) open_temporary(*temporary);
  // Whichever end came first: a budget of just so many shots finishes, too.
  work.finished = solution().pending_changes() == 0 && !propagates(solution(), propagation_left());
  work.seconds = seconds();
  return work;
}

void EditSession::write(ArchiveWriter& file, const std::string& prefix) const {
  const std::uint8_t is_shown = shown_.has_value();
  file.write(prefix + "is_shown", std::span(&is_shown, 1));
  base_.write(file, prefix + "base_");
  if (shown_) shown_->write(file, prefix + "shown_");
}

EditSession EditSession::taken_up(Scene scene, const SessionOptions& options, std::span<const Edit> edits,
                                  const ArchiveReader& file, const std::string& prefix) {
  EditSession session(std::move(scene), options);
  session.versions_.emplace({session.base_.shared_version()});
  for (const Edit& edit : edits) session.apply(edit);
  const std::vector<std::uint8_t> is_shown = file.uint8s(prefix + "is_shown");
  if (is_shown.size() != 1 || (is_shown[0] != 0 && !session.held())) file.refuse("no object is selected");
  if (is_shown[0] != 0) session.open_temporary(*session.held());
  session.base_.read(file, prefix + "base_", *session.versions_);
  if (session.shown_) session.shown_->read(file, prefix + "shown_", *session.versions_);
  session.versions_.reset();
  return session;
}

std::vector<PendingChange> EditSession::log() {
  std::vector<PendingChange> log;
  for (std::size_t k = 0; k < state().pending_changes(); ++k) log.push_back(state().pending(k));
  return log;
}

std::vector<double> EditSession::temporary_change() const {
  if (!shown_) return {};
  std::vector<double> change = shown_->element_B();
  const std::vector<double> without = base_.element_B();
  for (std::size_t i = 0; i < without.size(); ++i) change[i] -= without[i];
  return change;
}

double EditSession::redistribution_left() {
  return std::max(0.0, state().strongest_change().energy);
}

}  // namespace exitance
