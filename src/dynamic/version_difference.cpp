#include "src/dynamic/version_difference.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "src/dynamic/form_factor_column.h"

namespace exitance {
namespace {

/// The patch's pieces as shooters of one shadow volume after the other: what of the patch's light an element loses.
class PatchShade {
 public:
  PatchShade(const SceneVersion& version, const std::vector<std::unique_ptr<ShadowCaster>>& casters)
      : version_(version), casters_(casters) {}

  void set_patch(std::uint32_t patch) {
    if (patch == patch_) return;
    patch_ = patch;
    const auto pieces = version_.mesh().pieces_of(version_.mesh().patches[patch]);
    while (volumes_.size() < pieces.size() * casters_.size())
      volumes_.push_back(std::make_unique<ShadowVolume>(*casters_[volumes_.size() % casters_.size()]));
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      for (std::size_t c = 0; c < casters_.size(); ++c)
        volumes_[k * casters_.size() + c]->set_shooter({pieces[k].facet, version_.mesh().loop(pieces[k])});
    }
    pieces_ = pieces.size();
  }

  /// Outside: no object hides anything of any piece. Umbra: every piece is hidden as a whole by one of them.
  /// So it is, too, where one of the screens, items of the index that stay as they are, hides what the object would.
  Shade of(std::uint32_t element, std::span<const std::uint32_t> screens) {
    const Element& e = version_.mesh().elements[element];
    const Receiver receiver{e.sample, e.normal, e.facet};
    bool some = false, all = !casters_.empty();
    for (std::size_t k = 0; k < pieces_; ++k) {
      Shade most = Shade::outside;
      for (std::size_t c = 0; c < casters_.size() && most != Shade::umbra; ++c)
        most = std::max(most, volumes_[k * casters_.size() + c]->at(receiver, screens));
      some = some || most != Shade::outside;
      all = all && most == Shade::umbra;
    }
    return !some ? Shade::outside : all ? Shade::umbra : Shade::penumbra;
  }

  /// Appends what may not be outside.
  void find_elements(std::vector<std::uint32_t>& found) const {
    for (std::size_t k = 0; k < pieces_ * casters_.size(); ++k)
      version_.find_elements(volumes_[k]->covers_shooter() ? std::span<const HalfSpace>{} : volumes_[k]->region(),
                             found);
  }

 private:
  const SceneVersion& version_;
  const std::vector<std::unique_ptr<ShadowCaster>>& casters_;
  std::uint32_t patch_ = SceneVersion::kVoid;
  std::size_t pieces_ = 0;
  std::vector<std::unique_ptr<ShadowVolume>> volumes_;  ///< [piece][caster]
};

/// Whether something hides all of a patch from a sample point by itself, in the later version.
class Screens {
 public:
  explicit Screens(const SceneVersion& version) : version_(version), shaft_(version.soup()) {}

  /// items: of the soup's index.
  bool hide(std::uint32_t patch, std::uint32_t element, std::span<const std::uint32_t> items) {
    const Element& e = version_.mesh().elements[element];
    for (const PatchPiece& piece : version_.mesh().pieces_of(version_.mesh().patches[patch])) {
      shaft_.reset({e.sample, e.normal, e.facet}, {piece.facet, version_.mesh().loop(piece)});
      if (!shaft_.is_empty() && std::ranges::none_of(items, [&](std::uint32_t item) { return blocks(item); }))
        return false;
    }
    return true;
  }

 private:
  bool blocks(std::uint32_t item) {
    const auto facets = static_cast<std::uint32_t>(version_.soup().facets().size());
    return item < facets ? shaft_.blocks(item) : shaft_.blocks(version_.soup().shells()[item - facets]);
  }

  const SceneVersion& version_;
  PointShaft shaft_;
};

double entry(const FormFactorColumn& column, std::uint32_t element) {
  const auto at = std::ranges::lower_bound(column.element, element);
  return at != column.element.end() && *at == element ? column.F[static_cast<std::size_t>(at - column.element.begin())]
                                                      : 0.0;
}

bool is_of(const SceneVersion& version, std::span<const std::uint32_t> objects, std::uint32_t facet) {
  return std::ranges::any_of(objects, [&](std::uint32_t object) {
    const ObjectSlot& slot = version.slot(object);
    return slot.present && slot.facet_first <= facet && facet < slot.facet_last;
  });
}

std::uint32_t facet_of(const PolygonSoup& soup, std::uint32_t item) {
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  return item < facets ? item : soup.shells()[item - facets].facets.front();
}

/// Whether some of an item of the index is of the objects: several may close a solid together.
bool has_any_of(const SceneVersion& version, std::span<const std::uint32_t> objects, std::uint32_t item) {
  const auto facets = static_cast<std::uint32_t>(version.soup().facets().size());
  if (item < facets) return is_of(version, objects, item);
  return std::ranges::any_of(version.soup().shells()[item - facets].facets,
                             [&](std::uint32_t f) { return is_of(version, objects, f); });
}

/// An item of one version's index in that of another, of objects that are the same in both; `changed`: the others.
std::uint32_t same_item(const SceneVersion& in, std::uint32_t item, const SceneVersion& other,
                        std::span<const std::uint32_t> changed) {
  const std::uint32_t facet = facet_of(in.soup(), item);
  for (std::uint32_t object = 0; object < in.objects(); ++object) {
    const ObjectSlot &slot = in.slot(object), &there = other.slot(object);
    if (!slot.present || facet < slot.facet_first || facet >= slot.facet_last) continue;
    const PolygonSoup& soup = other.soup();
    const std::uint32_t same = facet - slot.facet_first + there.facet_first, shell = soup.facets()[same].shell;
    // Beside a new neighbour a solid may be one no longer, or be closed by it; the facet is there all the same.
    const auto there_too = static_cast<std::uint32_t>(soup.facets().size()) + shell;
    const bool is_shell =
        item != facet && shell != kNone && soup.shells()[shell].convex && !has_any_of(other, changed, there_too);
    return is_shell ? there_too : same;
  }
  return item;
}

}  // namespace

struct VersionDifference::Scratch {
  explicit Scratch(const VersionDifference& d)
      : before(*d.before_, d.old_), after(*d.after_, d.new_), screens(*d.after_) {}

  PatchShade before, after;
  Screens screens;
  std::vector<std::uint32_t> stays, stays_before;  ///< items of either index that stand between and do not change
};

VersionDifference::VersionDifference(std::shared_ptr<const SceneVersion> before,
                                     std::shared_ptr<const SceneVersion> after)
    : before_(std::move(before)),
      after_(std::move(after)),
      objects_(after_->changed_since(*before_)),
      resampled_(after_->resampled_since(*before_)),
      scratch_([this] { return std::make_unique<Scratch>(*this); }) {
  const auto add = [](const SceneVersion& version, std::uint32_t object, auto& casters) {
    const ObjectSlot& slot = version.slot(object);
    if (slot.present)
      casters.push_back(std::make_unique<ShadowCaster>(version.soup(), slot.facet_first, slot.facet_last));
  };
  for (const std::uint32_t object : objects_) {
    add(*before_, object, old_);
    add(*after_, object, new_);
  }
}

VersionDifference::~VersionDifference() = default;

bool VersionDifference::keeps(std::uint32_t patch) const {
  const std::uint32_t object = before_->object_of_patch(patch);
  return object != SceneVersion::kVoid && after_->same_in(*before_, object);
}

/// Elements that stay and may lie in a shadow; those of changed objects, and those whose sample points have made way.
void VersionDifference::find_candidates(std::uint32_t patch, std::vector<std::uint32_t>& found) const {
  Scratch& scratch = *scratch_.local();
  scratch.before.set_patch(patch);
  scratch.after.set_patch(patch);
  scratch.before.find_elements(found);
  scratch.after.find_elements(found);
  std::erase_if(found, [&](std::uint32_t e) {
    return !after_->has_element(e) || !after_->same_in(*before_, after_->object_of_element(e));
  });
  for (const std::uint32_t object : objects_) {
    const ObjectSlot& slot = after_->slot(object);
    if (!slot.present) continue;
    for (std::uint32_t e = 0; e < slot.element_count; ++e) found.push_back(slot.element_first + e);
  }
  found.insert(found.end(), resampled_.begin(), resampled_.end());
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

/// Elements of one patch, whose numbers stand in `changes`.
void VersionDifference::compare(std::uint32_t receiver, std::uint32_t patch, Search search,
                                const FormFactorColumn* known, const ObjectRows& rows, Scratch& scratch,
                                std::span<FormFactorChange> changes, ChangeWork& work) const {
  const bool stays = after_->same_in(*before_, after_->object_of_patch(receiver)), kept = keeps(patch);
  if (kept && stays && search == Search::shadow_volumes)
    return compare_in_shadow(receiver, patch, known, scratch, changes, work);
  const auto look = [&](const SceneVersion& version, double FormFactorChange::*F) {
    PatchSight& sight = version.sight();
    sight.set(receiver, patch);
    if (!sight.sees()) return;
    for (FormFactorChange& c : changes) {
      // Much of a changed object lies behind another part of it: that is told sooner than what is left of the patch.
      if (!stays && scratch.screens.hide(patch, c.element, sight.between())) continue;
      const PointFormFactor f = sight.form_factor(c.element);
      c.*F = f.F;
      c.error += f.error;
      ++c.tests;
    }
  };
  if (stays && known != nullptr) {
    for (FormFactorChange& c : changes) c.before = entry(*known, c.element);
  } else if (stays) {
    look(*before_, &FormFactorChange::before);
  }
  if (!kept) return;
  if (rows.has(changes.front().element)) {
    for (FormFactorChange& c : changes) c.after = rows.F(c.element, patch);
  } else {
    look(*after_, &FormFactorChange::after);
  }
}

void VersionDifference::compare_in_shadow(std::uint32_t receiver, std::uint32_t patch, const FormFactorColumn* known,
                                          Scratch& scratch, std::span<FormFactorChange> changes,
                                          ChangeWork& work) const {
  PatchSight &sight_before = before_->sight(), &sight_after = after_->sight();
  scratch.before.set_patch(patch);
  scratch.after.set_patch(patch);
  bool looks = false, looked_before = false;
  const auto look = [&] {
    if (std::exchange(looks, true)) return;
    sight_after.set(receiver, patch);
    scratch.stays.clear();
    scratch.stays_before.clear();
    for (const std::uint32_t item : sight_after.between()) {
      if (has_any_of(*after_, objects_, item)) continue;
      scratch.stays.push_back(item);
      scratch.stays_before.push_back(same_item(*after_, item, *before_, objects_));
    }
  };
  const auto F = [&](PatchSight& sight, FormFactorChange& c, Shade shade) {
    if (shade == Shade::umbra || !sight.sees()) return 0.0;
    ++c.tests;
    const PointFormFactor f = sight.form_factor(c.element);
    c.error += f.error;
    return f.F;
  };
  const auto look_before = [&](FormFactorChange& c, Shade shade) {
    if (known != nullptr) return;
    if (!std::exchange(looked_before, true)) sight_before.set(receiver, patch);
    c.before = F(sight_before, c, shade);
  };
  for (FormFactorChange& c : changes) {
    ++work.candidates;
    if (std::ranges::binary_search(resampled_, c.element)) {
      if (known != nullptr) c.before = entry(*known, c.element);
      look();
      look_before(c, Shade::penumbra);
      c.after = F(sight_after, c, Shade::penumbra);
      continue;
    }
    // The objects by themselves first, as that is soon done.
    Shade was = scratch.before.of(c.element, {}), is = scratch.after.of(c.element, {});
    if (was == Shade::outside && is == Shade::outside) continue;
    if (was == Shade::umbra && is == Shade::umbra) {
      ++work.kept;
      continue;
    }
    if (known != nullptr) c.before = entry(*known, c.element);
    // Where no old shape hides anything new ones can only take: what is not seen before is not seen after; and the
    // other way round.
    if (known != nullptr && was == Shade::outside && c.before == 0) continue;  // 0 after, too
    look();
    if (!scratch.stays.empty()) {
      if (was != Shade::outside) was = scratch.before.of(c.element, scratch.stays_before);
      if (is != Shade::outside) is = scratch.after.of(c.element, scratch.stays);
      if ((was == Shade::outside && is == Shade::outside) || scratch.screens.hide(patch, c.element, scratch.stays)) {
        c.after = c.before;
        continue;
      }
    }
    if (is == Shade::outside && known == nullptr) {
      c.after = F(sight_after, c, is);
      if (c.after > 0) look_before(c, was);
    } else {
      look_before(c, was);
      if (was != Shade::outside || c.before > 0) c.after = F(sight_after, c, is);
    }
  }
}

std::vector<FormFactorChange> VersionDifference::column(std::uint32_t patch, Search search,
                                                        const FormFactorColumn* known, const ObjectRows& rows,
                                                        ChangeWork& work) const {
  std::vector<std::uint32_t> elements;
  if (search == Search::everywhere || !keeps(patch)) {
    for (std::uint32_t e = 0; e < after_->elements(); ++e) {
      if (after_->has_element(e)) elements.push_back(e);
    }
  } else {
    find_candidates(patch, elements);
  }
  std::vector<FormFactorChange> changes(elements.size());
  std::vector<std::size_t> first;  // of each patch's elements
  const auto patch_of = [&](std::size_t k) { return after_->mesh().elements[elements[k]].patch; };
  for (std::size_t k = 0; k < elements.size(); ++k) {
    changes[k].element = elements[k];
    if (k == 0 || patch_of(k) != patch_of(k - 1)) first.push_back(k);
  }
  const std::size_t patches = first.size();
  first.push_back(elements.size());
  std::vector<ChangeWork> works(patches);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, patches, 4), [&](const auto& some) {
    Scratch& scratch = *scratch_.local();
    for (std::size_t k = some.begin(); k < some.end(); ++k) {
      compare(patch_of(first[k]), patch, search, known, rows, scratch,
              std::span(changes).subspan(first[k], first[k + 1] - first[k]), works[k]);
    }
  });
  for (const ChangeWork& w : works) work += w;
  for (std::size_t k = 0; k < patches; ++k) {
    std::uint64_t tests = 0;
    bool idle = true;
    for (std::size_t i = first[k]; i < first[k + 1]; ++i) {
      const FormFactorChange& c = changes[i];
      tests += c.tests;
      // Equal but for rounding: what they differ by is less than they may be wrong by, of which one alone may be known.
      if (std::abs(c.after - c.before) <= 2 * c.error) {
        work.idle_tests += c.tests;
      } else {
        idle = false;
      }
    }
    work.visibility_tests += tests;
    if (idle) work.idle_patch_tests += tests;
  }
  std::erase_if(changes, [](const FormFactorChange& c) { return c.before == c.after; });
  return changes;
}

}  // namespace exitance
