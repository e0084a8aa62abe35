// libFuzzer's entry to one reader, EXITANCE_READER.

#include <stdlib.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "tests/fuzz/reader_under_test.h"

namespace {

/// A folder in memory where there is one, with the mesh that a material file needs beside it.
std::string scratch_folder() {
  std::string name = (std::filesystem::exists("/dev/shm") ? "/dev/shm" : "/tmp") + std::string("/exitance_fuzz_XXXXXX");
  const std::string folder = mkdtemp(name.data());
  std::filesystem::copy(exitance::seed_path("room.obj"), folder + "/room.obj");
  static const struct Removal {
    std::string folder;
    ~Removal() {
      std::error_code ignored;
      std::filesystem::remove_all(folder, ignored);
    }
  } removal{folder};
  return folder;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string folder = scratch_folder();
  static const auto readers = exitance::readers_under_test();
  static const auto reader = std::ranges::find(readers, EXITANCE_READER, &exitance::ReaderUnderTest::name);
  exitance::read_bytes(*reader, folder, {reinterpret_cast<const char*>(data), size});
  return 0;
}
