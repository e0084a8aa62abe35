#pragma once
// Small rooms with objects that come, go and move, for tests.

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "src/scene/edit.h"
#include "src/scene/placement.h"
#include "src/scene/scene.h"

namespace exitance {

inline std::vector<Surface> box_surfaces(const Vec3& a, const Vec3& b, std::uint32_t object, std::uint32_t material,
                                         bool inward) {
  std::vector<Surface> faces;
  const auto add = [&](std::vector<Vec3> loop) {
    if (inward) std::reverse(loop.begin() + 1, loop.end());
    Surface s;
    s.polygon.outer = std::move(loop);
    s.object = object;
    s.material = material;
    faces.push_back(s);
  };
  add({{a.x, a.y, a.z}, {a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, a.y, a.z}});
  add({{a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z}});
  add({{a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z}});
  add({{a.x, b.y, a.z}, {a.x, b.y, b.z}, {b.x, b.y, b.z}, {b.x, b.y, a.z}});
  add({{a.x, a.y, a.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}, {a.x, b.y, a.z}});
  add({{b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {b.x, a.y, b.z}});
  return faces;
}

/// A room 3 × 3 × 3 with a light on its ceiling: object 0. Objects 1, a box on the floor; 2, an L of two boxes that
/// share no face; 3, a lamp, absent; 4, a two-sided sheet. Three bands.
inline Scene test_room() {
  Scene scene;
  scene.name = "test room";
  scene.bands = 3;
  scene.materials = {{.name = "wall", .rho = {0.5, 0.6, 0.4}, .E = {0, 0, 0}},
                     {.name = "light", .rho = {0.3, 0.3, 0.3}, .E = {10, 9, 8}},
                     {.name = "red", .rho = {0.7, 0.1, 0.1}, .E = {0, 0, 0}},
                     {.name = "lamp", .rho = {0.2, 0.2, 0.2}, .E = {5, 6, 9}}};
  for (const char* name : {"room", "box", "L", "lamp", "sheet"}) scene.objects.push_back({name, ""});
  scene.surfaces = box_surfaces({0, 0, 0}, {3, 3, 3}, 0, 0, true);
  scene.surfaces[1].material = 1;
  const auto append = [](std::vector<Surface>& to, std::vector<Surface> more) {
    to.insert(to.end(), more.begin(), more.end());
  };
  append(scene.surfaces, box_surfaces({1, 1, 0}, {1.75, 1.75, 0.75}, 1, 0, false));
  append(scene.surfaces, box_surfaces({2, 0.5, 0.25}, {2.75, 1, 0.5}, 2, 2, false));
  append(scene.surfaces, box_surfaces({2.5, 0.5, 0.75}, {2.75, 1, 1.5}, 2, 2, false));
  append(scene.absent, box_surfaces({0.25, 0.25, 2}, {0.5, 0.5, 2.25}, 3, 3, false));
  Surface sheet;
  sheet.polygon.outer = {{0.5, 2, 1.25}, {1.5, 2, 1.25}, {1.5, 2.5, 1.25}, {0.5, 2.5, 1.25}};
  sheet.object = 4;
  sheet.material = 2;
  scene.surfaces.push_back(sheet);
  std::reverse(sheet.polygon.outer.begin() + 1, sheet.polygon.outer.end());
  scene.surfaces.push_back(sheet);
  return scene;
}

/// Random edits that have a meaning, of any kind.
class RandomEdits {
 public:
  explicit RandomEdits(std::uint64_t seed) : random_(seed) {}

  Edit next(const EditedScene& scene) {
    Edit edit;
    edit.object = 1 + pick(static_cast<std::uint32_t>(scene.scene().objects.size()) - 1);
    if (!scene.is_present(edit.object)) {
      edit.operation = Operation::add;
      if (pick(2) == 0) edit.placement = placement();
      return edit;
    }
    switch (pick(8)) {
      case 0:
        edit.operation = Operation::remove;
        break;
      case 1:
        edit.operation = Operation::change;
        edit.materials = {{MaterialChange::kEvery, pick(static_cast<std::uint32_t>(scene.scene().materials.size()))}};
        break;
      case 2: {
        edit.operation = Operation::reshape;
        const Vec3 low{1 + below(0.5), 1 + below(0.5), below(1)};
        edit.shape = box_surfaces(low, low + Vec3{0.2 + below(0.5), 0.2 + below(0.5), 0.2 + below(0.5)}, edit.object,
                                  pick(4), false);
        break;
      }
      default:
        edit.operation = Operation::move;
        edit.placement = placement();
    }
    return edit;
  }
  std::uint32_t pick(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }
  double below(double limit) { return static_cast<double>(random_() >> 11) * 0x1p-53 * limit; }

 private:
  /// Turned and shifted, or shifted by quarters only, so that faces touch in the same coordinates.
  Placement placement() {
    Placement p;
    if (pick(3) == 0) {
      p.translation = {0.25 * (pick(5) - 2.0), 0.25 * (pick(5) - 2.0), 0};
      return p;
    }
    const Vec3 middle{1.5, 1.5, 1};
    p.linear = rotation({below(1) - 0.5, below(1) - 0.5, below(1)}, below(360));
    if (pick(3) == 0) p.linear = product(p.linear, scaling({0.5 + below(0.7), 0.5 + below(0.7), 0.5 + below(0.7)}));
    const Placement turn{p.linear, {}};
    p.translation = middle - turn(middle) + Vec3{0.4 * (below(1) - 0.5), 0.4 * (below(1) - 0.5), 0.3 * below(1)};
    return p;
  }

  std::mt19937_64 random_;
};

}  // namespace exitance
