#pragma once
// Every reader of files, as one function of bytes.

#include <span>
#include <string>
#include <vector>

namespace exitance {

struct ReaderUnderTest {
  std::string name;
  std::vector<std::string> seeds;  ///< files in tests/fuzz/seeds
  std::string file;                ///< the name that the bytes get
  void (*read)(const std::string& path);
};

std::span<const ReaderUnderTest> readers_under_test();

std::string seed_path(const std::string& name);

/// Puts into the folder what some readers want beside their file: a sound mesh and its materials, a report of a
/// solution.
void copy_companions(const std::string& folder);

/// Writes the bytes into the folder and reads them. What a reader may throw is caught: InputError, LimitError, and
/// invalid cases.
void read_bytes(const ReaderUnderTest& reader, const std::string& folder, const std::string& bytes);

}  // namespace exitance
