#pragma once
// Rows of form factors from the elements of one object, as far as they have been looked for.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "src/visibility/visibility.h"

namespace exitance {

/// Of contiguous elements, in one version of a scene. Copies share rows.
class ObjectRows {
 public:
  ObjectRows() = default;
  ObjectRows(std::uint32_t element_first, std::uint32_t element_count)
      : element_first_(element_first), rows_(element_count) {}

  bool has(std::uint32_t element) const {
    return element_first_ <= element && element - element_first_ < rows_.size() && rows_[element - element_first_];
  }
  void put(std::uint32_t element, PointRow row) {
    rows_[element - element_first_] = std::make_shared<const PointRow>(std::move(row));
  }
  /// REQUIRES: has(element).
  const PointRow& row(std::uint32_t element) const { return *rows_[element - element_first_]; }
  /// Form factor from an element to a patch; likewise.
  double F(std::uint32_t element, std::uint32_t patch) const {
    const PointRow& of = row(element);
    const auto at = std::ranges::lower_bound(of.column, patch);
    return at != of.column.end() && *at == patch ? of.F[static_cast<std::size_t>(at - of.column.begin())] : 0.0;
  }

 private:
  std::uint32_t element_first_ = 0;
  std::vector<std::shared_ptr<const PointRow>> rows_;
};

}  // namespace exitance
