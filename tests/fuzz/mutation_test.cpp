// Readers and files that are nearly right: no crash, no error but the typed ones, no memory beyond what the input
// justifies, none of it kept. EXITANCE_MUTATIONS tells how many inputs a reader gets; the input in hand is kept in the
// scratch folder, where a crash leaves it. --gtest_output=json:FILE also tells the slowest input's processor time.

#include "tests/fuzz/mutation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>

#include "tests/fuzz/memory_request.h"
#include "tests/fuzz/reader_under_test.h"
#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

int mutations() {
  const char* given = std::getenv("EXITANCE_MUTATIONS");
  return given != nullptr ? std::atoi(given) : 800;
}

/// Bytes that so many inputs may leave behind. libhdf5 1.10 loses what it has read of a damaged object header.
std::size_t most_kept(const ReaderUnderTest& reader, int inputs) {
  const std::size_t of_each = reader.file.ends_with(".h5") ? 128 : 0;
  return (std::size_t{1} << 16) + of_each * static_cast<std::size_t>(inputs);
}

class Mutations : public testing::TestWithParam<ReaderUnderTest> {};

TEST_P(Mutations, AreReadOrRefused) {
  const ReaderUnderTest& reader = GetParam();
  const ScratchFolder folder;
  copy_companions((folder / "").string());
  std::vector<std::string> seeds;
  for (const std::string& name : reader.seeds) seeds.push_back(contents(seed_path(name)));
  for (const std::string& seed : seeds) {
    EXPECT_NO_THROW(reader.read([&] {
      std::ofstream(folder / reader.file, std::ios::binary) << seed;
      return (folder / reader.file).string();
    }()))
        << "the seed itself is sound";
  }
  const int count = mutations(), warm = count / 4;  // by then libraries have filled what they keep on purpose
  std::size_t held = 0;
  std::clock_t slowest = 0;
  for (int k = 0; k < count; ++k) {
    if (k == warm) held = memory_held();
    Random random(reader.name + "/" + std::to_string(k));
    const std::string bytes = mutated(seeds, random);
    forget_memory_requests();
    const std::clock_t start = std::clock();
    try {
      read_bytes(reader, (folder / "").string(), bytes);
    } catch (const std::exception& other) {
      ADD_FAILURE() << reader.name << "/" << k << ": " << typeid(other).name() << ": " << other.what();
    }
    slowest = std::max(slowest, std::clock() - start);
    EXPECT_LE(largest_memory_request(), (std::size_t{1} << 22) + 4096 * bytes.size()) << reader.name << "/" << k;
  }
  const std::size_t end = memory_held(), kept = end > held ? end - held : 0;
  RecordProperty("slowest_ms", std::to_string(1e3 * static_cast<double>(slowest) / CLOCKS_PER_SEC));
  RecordProperty("kept_bytes", std::to_string(kept));
  EXPECT_LE(kept, most_kept(reader, count)) << reader.name << " keeps memory";
}

INSTANTIATE_TEST_SUITE_P(Readers, Mutations, testing::ValuesIn(readers_under_test()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace exitance
