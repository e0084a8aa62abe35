#pragma once
// A number for a point by which it is found again.

#include <bit>
#include <cstdint>

#include "geometry/vec3.h"

namespace exitance {

/// All bits of the result depend on all of v (what SplitMix64 does to its state; Steele, Lea and Flood 2014).
constexpr std::uint64_t mixed_bits(std::uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
  return v ^ (v >> 31);
}

/// The same for 0 and −0.
inline std::uint64_t hash_of(const Vec3& v) {
  const auto bits = [](double c) { return std::bit_cast<std::uint64_t>(c + 0.0); };
  return mixed_bits(bits(v.x) + mixed_bits(bits(v.y) + mixed_bits(bits(v.z) + 1)));
}

}  // namespace exitance
