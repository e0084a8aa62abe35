#include "src/scene/edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "src/scene/scene_extent.h"

namespace exitance {

std::string_view name_of(Operation operation) {
  static constexpr std::array<std::string_view, 7> kNames = {"add",    "remove", "move",    "reshape",
                                                             "change", "select", "deselect"};
  return kNames[static_cast<std::size_t>(operation)];
}

Camera camera_at(std::span<const CameraAt> path, double time) {
  const auto after = std::ranges::find_if(path, [&](const CameraAt& c) { return c.time > time; });
  if (after == path.begin()) return path.front().camera;
  if (after == path.end()) return path.back().camera;
  const CameraAt &a = *std::prev(after), &b = *after;
  const double t = (time - a.time) / (b.time - a.time);
  const auto between = [&](const Vec3& p, const Vec3& q) { return p + t * (q - p); };
  return {between(a.camera.eye, b.camera.eye), between(a.camera.target, b.camera.target),
          between(a.camera.up, b.camera.up),
          a.camera.vertical_fov_degrees + t * (b.camera.vertical_fov_degrees - a.camera.vertical_fov_degrees)};
}

EditedScene::EditedScene(Scene scene)
    : scene_(std::move(scene)),
      rest_(scene_.objects.size()),
      placement_(scene_.objects.size()),
      present_(scene_.objects.size()) {
  std::ranges::stable_sort(scene_.surfaces, {}, &Surface::object);
  for (const Surface& s : scene_.surfaces) {
    rest_[s.object].push_back(s);
    present_[s.object] = true;
  }
  for (Surface& s : scene_.absent) rest_[s.object].push_back(std::move(s));
  scene_.absent.clear();
}

EditedScene::Range EditedScene::surfaces_of(std::uint32_t object) const {
  const auto& all = scene_.surfaces;
  return {static_cast<std::uint32_t>(std::ranges::lower_bound(all, object, {}, &Surface::object) - all.begin()),
          static_cast<std::uint32_t>(std::ranges::upper_bound(all, object, {}, &Surface::object) - all.begin())};
}

void EditedScene::take_out(std::uint32_t object) {
  const Range range = surfaces_of(object);
  scene_.surfaces.erase(scene_.surfaces.begin() + range.first, scene_.surfaces.begin() + range.last);
  present_[object] = false;
}

/// Where the object's placement puts it.
void EditedScene::put(std::uint32_t object) {
  Scene part;
  part.surfaces = rest_[object];
  place(part, placement_[object]);
  take_out(object);
  const Range range = surfaces_of(object);
  scene_.surfaces.insert(scene_.surfaces.begin() + range.first, std::make_move_iterator(part.surfaces.begin()),
                         std::make_move_iterator(part.surfaces.end()));
  present_[object] = true;
}

bool EditedScene::has_material(std::uint32_t object, std::uint32_t material) const {
  return std::ranges::any_of(rest_[object], [&](const Surface& s) { return s.material == material; });
}

void EditedScene::refuse_what_has_no_meaning(const Edit& edit) const {
  if (edit.object >= rest_.size())
    throw InvalidEdit(fmt::format("there is no object {}; the scene has {}", edit.object, rest_.size()));
  const std::string& name = scene_.objects[edit.object].name;
  if (selected_ && *selected_ != edit.object && edit.operation != Operation::select)
    throw InvalidEdit(fmt::format("object '{}' is selected; deselect it before others are edited",
                                  scene_.objects[*selected_].name));
  if (edit.operation == Operation::deselect && !selected_)
    throw InvalidEdit(fmt::format("object '{}' is not selected; select it before it can be deselected", name));
  const bool present = present_[edit.object];
  if (edit.operation == Operation::add && present)
    throw InvalidEdit(fmt::format("object '{}' is there already and cannot be added; move it, or remove it first", name));
  if (edit.operation != Operation::add && !present)
    throw InvalidEdit(fmt::format("object '{}' is not there; add it before it can be {}", name,
                                  edit.operation == Operation::remove     ? "removed"
                                  : edit.operation == Operation::move     ? "moved"
                                  : edit.operation == Operation::select   ? "selected"
                                  : edit.operation == Operation::deselect ? "deselected"
                                                                          : "changed"));
  if (edit.operation == Operation::reshape && edit.shape.empty())
    throw InvalidEdit(fmt::format("object '{}' would have no surfaces; remove it instead", name));
  for (const MaterialChange& c : edit.materials) {
    if (c.to >= scene_.materials.size()) throw InvalidEdit(fmt::format("there is no material {}", c.to));
    if (c.from != MaterialChange::kEvery && !has_material(edit.object, c.from))
      throw InvalidEdit(fmt::format("object '{}' has no surface of material '{}'; correct the name", name,
                                    c.from < scene_.materials.size() ? scene_.materials[c.from].name : "?"));
  }
  if (edit.placement || edit.operation == Operation::reshape) {
    Scene moved;
    moved.surfaces = edit.operation == Operation::reshape ? edit.shape : rest_[edit.object];
    if (edit.placement) place(moved, *edit.placement);
    double largest = extent(scene_);
    for (const Surface& s : moved.surfaces) largest = std::max(largest, extent(s.polygon));
    for (const Surface& s : moved.surfaces) {
      const PolygonDefect defect = find_defect(s.polygon);
      const std::string wrong = defect != PolygonDefect::none && defect != PolygonDefect::zero_area
                                    ? std::string(describe(defect))
                                    : find_bad_extent(s.polygon, largest);
      if (!wrong.empty()) throw InvalidEdit(fmt::format("object '{}' cannot be put there: {}", name, wrong));
    }
  }
}

EditedScene::Effect EditedScene::apply(const Edit& edit) {
  refuse_what_has_no_meaning(edit);
  const std::uint32_t object = edit.object;
  Effect effect;
  for (const MaterialChange& c : edit.materials) {
    const auto change = [&](Surface& s) {
      if ((c.from == MaterialChange::kEvery || s.material == c.from) && s.material != c.to) {
        s.material = c.to;
        effect.materials = true;
      }
    };
    std::ranges::for_each(rest_[object], change);
    const Range range = surfaces_of(object);
    std::for_each(scene_.surfaces.begin() + range.first, scene_.surfaces.begin() + range.last, change);
  }
  switch (edit.operation) {
    case Operation::add:
    case Operation::move:
      if (edit.placement) placement_[object] = *edit.placement;
      put(object);
      effect.geometry = true;
      break;
    case Operation::remove:
      take_out(object);
      effect.geometry = true;
      selected_.reset();
      break;
    case Operation::reshape:
      rest_[object] = edit.shape;
      for (Surface& s : rest_[object]) s.object = object;
      placement_[object] = edit.placement.value_or(Placement{});
      put(object);
      effect.geometry = true;
      break;
    case Operation::select:
      selected_ = object;
      break;
    case Operation::deselect:
      selected_.reset();
      break;
    case Operation::change:
      break;
  }
  return effect;
}

}  // namespace exitance
