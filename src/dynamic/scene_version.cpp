#include "src/dynamic/scene_version.h"

#include <algorithm>
#include <utility>

#include "src/scene/sample_site.h"
#include "src/scene/scene_soup.h"

namespace exitance {
namespace {

Contacts contacts_of(const PolygonSoup& soup, const PolygonSoup& before, const Contacts& contacts_before) {
  return soup.shares_with(before) ? Contacts(contacts_before, soup) : Contacts(soup);
}

}  // namespace

SceneVersion::SceneVersion(const EditedScene& scene, const MeshOptions& options)
    : soup_(make_soup(scene, objects_of(scene))),
      mesh_(make_patch_mesh(scene.scene(), soup_, options)),
      visibility_(mesh_, soup_),
      slots_(scene.scene().objects.size()),
      observers_([this] { return visibility_.observer(); }),
      sights_([this] { return std::make_unique<PatchSight>(mesh_, soup_, visibility_.contacts()); }) {
  std::uint32_t patch = 0;
  for (std::uint32_t object = 0; object < slots_.size(); ++object) {
    ObjectSlot& slot = slots_[object];
    slot.present = scene.is_present(object);
    slot.patch_first = patch;
    slot.element_first = patch < mesh_.patches.size() ? mesh_.patches[patch].element_first
                                                      : static_cast<std::uint32_t>(mesh_.elements.size());
    const EditedScene::Range surfaces = scene.surfaces_of(object);
    while (patch < mesh_.patches.size() && mesh_.patches[patch].surface < surfaces.last) {
      slot.element_count += mesh_.patches[patch].element_count;
      ++patch;
    }
    slot.patch_count = patch - slot.patch_first;
  }
  place_objects(scene, true);
  for (ObjectSlot& slot : slots_) find_box(slot);
  find_objects();
  index_elements();
}

SceneVersion::SceneVersion(const SceneVersion& before, const EditedScene& scene, const MeshOptions& options,
                           std::uint32_t object)
    : serial_(before.serial_ + 1),
      soup_(soup_after(before.soup_,
                       before.slots_[object].present ? before.slots_[object].polygons : PolygonSoup::PolygonRange{},
                       scene, object, objects_of(scene))),
      visibility_(mesh_, soup_, contacts_of(soup_, before.soup_, before.visibility_.contacts())),
      slots_(before.slots_),
      observers_([this] { return visibility_.observer(); }),
      sights_([this] { return std::make_unique<PatchSight>(mesh_, soup_, visibility_.contacts()); }) {
  const EditedScene::Range surfaces = scene.surfaces_of(object);
  slots_[object].present = scene.is_present(object);
  ++slots_[object].pose;
  const bool shares = soup_.shares_with(before.soup_);
  if (shares) slots_[object].polygons = soup_.arrived();
  place_objects(scene, !shares);
  find_box(slots_[object]);
  const PatchMesh own =
      make_patch_mesh(scene.scene(), soup_, options, surfaces.first, surfaces.last, slots_[object].polygons.first);
  object_of_patch_ = before.object_of_patch_;
  const bool fits = !slots_[object].present || (own.patches.size() == slots_[object].patch_count &&
                                                own.elements.size() == slots_[object].element_count);
  take_others(before, object);
  if (slots_[object].present) {
    ObjectSlot& slot = slots_[object];
    if (!fits) {
      slot.present = false;
      find_object(object);
      slot.present = true;
      slot.patch_first = static_cast<std::uint32_t>(mesh_.patches.size());
      slot.element_first = static_cast<std::uint32_t>(mesh_.elements.size());
      slot.patch_count = static_cast<std::uint32_t>(own.patches.size());
      slot.element_count = static_cast<std::uint32_t>(own.elements.size());
      mesh_.patches.resize(mesh_.patches.size() + own.patches.size());
      mesh_.elements.resize(mesh_.elements.size() + own.elements.size());
    }
    take_block(own, 0, 0, 0, slot);
  }
  find_object(object);
  element_index_ = before.element_index_;
  resampled_ = before.resampled_;
  choose_samples(before, object);
  std::size_t elsewhere = 0;
  for (std::uint32_t k = 0; k < slots_.size(); ++k) {
    if (slots_[k].present && !is_indexed(k)) elsewhere += slots_[k].element_count;
  }
  if (4 * elsewhere > mesh_.elements.size()) index_elements();
}

/// All numbers as they were, then the pieces and points of what is there but the object. As long as the soup's numbers
/// last, those of what is gone stay, too.
void SceneVersion::take_others(const SceneVersion& before, std::uint32_t object) {
  if (soup_.shares_with(before.soup_)) {
    mesh_ = before.mesh_;
    const ObjectSlot& own = before.slots_[object];
    for (std::uint32_t p = own.patch_first; p < own.patch_first + own.patch_count; ++p)
      mesh_.patches[p].piece_first = mesh_.patches[p].piece_count = 0;
    for (std::uint32_t e = own.element_first; e < own.element_first + own.element_count; ++e)
      mesh_.elements[e].piece_first = mesh_.elements[e].piece_count = 0;
    for (std::uint32_t k = 0; k < slots_.size(); ++k) {
      const std::uint32_t offset = slots_[k].surface_first - before.slots_[k].surface_first;
      if (k == object || !slots_[k].present || offset == 0) continue;
      for (std::uint32_t p = 0; p < slots_[k].patch_count; ++p)
        mesh_.patches[slots_[k].patch_first + p].surface += offset;
    }
    return;
  }
  mesh_.patches = before.mesh_.patches;
  mesh_.elements = before.mesh_.elements;
  for (Patch& patch : mesh_.patches) patch.piece_first = patch.piece_count = 0;
  for (Element& element : mesh_.elements) element.piece_first = element.piece_count = 0;
  for (std::uint32_t k = 0; k < slots_.size(); ++k) {
    if (k == object || !slots_[k].present) continue;
    const ObjectSlot& old = before.slots_[k];
    take_block(before.mesh_, old.patch_first, slots_[k].facet_first - old.facet_first,
               slots_[k].surface_first - old.surface_first, slots_[k]);
  }
}

/// Copies the patches of an object from a mesh in which they begin at patch_first; its facets and surfaces are numbered
/// higher by the offsets (modulo 2^32) here than there.
void SceneVersion::take_block(const PatchMesh& from, std::uint32_t patch_first, std::uint32_t facet_offset,
                              std::uint32_t surface_offset, const ObjectSlot& slot) {
  if (slot.patch_count == 0) return;
  const std::uint32_t element_there = from.patches[patch_first].element_first;
  const auto take_loop = [&](std::uint32_t first, std::uint32_t count) {
    const auto here = static_cast<std::uint32_t>(mesh_.points.size());
    mesh_.points.append(from.points.begin() + first, from.points.begin() + first + count);
    return here;
  };
  const auto take_pieces = [&](std::uint32_t first, std::uint32_t count) {
    const auto here = static_cast<std::uint32_t>(mesh_.pieces.size());
    for (std::uint32_t k = first; k < first + count; ++k) {
      PatchPiece piece = from.pieces[k];
      piece.facet += facet_offset;
      piece.loop_first = take_loop(piece.loop_first, piece.loop_count);
      mesh_.pieces.push_back(piece);
    }
    return here;
  };
  for (std::uint32_t p = 0; p < slot.patch_count; ++p) {
    Patch patch = from.patches[patch_first + p];
    patch.surface += surface_offset;
    patch.element_first = patch.element_first - element_there + slot.element_first;
    patch.piece_first = take_pieces(patch.piece_first, patch.piece_count);
    mesh_.patches[slot.patch_first + p] = patch;
  }
  for (std::uint32_t e = 0; e < slot.element_count; ++e) {
    Element element = from.elements[element_there + e];
    element.patch = element.patch - patch_first + slot.patch_first;
    element.facet += facet_offset;
    element.piece_first = take_pieces(element.piece_first, element.piece_count);
    element.loop_first = take_loop(element.loop_first, element.loop_count);
    mesh_.elements[slot.element_first + e] = element;
  }
}

/// Where objects are in the scene and in the soup.
void SceneVersion::place_objects(const EditedScene& scene, bool soup_is_new) {
  for (std::uint32_t object = 0; object < slots_.size(); ++object) {
    ObjectSlot& slot = slots_[object];
    const EditedScene::Range surfaces = scene.surfaces_of(object);
    slot.surface_first = surfaces.first;
    if (soup_is_new) slot.polygons = {surfaces.first, surfaces.last};
    slot.facet_first = soup_.first_facet(slot.polygons.first);
    slot.facet_last = soup_.first_facet(slot.polygons.last);
  }
}

void SceneVersion::find_box(ObjectSlot& slot) const {
  slot.box = slot.present ? facet_range(soup_, slot.facet_first, slot.facet_last).box : Box{};
}

std::vector<FacetRange> SceneVersion::facet_ranges() const {
  std::vector<FacetRange> ranges(slots_.size());
  for (std::size_t object = 0; object < slots_.size(); ++object) {
    const ObjectSlot& slot = slots_[object];
    if (slot.present) ranges[object] = {slot.facet_first, slot.facet_last, slot.box};
  }
  return ranges;
}

std::uint32_t SceneVersion::object_of_facet(std::uint32_t facet) const {
  const auto holds = [&](const ObjectSlot& slot) {
    return slot.present && slot.facet_first <= facet && facet < slot.facet_last;
  };
  const auto slot = std::ranges::find_if(slots_, holds);
  return slot == slots_.end() ? kVoid : static_cast<std::uint32_t>(slot - slots_.begin());
}

void SceneVersion::find_objects() {
  for (std::uint32_t object = 0; object < slots_.size(); ++object) find_object(object);
}

/// The patches' numbers are the object's, or nobody's while it is not there.
void SceneVersion::find_object(std::uint32_t object) {
  object_of_patch_.resize(mesh_.patches.size());
  const ObjectSlot& slot = slots_[object];
  for (std::uint32_t p = slot.patch_first; p < slot.patch_first + slot.patch_count; ++p)
    object_of_patch_[p] = slot.present ? object + 1 : 0;
}

/// Of the elements that the object has come near to, or left.
void SceneVersion::choose_samples(const SceneVersion& before, std::uint32_t object) {
  SampleSite site(soup_);
  const bool all = soup_.extent() != before.soup_.extent();
  const double reach = site.reach();
  const auto grown = [&](Box box) {
    if (box.lower.x > box.upper.x) return box;
    box.lower = box.lower - Vec3{reach, reach, reach};
    box.upper = box.upper + Vec3{reach, reach, reach};
    return box;
  };
  const Box was = grown(before.slots_[object].box), is = grown(slots_[object].box);
  std::vector<std::uint32_t> patches;
  if (!all) {
    element_index_->patches.find(was, patches);
    element_index_->patches.find(is, patches);
    std::erase_if(patches,
                  [&](std::uint32_t p) { return object_of_patch(p) == kVoid || !is_indexed(object_of_patch(p)); });
  }
  for (std::uint32_t k = 0; k < slots_.size(); ++k) {
    if (!slots_[k].present || (!all && is_indexed(k))) continue;
    for (std::uint32_t p = 0; p < slots_[k].patch_count; ++p) patches.push_back(slots_[k].patch_first + p);
  }
  std::ranges::sort(patches);
  patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
  const PatchMesh& mesh = mesh_;
  for (const std::uint32_t p : patches) {
    if (object_of_patch(p) == object) continue;
    const Box box = box_of_patch(p);
    if (!all && !box.overlaps(was) && !box.overlaps(is)) continue;
    const Patch patch = mesh.patches[p];
    for (std::uint32_t e = patch.element_first; e < patch.element_first + patch.element_count; ++e) {
      const Vec3 sample = site.choose(mesh, mesh.elements[e]);
      if (sample == mesh.elements[e].sample) continue;
      mesh_.elements[e].sample = sample;
      auto at = std::ranges::lower_bound(resampled_, e, {}, &Resampled::element);
      if (at == resampled_.end() || at->element != e) at = resampled_.insert(at, {e, 0});
      at->serial = serial_;
    }
  }
}

std::vector<std::uint32_t> SceneVersion::resampled_since(const SceneVersion& other) const {
  std::vector<std::uint32_t> found;
  for (const Resampled& r : resampled_) {
    if (has_element(r.element) && same_in(other, object_of_element(r.element)) &&
        mesh_.elements[r.element].sample != other.mesh_.elements[r.element].sample)
      found.push_back(r.element);
  }
  return found;
}

Box SceneVersion::box_of_patch(std::uint32_t patch) const {
  Box box;
  for (const PatchPiece& piece : mesh_.pieces_of(mesh_.patches[patch])) {
    if (piece.loop_count == 0) box.extend(soup_.box_of(piece.facet));
    for (const Vec3& corner : mesh_.loop(piece)) box.extend(corner);
  }
  return box;
}

void SceneVersion::index_elements() {
  const PatchMesh& mesh = mesh_;
  std::vector<Box> samples(mesh.elements.size()), patches(mesh.patches.size());
  for (std::uint32_t e = 0; e < samples.size(); ++e) {
    if (object_of_element(e) != kVoid) samples[e].extend(mesh.elements[e].sample);
  }
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    if (object_of_patch(p) != kVoid) patches[p] = box_of_patch(p);
  }
  element_index_ =
      std::make_shared<const ElementIndex>(ElementIndex{SpatialIndex(samples), SpatialIndex(patches), slots_, serial_});
}

void SceneVersion::find_elements(std::span<const HalfSpace> region, std::vector<std::uint32_t>& found) const {
  const auto lies_in = [&](std::uint32_t e) {
    return std::ranges::all_of(region,
                               [&](const HalfSpace& h) { return dot(h.normal, mesh_.elements[e].sample) >= h.offset; });
  };
  const std::size_t first = found.size();
  element_index_->samples.find(region, element_index_->samples.bounds(), found);
  const auto moved = [&](std::uint32_t e) {
    const std::uint32_t object = object_of_element(e);
    return object == kVoid || !is_indexed(object);
  };
  found.erase(std::remove_if(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(), moved), found.end());
  for (const Resampled& r : resampled_) {
    if (r.serial > element_index_->serial && !moved(r.element) && lies_in(r.element)) found.push_back(r.element);
  }
  for (std::uint32_t k = 0; k < slots_.size(); ++k) {
    const ObjectSlot& slot = slots_[k];
    if (!slot.present || is_indexed(k)) continue;
    for (std::uint32_t e = slot.element_first; e < slot.element_first + slot.element_count; ++e) {
      if (lies_in(e)) found.push_back(e);
    }
  }
}

std::size_t SceneVersion::present_patches() const {
  std::size_t count = 0;
  for (const ObjectSlot& slot : slots_) count += slot.present ? slot.patch_count : 0;
  return count;
}

std::size_t SceneVersion::present_elements() const {
  std::size_t count = 0;
  for (const ObjectSlot& slot : slots_) count += slot.present ? slot.element_count : 0;
  return count;
}

std::vector<std::uint32_t> SceneVersion::changed_since(const SceneVersion& other) const {
  std::vector<std::uint32_t> changed;
  for (std::uint32_t object = 0; object < slots_.size(); ++object) {
    const bool absent = !slots_[object].present && !other.slots_[object].present;
    if (!absent && !same_in(other, object)) changed.push_back(object);
  }
  return changed;
}

PointRow SceneVersion::row(std::uint32_t element) const {
  return observers_.local()->row(element);
}

}  // namespace exitance
