#pragma once
// Files damaged on purpose.

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/output/scratch_folder.h"

namespace exitance {

inline void put(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

/// The bytes with some bits of one of them flipped.
inline std::string flipped(std::string bytes, std::size_t at, unsigned bits = 0xff) {
  bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ bits);
  return bytes;
}

}  // namespace exitance
