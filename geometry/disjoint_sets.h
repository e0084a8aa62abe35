#pragma once
// Sets that have no element in common and are united two by two.

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace exitance {

class DisjointSets {
 public:
  /// Of one element each: 0 … count − 1.
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

  /// The least element of the set that holds i.
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t i, std::uint32_t j) {
    const std::uint32_t a = root(i), b = root(j);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace exitance
