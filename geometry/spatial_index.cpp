#include "geometry/spatial_index.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>

namespace exitance {
namespace {

constexpr int kBins = 16;
constexpr float kEmptyPlace = 4;  // out of all that is searched
constexpr int kDeepest = 20;      // below, halves: keeps the depth under 20 + 11, and what waits in a search in its ring

/// Single-precision numbers not above, and not below, a number of size at most 2: one rounding of the conversion, and
/// what the number's own error may be.
float rounded_down(double v) {
  return static_cast<float>(v - 0x1p-22);
}
float rounded_up(double v) {
  return static_cast<float>(v + 0x1p-22);
}

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

SpatialIndex::Tree::Tree(std::span<const Box> boxes) {
  std::vector<std::uint32_t> items;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].lower.x > boxes[i].upper.x) continue;
    items.push_back(i);
    bounds.extend(boxes[i]);
  }
  if (items.empty()) return;
  double size = 0;
  for (int axis = 0; axis < 3; ++axis) {
    centre[axis] = 0.5 * bounds.lower[axis] + 0.5 * bounds.upper[axis];
    size = std::max(size, bounds.upper[axis] - centre[axis]);
  }
  per_size = size > 0 ? std::ldexp(1.0, -std::clamp(std::ilogb(size) + 1, -1000, 1000)) : 1;
  nodes.reserve(boxes.size() / 4 + 1);
  build(items, boxes, 0);
}

std::int32_t SpatialIndex::Tree::build(std::span<std::uint32_t> items, std::span<const Box> boxes, int depth) {
  const auto index = static_cast<std::int32_t>(nodes.size());
  nodes.emplace_back();
  // The parts of the node: the largest is split until there are enough or only single items.
  std::array<std::span<std::uint32_t>, kWidth> part{items};
  std::size_t parts = 1;
  while (parts < kWidth) {
    const auto largest = std::max_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(parts),
                                          [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (largest->size() < 2) break;
    const std::size_t cut = depth < kDeepest ? split(*largest, boxes) : largest->size() / 2;
    part[parts++] = largest->subspan(cut);
    *largest = largest->first(cut);
  }
  for (std::size_t k = 0; k < kWidth; ++k) {
    std::int32_t child = 0;
    if (k < parts) {
      child = part[k].size() == 1 ? -1 - static_cast<std::int32_t>(part[k][0]) : build(part[k], boxes, depth + 1);
    }
    Node& node = nodes[static_cast<std::size_t>(index)];
    const Box box = k < parts ? box_of(part[k], boxes) : Box{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      node.bounds[0][a][k] = k < parts ? rounded_down(scaled(box.lower[axis], axis)) : kEmptyPlace;
      node.bounds[1][a][k] = k < parts ? rounded_up(scaled(box.upper[axis], axis)) : -kEmptyPlace;
    }
    node.child[k] = child;
  }
  return index;
}

void SpatialIndex::Tree::find(std::span<const HalfSpace> region, const Box& box,
                              std::vector<std::uint32_t>& found) const {
  if (nodes.empty()) return;
  using Floats = float __attribute__((vector_size(kWidth * sizeof(float))));
  using Ints = std::int32_t __attribute__((vector_size(kWidth * sizeof(std::int32_t))));
  const auto floats = [](const std::array<float, kWidth>& eight) {
    Floats v;
    std::memcpy(&v, eight.data(), sizeof v);
    return v;
  };
  // Half-spaces in scaled coordinates u, n · u ≥ offset with the largest of |n| 1: in single precision the normal, each
  // product and the sums are wrong by less than 8 · 2^-24 · 3, as |u| ≤ 1; the offset was found from parts that are no
  // larger than |offset| and |n · centre|.
  struct Limit {
    float x, y, z, offset;
    std::array<std::size_t, 3> far;  // of each axis, the bound of a box that is farthest inside
  };
  constexpr std::size_t kLimits = 64;  // more, of a polygon of many sides, are left aside
  std::array<Limit, kLimits> limits;
  std::size_t limit_count = 0;
  for (const HalfSpace& h : region.first(std::min(region.size(), kLimits))) {
    const double size = std::max({std::fabs(h.normal.x), std::fabs(h.normal.y), std::fabs(h.normal.z)});
    if (!(size > 0)) continue;
    const double at_centre = dot(h.normal, centre), parts = std::fabs(h.offset) + 3 * size * norm(centre);
    const double offset = (h.offset - at_centre - 0x1p-50 * parts) * per_size / size - 0x1p-19;
    limits[limit_count++] = {static_cast<float>(h.normal.x / size),
                             static_cast<float>(h.normal.y / size),
                             static_cast<float>(h.normal.z / size),
                             static_cast<float>(std::clamp(offset, -8.0, 8.0)),
                             {h.normal.x > 0, h.normal.y > 0, h.normal.z > 0}};
  }
  std::array<float, 3> box_lower, box_upper;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    box_lower[a] = rounded_down(std::clamp(scaled(box.lower[axis], axis), -2.0, 2.0));
    box_upper[a] = rounded_up(std::clamp(scaled(box.upper[axis], axis), -2.0, 2.0));
  }

  // First come, first served, so that a node has time to come out of memory before it is needed; the last first where
  // there are many, which adds at most 7 a level.
  constexpr std::size_t kRing = 512, kMany = 256;
  std::array<std::int32_t, kRing> waiting;
  std::size_t first = 0, last = 0;
  waiting[last++] = 0;
  while (first < last) {
    const std::size_t at = last - first < kMany ? first++ : --last;
    const Node& node = nodes[static_cast<std::size_t>(waiting[at % kRing])];
    Ints meets = (floats(node.bounds[0][0]) <= box_upper[0]) & (floats(node.bounds[1][0]) >= box_lower[0]) &
                 (floats(node.bounds[0][1]) <= box_upper[1]) & (floats(node.bounds[1][1]) >= box_lower[1]) &
                 (floats(node.bounds[0][2]) <= box_upper[2]) & (floats(node.bounds[1][2]) >= box_lower[2]);
    for (const Limit& h : std::span(limits).first(limit_count)) {
      const Floats value = h.x * floats(node.bounds[h.far[0]][0]) + h.y * floats(node.bounds[h.far[1]][1]) +
                           h.z * floats(node.bounds[h.far[2]][2]);
      meets &= value >= h.offset;
    }
    using Bytes = signed char __attribute__((vector_size(kWidth)));
    const Bytes bytes = __builtin_convertvector(meets, Bytes);
    std::uint64_t chosen;
    std::memcpy(&chosen, &bytes, sizeof chosen);
    for (chosen &= 0x0101010101010101u; chosen != 0; chosen &= chosen - 1) {
      const std::int32_t child = node.child[static_cast<std::size_t>(std::countr_zero(chosen)) / 8];
      if (child < 0) {
        found.push_back(static_cast<std::uint32_t>(-1 - child));
      } else {
        const Node* next = &nodes[static_cast<std::size_t>(child)];
        for (std::size_t line = 0; line < sizeof(Node); line += 64) {
          __builtin_prefetch(reinterpret_cast<const char*>(next) + line);
        }
        waiting[last++ % kRing] = child;
      }
    }
  }
}

SpatialIndex::SpatialIndex(std::span<const Box> boxes) : tree_(std::make_shared<const Tree>(boxes)) {
  bounds_ = tree_->bounds;
}

SpatialIndex SpatialIndex::changed(std::span<const std::uint32_t> gone, std::span<const Item> added) const {
  SpatialIndex after = *this;
  std::vector<std::uint32_t> left(gone.begin(), gone.end()), found;
  std::ranges::sort(left);
  std::erase_if(after.added_, [&](const Item& item) {
    const bool is_gone = std::ranges::binary_search(left, item.number);
    if (is_gone) found.push_back(item.number);
    return is_gone;
  });
  std::ranges::sort(found);
  std::ranges::set_difference(left, found, std::back_inserter(after.gone_));
  std::ranges::sort(after.gone_);
  after.added_.insert(after.added_.end(), added.begin(), added.end());
  std::vector<Box> boxes;
  for (const Item& item : after.added_) {
    boxes.push_back(item.box);
    after.bounds_.extend(item.box);
  }
  after.added_tree_ = boxes.empty() ? nullptr : std::make_shared<const Tree>(boxes);
  return after;
}

void SpatialIndex::find(std::span<const HalfSpace> region, const Box& box, std::vector<std::uint32_t>& found) const {
  if (!tree_) return;
  const std::size_t first = found.size();
  tree_->find(region, box, found);
  if (!gone_.empty()) {
    const auto is_gone = [&](std::uint32_t item) {
      return gone_.front() <= item && item <= gone_.back() && std::ranges::binary_search(gone_, item);
    };
    found.erase(std::remove_if(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(), is_gone), found.end());
  }
  if (!added_tree_) return;
  const std::size_t first_added = found.size();
  added_tree_->find(region, box, found);
  for (std::size_t k = first_added; k < found.size(); ++k) found[k] = added_[found[k]].number;
}

}  // namespace exitance
