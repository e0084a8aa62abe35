#pragma once
// Four numbers computed with side by side, by the vector extension of GCC and Clang: every operation is the scalar one,
// rounded the same way, so that no result depends on the machine's vector width. Most polygons have no more corners.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <experimental/simd>

namespace exitance {

inline constexpr std::size_t kLanes = 4;

using Doubles = double __attribute__((vector_size(kLanes * sizeof(double))));

[[gnu::always_inline]] inline Doubles load(const double* four) {
  Doubles v;
  std::memcpy(&v, four, sizeof v);
  return v;
}
[[gnu::always_inline]] inline void store(const Doubles& v, double* four) {
  std::memcpy(four, &v, sizeof v);
}

[[gnu::always_inline]] inline Doubles square_root(const Doubles& v) {
  using Four = std::experimental::simd<double, std::experimental::simd_abi::deduce_t<double, kLanes>>;
  alignas(64) double four[kLanes];
  store(v, four);
  sqrt(Four(four, std::experimental::element_aligned)).copy_to(four, std::experimental::element_aligned);
  return load(four);
}

/// Four signs, or a choice among four: one byte each, the first in the lowest; −1 is 0xff.
using SignBytes = std::uint32_t;
inline constexpr SignBytes kOnes = 0x01010101u;

inline SignBytes zero_bytes(SignBytes s) {
  return ~s & kOnes;
}
inline SignBytes negative_bytes(SignBytes s) {
  return (s >> 7) & kOnes;
}
inline SignBytes positive_bytes(SignBytes s) {
  return s & ~(s >> 7) & kOnes;
}
inline int sign_byte(SignBytes s, std::size_t k) {
  return static_cast<std::int8_t>(s >> (8 * k));
}
inline void set_sign_byte(SignBytes& s, std::size_t k, int sign) {
  s = (s & ~(SignBytes{0xff} << (8 * k))) | (SignBytes{static_cast<std::uint8_t>(sign)} << (8 * k));
}
/// Signs of values that exceed their errors, 0 for the others.
[[gnu::always_inline]] inline SignBytes certain_signs(const Doubles& value, const Doubles& error) {
  using Bytes = signed char __attribute__((vector_size(kLanes)));
  const Bytes bytes = __builtin_convertvector((value < -error) - (value > error), Bytes);
  SignBytes signs;
  std::memcpy(&signs, &bytes, sizeof signs);
  return signs;
}
/// Calls f(k) for every byte of a choice (0 or 1 a byte), ascending.
template <class F>
void for_each_byte(SignBytes chosen, const F& f) {
  for (; chosen != 0; chosen &= chosen - 1) f(static_cast<std::size_t>(std::countr_zero(chosen)) / 8);
}

}  // namespace exitance
