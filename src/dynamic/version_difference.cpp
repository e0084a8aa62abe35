#include "src/dynamic/version_difference.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

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
  Shade of(std::uint32_t element) {
    const Element& e = version_.mesh().elements[element];
    const Receiver receiver{e.sample, e.normal, e.facet};
    bool some = false, all = !casters_.empty();
    for (std::size_t k = 0; k < pieces_; ++k) {
      Shade most = Shade::outside;
      for (std::size_t c = 0; c < casters_.size() && most != Shade::umbra; ++c)
        most = std::max(most, volumes_[k * casters_.size() + c]->at(receiver));
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

}  // namespace

struct VersionDifference::Scratch {
  PatchShade before, after;
};

VersionDifference::VersionDifference(std::shared_ptr<const SceneVersion> before,
                                     std::shared_ptr<const SceneVersion> after)
    : before_(std::move(before)), after_(std::move(after)), objects_(after_->changed_since(*before_)),
      scratch_([this] {
        return std::make_unique<Scratch>(Scratch{PatchShade(*before_, old_), PatchShade(*after_, new_)});
      }) {
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

/// Elements that stay and may lie in a shadow; those of changed objects.
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
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

void VersionDifference::evaluate(std::uint32_t element, std::uint32_t patch, Search search, Scratch& scratch,
                                 FormFactorChange& change, ChangeWork& work) const {
  change.element = element;
  const auto F = [&](const SceneVersion& version) {
    if (version.faces_away(element, patch)) return 0.0;
    ++work.visibility_tests;
    const PointFormFactor f = version.form_factor(element, patch);
    change.error += f.error;
    return f.F;
  };
  const bool stays = after_->same_in(*before_, after_->object_of_element(element));
  if (!keeps(patch)) {
    if (stays) change.before = F(*before_);
  } else if (!stays) {
    change.after = F(*after_);
  } else if (search == Search::everywhere) {
    change.before = F(*before_);
    change.after = F(*after_);
  } else {
    if (after_->faces_away(element, patch)) return;
    ++work.candidates;
    scratch.before.set_patch(patch);
    scratch.after.set_patch(patch);
    const Shade was = scratch.before.of(element), is = scratch.after.of(element);
    if (was == Shade::outside && is == Shade::outside) return;
    if (was == Shade::umbra && is == Shade::umbra) {
      ++work.kept;
      return;
    }
    // Where no old shape hides anything new ones can only take: what is not seen before is not seen after; and the
    // other way round.
    if (was == Shade::outside) {
      change.before = F(*before_);
      if (is != Shade::umbra && change.before > 0) change.after = F(*after_);
    } else if (is == Shade::outside) {
      change.after = F(*after_);
      if (was != Shade::umbra && change.after > 0) change.before = F(*before_);
    } else {
      if (was != Shade::umbra) change.before = F(*before_);
      if (is != Shade::umbra) change.after = F(*after_);
    }
  }
}

std::vector<FormFactorChange> VersionDifference::column(std::uint32_t patch, Search search, ChangeWork& work) const {
  std::vector<std::uint32_t> elements;
  if (search == Search::everywhere || !keeps(patch)) {
    for (std::uint32_t e = 0; e < after_->elements(); ++e) {
      if (after_->has_element(e)) elements.push_back(e);
    }
  } else {
    find_candidates(patch, elements);
  }
  std::vector<FormFactorChange> changes(elements.size());
  std::vector<ChangeWork> works(elements.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, elements.size(), 16), [&](const auto& some) {
    Scratch& scratch = *scratch_.local();
    for (std::size_t k = some.begin(); k < some.end(); ++k)
      evaluate(elements[k], patch, search, scratch, changes[k], works[k]);
  });
  for (std::size_t k = 0; k < works.size(); ++k) {
    const FormFactorChange& c = changes[k];
    // Equal but for rounding: what they differ by is less than they may be wrong by.
    const bool equal = std::abs(c.after - c.before) <= c.error;
    if (equal) works[k].idle_tests = works[k].visibility_tests;
    work += works[k];
  }
  std::erase_if(changes, [](const FormFactorChange& c) { return c.before == c.after; });
  return changes;
}

}  // namespace exitance
