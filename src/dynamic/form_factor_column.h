#pragma once
// Form factors from all sample points of a version of a scene to one patch, and a store of those that are needed again.

#include <cstdint>
#include <memory>
#include <vector>

#include "src/dynamic/version_difference.h"

namespace exitance {

/// Those that are not 0.
struct FormFactorColumn {
  std::shared_ptr<const SceneVersion> version;
  std::vector<std::uint32_t> element;  ///< ascending
  std::vector<double> F;
};

/// All of a column, exact (PatchSight); tests: form factors that were computed for it. In parallel; any number of threads
/// gives the same bits. REQUIRES: the patch is there.
FormFactorColumn make_column(std::shared_ptr<const SceneVersion> version, std::uint32_t patch, std::uint64_t& tests);

/// A column as it is after the changes that the difference finds for its patch, which must be there in both versions.
/// before: of the difference's earlier version.
FormFactorColumn changed_column(const FormFactorColumn& before, const VersionDifference& difference,
                                std::span<const FormFactorChange> changes);

/// Columns by patch, each of the version in which it was last used: what repeated shots of a patch, and shots after a
/// change that concerns little of a column, need not compute again. Copies share columns.
class ColumnStore {
 public:
  /// limit: bytes that all columns together may take; those that were not used for longest go first. 0: keeps nothing.
  explicit ColumnStore(std::uint64_t limit) : limit_(limit) {}

  /// None where it is not kept.
  std::shared_ptr<const FormFactorColumn> find(std::uint32_t patch);
  void put(std::uint32_t patch, std::shared_ptr<const FormFactorColumn> column);
  void clear();

  /// Keeps columns of the latest of their versions only, so many at most: versions take memory, too.
  void keep_versions(std::size_t count);

 private:
  void drop(std::uint32_t patch);

  struct Place {
    std::shared_ptr<const FormFactorColumn> column;
    std::uint64_t used = 0;
  };
  std::vector<Place> places_;  ///< by patch
  std::uint64_t limit_, bytes_ = 0, clock_ = 0;
};

}  // namespace exitance
