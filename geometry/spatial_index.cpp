#include "geometry/spatial_index.h"

#include <algorithm>

namespace exitance {
namespace {

constexpr int kBins = 16;
constexpr int kDeepest = 32;  // below, halves: keeps the depth under 32 + 16 and the search stacks within their bounds

double half_surface(const Box& box) {
  const Vec3 d = box.upper - box.lower;
  return d.x < 0 ? 0 : d.x * d.y + d.y * d.z + d.z * d.x;
}

Box box_of(std::span<const std::uint32_t> items, std::span<const Box> boxes) {
  Box all;
  for (const auto i : items) all.extend(boxes[i]);
  return all;
}

/// Where to cut the items (reordered) in two: binned surface area heuristic, halves where all centres coincide.
std::size_t split(std::span<std::uint32_t> items, std::span<const Box> boxes) {
  const auto centre = [&](std::uint32_t i, int axis) {
    return 0.5 * boxes[i].lower[axis] + 0.5 * boxes[i].upper[axis];
  };
  double best_cost = std::numeric_limits<double>::infinity();
  int best_axis = -1, best_bin = 0;
  std::array<double, 3> low{}, scale{};
  for (int axis = 0; axis < 3; ++axis) {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const auto i : items) {
      lo = std::min(lo, centre(i, axis));
      hi = std::max(hi, centre(i, axis));
    }
    low[static_cast<std::size_t>(axis)] = lo;
    if (!(hi > lo)) continue;
    const double per_bin = kBins * (1 - 1e-9) / (hi - lo);
    if (!std::isfinite(per_bin)) continue;
    scale[static_cast<std::size_t>(axis)] = per_bin;
    std::array<Box, kBins> bin{};
    std::array<std::size_t, kBins> count{};
    for (const auto i : items) {
      const auto b = static_cast<std::size_t>((centre(i, axis) - lo) * per_bin);
      bin[b].extend(boxes[i]);
      ++count[b];
    }
    std::array<double, kBins> right_cost{};
    Box right;
    std::size_t n = 0;
    for (std::size_t b = kBins - 1; b > 0; --b) {
      right.extend(bin[b]);
      n += count[b];
      right_cost[b] = static_cast<double>(n) * half_surface(right);
    }
    Box left;
    n = 0;
    for (std::size_t b = 1; b < kBins; ++b) {
      left.extend(bin[b - 1]);
      n += count[b - 1];
      const double cost = static_cast<double>(n) * half_surface(left) + right_cost[b];
      if (n > 0 && n < items.size() && cost < best_cost) {
        best_cost = cost;
        best_axis = axis;
        best_bin = static_cast<int>(b);
      }
    }
  }
  if (best_axis < 0) return items.size() / 2;
  const auto a = static_cast<std::size_t>(best_axis);
  const auto middle = std::stable_partition(items.begin(), items.end(), [&](std::uint32_t i) {
    return static_cast<int>((centre(i, best_axis) - low[a]) * scale[a]) < best_bin;
  });
  return static_cast<std::size_t>(middle - items.begin());
}

}  // namespace

SpatialIndex::SpatialIndex(std::span<const Box> boxes) {
  std::vector<std::uint32_t> items;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].lower.x > boxes[i].upper.x) continue;
    items.push_back(i);
    bounds_.extend(boxes[i]);
  }
  if (items.empty()) return;
  nodes_.reserve(boxes.size() / 2 + 1);
  build(items, boxes, 0);
}

std::int32_t SpatialIndex::build(std::span<std::uint32_t> items, std::span<const Box> boxes, int depth) {
  const auto index = static_cast<std::int32_t>(nodes_.size());
  nodes_.emplace_back();
  // The four parts of the node: the largest part is split until there are four or only single items.
  std::array<std::span<std::uint32_t>, 4> part{items};
  std::size_t parts = 1;
  while (parts < 4) {
    const auto largest = std::max_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(parts),
                                          [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (largest->size() < 2) break;
    const std::size_t cut = depth < kDeepest ? split(*largest, boxes) : largest->size() / 2;
    part[parts++] = largest->subspan(cut);
    *largest = largest->first(cut);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const Box box = k < parts ? box_of(part[k], boxes) : Box{};
    std::int32_t child = 0;
    if (k < parts)
      child = part[k].size() == 1 ? -1 - static_cast<std::int32_t>(part[k][0]) : build(part[k], boxes, depth + 1);
    Node& node = nodes_[static_cast<std::size_t>(index)];
    for (int axis = 0; axis < 3; ++axis) {
      node.lower[static_cast<std::size_t>(axis)][k] = box.lower[axis];
      node.upper[static_cast<std::size_t>(axis)][k] = box.upper[axis];
    }
    node.child[k] = child;
  }
  return index;
}

void SpatialIndex::find(std::span<const HalfSpace> region, const Box& box, std::vector<std::uint32_t>& found) const {
  if (nodes_.empty()) return;
  std::array<std::int32_t, 256> stack;
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(stack[--top])];
    // < 0: the child's box lies apart from the box or outside of some half-space. Empty children lie apart.
    std::array<double, 4> reach;
    for (std::size_t k = 0; k < 4; ++k) {
      const bool meets = (node.lower[0][k] <= box.upper.x) & (box.lower.x <= node.upper[0][k]) &
                         (node.lower[1][k] <= box.upper.y) & (box.lower.y <= node.upper[1][k]) &
                         (node.lower[2][k] <= box.upper.z) & (box.lower.z <= node.upper[2][k]);
      reach[k] = meets ? std::numeric_limits<double>::infinity() : -1.0;
    }
    for (const HalfSpace& h : region) {
      const auto& x = h.normal.x > 0 ? node.upper[0] : node.lower[0];
      const auto& y = h.normal.y > 0 ? node.upper[1] : node.lower[1];
      const auto& z = h.normal.z > 0 ? node.upper[2] : node.lower[2];
      for (std::size_t k = 0; k < 4; ++k) {
        const double value = h.normal.x * x[k] + h.normal.y * y[k] + h.normal.z * z[k] - h.offset;
        reach[k] = value < reach[k] ? value : reach[k];
      }
    }
    for (std::size_t k = 0; k < 4; ++k) {
      if (!(reach[k] >= 0)) continue;
      if (node.child[k] < 0) {
        found.push_back(static_cast<std::uint32_t>(-1 - node.child[k]));
      } else {
        stack[top++] = node.child[k];
      }
    }
  }
}

}  // namespace exitance
