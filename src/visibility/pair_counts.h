#pragma once
// How pairs of receiver and source end.

#include <cstdint>

namespace exitance {

struct PairCounts {
  std::uint64_t facing_away = 0;  ///< the source's front is not turned to the receiver, or lies below its horizon
  std::uint64_t open = 0;         ///< nothing stands between
  std::uint64_t blocked = 0;      ///< nothing of the source is seen
  std::uint64_t partial = 0;      ///< the rest

  PairCounts& operator+=(const PairCounts& other) {
    facing_away += other.facing_away;
    open += other.open;
    blocked += other.blocked;
    partial += other.partial;
    return *this;
  }
  bool operator==(const PairCounts&) const = default;
};

}  // namespace exitance
