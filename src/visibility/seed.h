#pragma once
// Random bits that depend on the question only: one seed for all of a scene, and what is drawn from it.

#include <cstdint>

#include "geometry/point_hash.h"

namespace exitance {

/// Whitens a number (the output function of SplitMix64; Steele, Lea and Flood 2014).
constexpr std::uint64_t mixed(std::uint64_t z) {
  return mixed_bits(z + 0x9e3779b97f4a7c15u);
}

/// Number k of the seeds that belong to one; to be mixed before its bits are used.
constexpr std::uint64_t nth_seed(std::uint64_t seed, std::uint64_t k) {
  return seed + k * 0xd1342543de82ef95u;
}

/// The seed of one question of many.
constexpr std::uint64_t question_seed(std::uint64_t seed, std::uint64_t receiver, std::uint64_t source) {
  return mixed(mixed(mixed(seed) ^ receiver) ^ source);
}

}  // namespace exitance
