#pragma once
// Edits of a scene: objects come, go, move, change their shape, their reflectance or their emission.

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "src/scene/placement.h"
#include "src/scene/scene.h"

namespace exitance {

enum class Operation : std::uint8_t {
  add,      ///< an object that is not there comes, where it last was or at `placement`
  remove,   ///< an object goes
  move,     ///< an object is put to `placement`
  reshape,  ///< an object becomes `shape`
  change,   ///< some of an object's materials become others
  select,   ///< an object is taken hold of: until it is let go, its changes are temporary (edit_session.h)
  deselect  ///< it is let go
};

/// The operation's name as it stands above.
std::string_view name_of(Operation operation);

/// From one material of the scene to another, by their numbers; from kEvery: from whatever the surfaces have.
struct MaterialChange {
  static constexpr std::uint32_t kEvery = 0xffffffffu;
  std::uint32_t from = kEvery, to = 0;
};

struct Edit {
  Operation operation = Operation::move;
  std::uint32_t object = 0;  ///< of Scene::objects
  /// Where the object stands, from the coordinates that it has in the scene as read (or in `shape`), not from where it
  /// stood before: no number of moves adds up rounding. Mirror images and scales are allowed, 0 is not.
  std::optional<Placement> placement;
  std::vector<Surface> shape;  ///< of reshape: as large and where it is to be
  std::vector<MaterialChange> materials;
};

/// Edits of a scene file, in order of time.
struct Event {
  double time = 0;
  Edit edit;
  std::uint32_t line = 0;  ///< in the scene file
};

struct CameraAt {
  double time = 0;
  Camera camera;
};

/// Where the observer is at a time: between two places of the path evenly in between; before the first and after the
/// last, there. REQUIRES: the path is not empty and ascends in time.
Camera camera_at(std::span<const CameraAt> path, double time);

/// Thrown for an edit that has no meaning: of an object that does not exist, the addition of one that is there, a move
/// or removal of one that is not, a change of a material that it does not have, a shape without surfaces, an object put
/// where it cannot be computed with, an edit of another object than the one that is selected (but for selecting it, which
/// lets the first go), and letting go of what is not selected.
class InvalidEdit : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// A scene under edits. Surfaces stay in the order of their objects.
class EditedScene {
 public:
  /// Objects of Scene::absent are not there.
  explicit EditedScene(Scene scene);

  /// As it is now.
  const Scene& scene() const { return scene_; }
  bool is_present(std::uint32_t object) const { return present_[object]; }
  /// The object that is selected.
  std::optional<std::uint32_t> selected() const { return selected_; }

  /// The surfaces of an object that is there: first … last − 1.
  struct Range {
    std::uint32_t first = 0, last = 0;
  };
  Range surfaces_of(std::uint32_t object) const;

  /// What an edit changed of an object.
  struct Effect {
    bool geometry = false, materials = false;
  };
  /// All or nothing: throws InvalidEdit and leaves the scene as it was. Selecting changes no surface.
  Effect apply(const Edit& edit);

 private:
  void put(std::uint32_t object);
  void take_out(std::uint32_t object);
  void refuse_what_has_no_meaning(const Edit& edit) const;
  bool has_material(std::uint32_t object, std::uint32_t material) const;

  Scene scene_;
  std::vector<std::vector<Surface>> rest_;  ///< by object, as read or as reshaped
  std::vector<Placement> placement_;        ///< by object
  std::vector<bool> present_;               ///< by object
  std::optional<std::uint32_t> selected_;
};

}  // namespace exitance
