#pragma once
// The geometry of a scene between two edits, with its mesh; patches and elements keep their numbers from one version to
// the next.

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/polygon_soup.h"
#include "geometry/shadow_volume.h"
#include "src/dynamic/patch_sight.h"
#include "src/scene/edit.h"
#include "src/scene/facet_range.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/exact_visibility.h"

namespace exitance {

/// An object's place in the mesh of a version. Its patches and elements are contiguous, and stay where they are as long
/// as an edit does not change how many there are.
struct ObjectSlot {
  std::uint32_t patch_first = 0, patch_count = 0;
  std::uint32_t element_first = 0, element_count = 0;
  std::uint32_t surface_first = 0;                ///< in the scene
  std::uint32_t facet_first = 0, facet_last = 0;  ///< in the version's soup
  PolygonSoup::PolygonRange polygons;             ///< likewise
  Box box;                                        ///< of its facets; empty where none has an area
  std::uint64_t pose = 0;                         ///< changes with every edit of the object's geometry
  bool present = false;
};

/// Immutable but for the scratch memory of its observers. Numbers of patches and elements that belong to no present
/// object are void: such patches have no pieces, such elements must not be asked about.
class SceneVersion {
 public:
  static constexpr std::uint32_t kVoid = 0xffffffffu;

  /// The first version of a scene.
  SceneVersion(const EditedScene& scene, const MeshOptions& options);

  /// The version after an edit of the geometry of one object. Everything else keeps its elements; the object is cut
  /// anew. Where it has as many patches and elements as before they take the same numbers, else new ones behind all
  /// others. Sample points are those of a first version of the scene (SampleSite): they make way where the object has
  /// come to lie on them, and go back when it has left. Shares with `before` what it can (PolygonSoup::edited).
  SceneVersion(const SceneVersion& before, const EditedScene& scene, const MeshOptions& options, std::uint32_t object);
  SceneVersion(const SceneVersion&) = delete;
  SceneVersion& operator=(const SceneVersion&) = delete;

  /// Counts versions that are made from one another, from 0.
  std::uint64_t serial() const { return serial_; }
  const PolygonSoup& soup() const { return soup_; }
  const PatchMesh& mesh() const { return mesh_; }
  std::size_t patches() const { return mesh_.patches.size(); }
  std::size_t elements() const { return mesh_.elements.size(); }
  std::size_t present_patches() const;
  std::size_t present_elements() const;
  std::size_t objects() const { return slots_.size(); }

  const ObjectSlot& slot(std::uint32_t object) const { return slots_[object]; }
  /// By object: its facets, none where it is not there.
  std::vector<FacetRange> facet_ranges() const;
  /// The object that a patch belongs to, or kVoid.
  std::uint32_t object_of_patch(std::uint32_t patch) const {
    return patch < object_of_patch_.size() ? object_of_patch_[patch] - 1 : kVoid;
  }
  std::uint32_t object_of_element(std::uint32_t element) const {
    return object_of_patch(mesh_.elements[element].patch);
  }
  bool has_element(std::uint32_t element) const { return element < elements() && object_of_element(element) != kVoid; }

  /// The object that a facet of the soup belongs to, or kVoid. Takes time by the number of objects.
  std::uint32_t object_of_facet(std::uint32_t facet) const;

  /// Objects whose geometry is not the same in both versions, ascending.
  std::vector<std::uint32_t> changed_since(const SceneVersion& other) const;

  /// Whether an object is there in both, and in the same place.
  bool same_in(const SceneVersion& other, std::uint32_t object) const {
    return slots_[object].present && other.slots_[object].present && slots_[object].pose == other.slots_[object].pose;
  }

  /// Elements that are the same in both but for their sample points, ascending.
  std::vector<std::uint32_t> resampled_since(const SceneVersion& other) const;

  /// Appends every element whose sample point lies in each of the half-spaces, ascending or not, and some that do not,
  /// some more than once; none that is void.
  void find_elements(std::span<const HalfSpace> region, std::vector<std::uint32_t>& found) const;

  /// Of this thread, between patches of present objects.
  PatchSight& sight() const { return *sights_.local(); }

  /// All form factors of an element that is not void, exact (ExactVisibility). Any number of threads.
  PointRow row(std::uint32_t element) const;

 private:
  void take_block(const PatchMesh& from, std::uint32_t patch_first, std::uint32_t facet_offset,
                  std::uint32_t surface_offset, const ObjectSlot& slot);
  void take_others(const SceneVersion& before, std::uint32_t object);
  void place_objects(const EditedScene& scene, bool soup_is_new);
  void find_box(ObjectSlot& slot) const;
  void find_objects();
  void find_object(std::uint32_t object);
  void choose_samples(const SceneVersion& before, std::uint32_t object);
  Box box_of_patch(std::uint32_t patch) const;
  void index_elements();

  /// Sample points and patches as they were when it was made. Those of objects that have changed since are not used,
  /// nor are sample points that have made way.
  struct ElementIndex {
    SpatialIndex samples, patches;
    std::vector<ObjectSlot> slots;
    std::uint64_t serial;
  };
  struct Resampled {
    std::uint32_t element;
    std::uint64_t serial;  ///< of the version in which its sample point moved last
  };
  /// The object's elements are where they were.
  bool is_indexed(std::uint32_t object) const {
    const ObjectSlot& then = element_index_->slots[object];
    return then.present && slots_[object].present && then.pose == slots_[object].pose;
  }

  std::uint64_t serial_ = 0;
  PolygonSoup soup_;
  PatchMesh mesh_;
  ExactVisibility visibility_;
  std::vector<ObjectSlot> slots_;
  SharedRows<std::uint32_t> object_of_patch_;          ///< + 1; 0: nobody's
  std::shared_ptr<const ElementIndex> element_index_;  ///< shared by versions that follow each other
  std::vector<Resampled> resampled_;                   ///< since the first version, by element
  mutable tbb::enumerable_thread_specific<std::unique_ptr<Observer>> observers_;
  mutable tbb::enumerable_thread_specific<std::unique_ptr<PatchSight>> sights_;
};

}  // namespace exitance
