#pragma once
// How form factors differ between two versions of a scene: F^Δt of George, Sillion and Greenberg 1990, patch by patch
// and for no more elements than can have changed.

#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/shadow_volume.h"
#include "src/dynamic/object_rows.h"
#include "src/dynamic/scene_version.h"

namespace exitance {

struct FormFactorColumn;  // form_factor_column.h

struct FormFactorChange {
  std::uint32_t element = 0;
  double before = 0, after = 0;
  double error = 0;         ///< bound of that of after − before, of what was computed for it
  std::uint32_t tests = 0;  ///< form factors that were computed for it
};

/// What the search for changed form factors took.
struct ChangeWork {
  std::uint64_t candidates = 0;        ///< elements that were classified against a shadow volume
  std::uint64_t kept = 0;              ///< of those, in the umbra before and after: nothing to do
  std::uint64_t visibility_tests = 0;  ///< form factors that were computed
  std::uint64_t idle_tests = 0;        ///< of those, for elements whose form factor did not change
  std::uint64_t idle_patch_tests = 0;  ///< of those, for patches none of whose elements' did

  ChangeWork& operator+=(const ChangeWork& other) {
    candidates += other.candidates;
    kept += other.kept;
    visibility_tests += other.visibility_tests;
    idle_tests += other.idle_tests;
    idle_patch_tests += other.idle_patch_tests;
    return *this;
  }
};

class VersionDifference {
 public:
  enum class Search : std::uint8_t {
    shadow_volumes,  ///< only elements of changed objects, resampled ones and those in a shadow, old or new
    everywhere       ///< all elements: what a program without shadow volumes would do
  };

  VersionDifference(std::shared_ptr<const SceneVersion> before, std::shared_ptr<const SceneVersion> after);
  ~VersionDifference();
  VersionDifference(const VersionDifference&) = delete;
  VersionDifference& operator=(const VersionDifference&) = delete;

  const SceneVersion& before() const { return *before_; }
  const SceneVersion& after() const { return *after_; }
  const std::shared_ptr<const SceneVersion>& shared_after() const { return after_; }
  /// Objects whose geometry is not the same, ascending.
  const std::vector<std::uint32_t>& objects() const { return objects_; }

  /// Whether a patch of `before` is the same in `after`; else what it has shot is to be taken back as a whole.
  bool keeps(std::uint32_t patch) const;

  /// F^{t−1} and F^t from elements to a patch that is there before, for elements that are there after, ascending.
  /// Left out are elements for which neither can differ; some that are given may be equal.
  ///  - An element of a changed object was not there (or stood elsewhere): its F^{t−1} is 0.
  ///  - A patch of a changed object is no longer there: its F^t is 0, and all elements that see it are given.
  ///  - An element whose sample point has made way is given with what both of its points see.
  ///  - Else elements whose view of the patch meets a changed object as it was or as it is.
  /// known: the patch's column in `before`, if there is one: F^{t−1} is not computed then.
  /// rows: of elements of a changed object in `after`: their F^t is not computed either.
  /// In parallel; any number of threads gives the same bits.
  std::vector<FormFactorChange> column(std::uint32_t patch, Search search, const FormFactorColumn* known,
                                       const ObjectRows& rows, ChangeWork& work) const;

 private:
  struct Scratch;

  void find_candidates(std::uint32_t patch, std::vector<std::uint32_t>& found) const;
  void compare(std::uint32_t receiver, std::uint32_t patch, Search search, const FormFactorColumn* known,
               const ObjectRows& rows, Scratch& scratch, std::span<FormFactorChange> changes, ChangeWork& work) const;
  void compare_in_shadow(std::uint32_t receiver, std::uint32_t patch, const FormFactorColumn* known, Scratch& scratch,
                         std::span<FormFactorChange> changes, ChangeWork& work) const;

  std::shared_ptr<const SceneVersion> before_, after_;
  std::vector<std::uint32_t> objects_;
  std::vector<std::uint32_t> resampled_;                  ///< elements
  std::vector<std::unique_ptr<ShadowCaster>> old_, new_;  ///< the objects' shapes before and after
  mutable tbb::enumerable_thread_specific<std::unique_ptr<Scratch>> scratch_;
};

}  // namespace exitance
