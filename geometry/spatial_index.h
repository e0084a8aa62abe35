#pragma once
// A hierarchy of boxes around facets, searched by convex regions and by boxes.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "geometry/huge_pages.h"
#include "geometry/vec3.h"

namespace exitance {

/// An axis-parallel box; empty until extended.
struct Box {
  Vec3 lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
  Vec3 upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
             -std::numeric_limits<double>::infinity()};

  void extend(const Vec3& p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  void extend(const Box& b) {
    lower = {std::min(lower.x, b.lower.x), std::min(lower.y, b.lower.y), std::min(lower.z, b.lower.z)};
    upper = {std::max(upper.x, b.upper.x), std::max(upper.y, b.upper.y), std::max(upper.z, b.upper.z)};
  }
  /// Whether p is inside or on the boundary of the box grown by `margin` on every side.
  bool contains(const Vec3& p, double margin = 0) const {
    return lower.x - margin <= p.x && p.x <= upper.x + margin && lower.y - margin <= p.y && p.y <= upper.y + margin &&
           lower.z - margin <= p.z && p.z <= upper.z + margin;
  }
  Box grown(double margin) const {
    return {lower - Vec3{margin, margin, margin}, upper + Vec3{margin, margin, margin}};
  }
  bool overlaps(const Box& b) const {
    return lower.x <= b.upper.x && b.lower.x <= upper.x && lower.y <= b.upper.y && b.lower.y <= upper.y &&
           lower.z <= b.upper.z && b.lower.z <= upper.z;
  }
};

/// Of normal · (v − origin) for all v in a box, less than the least by more than the rounding of three sums of
/// products; normal_error: of each of the normal's components.
inline double least_height(const Box& box, const Vec3& normal, const Vec3& origin, double normal_error) {
  const Vec3 middle = 0.5 * box.lower + 0.5 * box.upper, half = box.upper - middle, w = middle - origin;
  const Vec3 size{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
  const double reach = std::fabs(w.x) + std::fabs(w.y) + std::fabs(w.z) + half.x + half.y + half.z;
  const double margin = (2 * normal_error + 0x1p-48 * (size.x + size.y + size.z)) *
                        (reach + std::fabs(middle.x) + std::fabs(middle.y) + std::fabs(middle.z));
  return dot(normal, w) - dot(size, half) - margin;
}

/// The half-space normal · v ≥ offset. Whoever makes it lowers the offset by its own rounding errors.
struct HalfSpace {
  Vec3 normal;
  double offset = 0;
};

/// Bounding volume hierarchy with eight children a node, split by the surface area heuristic. Searches are
/// conservative: nothing that meets the region is left out, some that does not may be returned: boxes are held in
/// single precision, relative to the bounds of all. Items with an empty box are never found. The same boxes give the
/// same tree. Copies share it.
class SpatialIndex {
 public:
  SpatialIndex() = default;
  explicit SpatialIndex(std::span<const Box> boxes);

  struct Item {
    std::uint32_t number = 0;
    Box box;
  };

  /// The index without the items `gone` and with those `added`, whose numbers are new. The tree is shared, what was
  /// added since it was made has a small one of its own: takes time by what has changed since then.
  SpatialIndex changed(std::span<const std::uint32_t> gone, std::span<const Item> added) const;

  /// Appends to `found` every item whose box reaches into each of the half-spaces and touches or overlaps the box.
  void find(std::span<const HalfSpace> region, const Box& box, std::vector<std::uint32_t>& found) const;

  /// Appends to `found` every item whose box touches or overlaps the box.
  void find(const Box& box, std::vector<std::uint32_t>& found) const { find({}, box, found); }

  /// Around everything, and what is gone; empty for no boxes.
  const Box& bounds() const { return bounds_; }

 private:
  static constexpr std::size_t kWidth = 8;
  struct alignas(64) Node {
    std::array<std::array<std::array<float, kWidth>, 3>, 2> bounds;  ///< [lower, upper][axis][child], rounded outward
    std::array<std::int32_t, kWidth> child;  ///< ≥ 0: a node; < 0: item −1 − child; unused places have an empty box
  };

  struct Tree {
    explicit Tree(std::span<const Box> boxes);
    void find(std::span<const HalfSpace> region, const Box& box, std::vector<std::uint32_t>& found) const;
    std::int32_t build(std::span<std::uint32_t> items, std::span<const Box> boxes, int depth);

    /// (v − centre) / size, along one axis: between −1 and 1 for all that is in the bounds, with a rounding error below
    /// 2^-50 times 1 + |v / size|.
    double scaled(double v, int axis) const { return (v - centre[axis]) * per_size; }

    LargeArray<Node> nodes;
    Box bounds;
    Vec3 centre;
    double per_size = 1;  ///< a power of two, so that no box loses anything but by the shift
  };

  std::shared_ptr<const Tree> tree_, added_tree_;
  std::vector<Item> added_;          ///< by their place in added_tree_
  std::vector<std::uint32_t> gone_;  ///< of tree_, ascending
  Box bounds_;
};

}  // namespace exitance
