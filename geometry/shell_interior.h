#pragma once
// Whether points lie inside a closed surface.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/facets.h"
#include "geometry/spatial_index.h"

namespace exitance {

/// Counts crossings of a ray towards +x, each decided exactly, found through a grid over the other two axes.
class ShellInterior {
 public:
  /// Convex facets of a closed surface, all facing in or all facing out. REQUIRES: not empty.
  explicit ShellInterior(std::vector<Loop> facets);

  /// Of a point on the surface, either answer.
  bool contains(const Vec3& p) const;
  const Box& box() const { return box_; }

 private:
  std::size_t cell(double value, int axis) const;

  std::vector<Loop> facets_;
  Box box_;
  std::size_t cells_per_axis_ = 1;
  std::vector<std::vector<std::uint32_t>> cells_;
};

}  // namespace exitance
