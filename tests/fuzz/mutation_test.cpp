// Readers and files that are nearly right: no crash, no error but the typed ones, no memory beyond what the input
// justifies. EXITANCE_MUTATIONS tells how many inputs a reader gets; the input in hand is kept in the scratch folder,
// where a crash leaves it.

#include "tests/fuzz/mutation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "tests/fuzz/memory_request.h"
#include "tests/fuzz/reader_under_test.h"
#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

int mutations() {
  const char* given = std::getenv("EXITANCE_MUTATIONS");
  return given != nullptr ? std::atoi(given) : 800;
}

class Mutations : public testing::TestWithParam<ReaderUnderTest> {};

TEST_P(Mutations, AreReadOrRefused) {
  const ReaderUnderTest& reader = GetParam();
  const ScratchFolder folder;
  std::filesystem::copy(seed_path("room.obj"), folder / "room.obj");
  std::filesystem::copy(seed_path("room.mtl"), folder / "room.mtl");
  std::vector<std::string> seeds;
  for (const std::string& name : reader.seeds) seeds.push_back(contents(seed_path(name)));
  for (const std::string& seed : seeds) {
    EXPECT_NO_THROW(reader.read([&] {
      std::ofstream(folder / reader.file, std::ios::binary) << seed;
      return (folder / reader.file).string();
    }()))
        << "the seed itself is sound";
  }
  for (int k = 0; k < mutations(); ++k) {
    Random random(reader.name + "/" + std::to_string(k));
    const std::string bytes = mutated(seeds, random);
    forget_memory_requests();
    try {
      read_bytes(reader, (folder / "").string(), bytes);
    } catch (const std::exception& other) {
      ADD_FAILURE() << reader.name << "/" << k << ": " << typeid(other).name() << ": " << other.what();
    }
    EXPECT_LE(largest_memory_request(), (std::size_t{1} << 22) + 4096 * bytes.size()) << reader.name << "/" << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, Mutations, testing::ValuesIn(readers_under_test()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace exitance
