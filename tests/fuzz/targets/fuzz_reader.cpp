// libFuzzer's entry to the reader that the environment names in EXITANCE_READER.

#include <stdlib.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/fuzz/reader_under_test.h"

namespace {

/// A folder in memory where there is one, with what some files need beside them.
std::string scratch_folder() {
  std::string name = (std::filesystem::exists("/dev/shm") ? "/dev/shm" : "/tmp") + std::string("/exitance_fuzz_XXXXXX");
  const std::string folder = mkdtemp(name.data());
  exitance::copy_companions(folder);
  static const struct Removal {
    std::string folder;
    ~Removal() {
      std::error_code ignored;
      std::filesystem::remove_all(folder, ignored);
    }
  } removal{folder};
  return folder;
}

const exitance::ReaderUnderTest& reader() {
  const char* const given = std::getenv("EXITANCE_READER");
  const std::string name = given != nullptr ? given : "";
  const auto readers = exitance::readers_under_test();
  const auto found = std::ranges::find(readers, name, &exitance::ReaderUnderTest::name);
  if (found != readers.end()) return *found;
  std::fprintf(stderr, "EXITANCE_READER is \"%s\"; give one of", name.c_str());
  for (const auto& one : readers) std::fprintf(stderr, " %s", one.name.c_str());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string folder = scratch_folder();
  static const exitance::ReaderUnderTest& chosen = reader();
  exitance::read_bytes(chosen, folder, {reinterpret_cast<const char*>(data), size});
  return 0;
}
