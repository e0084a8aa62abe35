#include "src/dynamic/scene_version.h"

#include <algorithm>
#include <utility>

namespace exitance {

SceneVersion::SceneVersion(const EditedScene& scene, const MeshOptions& options)
    : soup_(make_soup(scene.scene())),
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
  find_facets(scene);
  find_objects();
  index_elements();
}

SceneVersion::SceneVersion(const SceneVersion& before, const EditedScene& scene, const MeshOptions& options,
                           std::uint32_t object)
    : serial_(before.serial_ + 1),
      soup_(make_soup(scene.scene())),
      visibility_(mesh_, soup_),
      slots_(before.slots_),
      observers_([this] { return visibility_.observer(); }),
      sights_([this] { return std::make_unique<PatchSight>(mesh_, soup_, visibility_.contacts()); }) {
  find_facets(scene);
  slots_[object].present = scene.is_present(object);
  ++slots_[object].pose;
  const EditedScene::Range surfaces = scene.surfaces_of(object);
  const PatchMesh own = make_patch_mesh(scene.scene(), soup_, options, surfaces.first, surfaces.last);
  const bool fits = !slots_[object].present || (own.patches.size() == slots_[object].patch_count &&
                                                own.elements.size() == slots_[object].element_count);

  // All numbers as they were, then the pieces and points of what is there.
  mesh_.patches = before.mesh_.patches;
  mesh_.elements = before.mesh_.elements;
  mesh_.points.reserve(before.mesh_.points.size());
  mesh_.pieces.reserve(before.mesh_.pieces.size());
  for (Patch& patch : mesh_.patches) patch.piece_first = patch.piece_count = 0;
  for (Element& element : mesh_.elements) element.piece_first = element.piece_count = 0;
  for (std::uint32_t k = 0; k < slots_.size(); ++k) {
    if (k == object || !slots_[k].present) continue;
    const std::uint32_t surface = scene.surfaces_of(k).first;
    const ObjectSlot& old = before.slots_[k];
    take_block(before.mesh_, old.patch_first, slots_[k].facet_first - old.facet_first, surface, slots_[k]);
  }
  if (slots_[object].present) {
    ObjectSlot& slot = slots_[object];
    if (!fits) {
      slot.patch_first = static_cast<std::uint32_t>(mesh_.patches.size());
      slot.element_first = static_cast<std::uint32_t>(mesh_.elements.size());
      slot.patch_count = static_cast<std::uint32_t>(own.patches.size());
      slot.element_count = static_cast<std::uint32_t>(own.elements.size());
      mesh_.patches.resize(mesh_.patches.size() + own.patches.size());
      mesh_.elements.resize(mesh_.elements.size() + own.elements.size());
    }
    take_block(own, 0, 0, surfaces.first, slot);
  }
  find_objects();
  element_index_ = before.element_index_;
  std::size_t elsewhere = 0;
  for (std::uint32_t k = 0; k < slots_.size(); ++k) {
    if (slots_[k].present && !is_indexed(k)) elsewhere += slots_[k].element_count;
  }
  if (4 * elsewhere > mesh_.elements.size()) index_elements();
}

/// Copies the patches of an object from a mesh in which they begin at patch_first; its facets are numbered higher by
/// facet_offset (modulo 2^32) here than there, its surfaces begin at `surface`.
void SceneVersion::take_block(const PatchMesh& from, std::uint32_t patch_first, std::uint32_t facet_offset,
                              std::uint32_t surface, const ObjectSlot& slot) {
  if (slot.patch_count == 0) return;
  const std::uint32_t surface_there = from.patches[patch_first].surface;
  const std::uint32_t element_there = from.patches[patch_first].element_first;
  const auto take_loop = [&](std::uint32_t first, std::uint32_t count) {
    const auto here = static_cast<std::uint32_t>(mesh_.points.size());
    mesh_.points.insert(mesh_.points.end(), from.points.begin() + first, from.points.begin() + first + count);
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
    patch.surface = patch.surface - surface_there + surface;
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

void SceneVersion::find_facets(const EditedScene& scene) {
  for (std::uint32_t object = 0; object < slots_.size(); ++object) {
    const EditedScene::Range surfaces = scene.surfaces_of(object);
    slots_[object].facet_first = soup_.first_facet(surfaces.first);
    slots_[object].facet_last = soup_.first_facet(surfaces.last);
  }
}

void SceneVersion::find_objects() {
  object_of_patch_.assign(mesh_.patches.size(), kVoid);
  for (std::uint32_t object = 0; object < slots_.size(); ++object) {
    const ObjectSlot& slot = slots_[object];
    if (!slot.present) continue;
    std::fill_n(object_of_patch_.begin() + slot.patch_first, slot.patch_count, object);
  }
}

void SceneVersion::index_elements() {
  std::vector<Box> boxes(mesh_.elements.size());
  for (std::uint32_t e = 0; e < boxes.size(); ++e) {
    if (object_of_element(e) != kVoid) boxes[e].extend(mesh_.elements[e].sample);
  }
  element_index_ = std::make_shared<const ElementIndex>(ElementIndex{SpatialIndex(boxes), slots_});
}

void SceneVersion::find_elements(std::span<const HalfSpace> region, std::vector<std::uint32_t>& found) const {
  const std::size_t first = found.size();
  element_index_->index.find(region, element_index_->index.bounds(), found);
  const auto moved = [&](std::uint32_t e) {
    const std::uint32_t object = object_of_element(e);
    return object == kVoid || !is_indexed(object);
  };
  found.erase(std::remove_if(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(), moved), found.end());
  for (std::uint32_t k = 0; k < slots_.size(); ++k) {
    const ObjectSlot& slot = slots_[k];
    if (!slot.present || is_indexed(k)) continue;
    for (std::uint32_t e = slot.element_first; e < slot.element_first + slot.element_count; ++e) {
      const Vec3& at = mesh_.elements[e].sample;
      if (std::ranges::all_of(region, [&](const HalfSpace& h) { return dot(h.normal, at) >= h.offset; }))
        found.push_back(e);
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
