#pragma once
// Numbers in binary files.

#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace exitance {

/// The number stored at an offset. REQUIRES: offset + sizeof(T) ≤ bytes.size().
template <typename T>
T load(std::string_view bytes, std::size_t offset, std::endian order) {
  char raw[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    raw[order == std::endian::native ? i : sizeof(T) - 1 - i] = bytes[offset + i];
  }
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

}  // namespace exitance
