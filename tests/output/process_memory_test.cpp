#include "src/output/process_memory.h"

#include <gtest/gtest.h>

#include <vector>

namespace exitance {
namespace {

TEST(PeakMemory, IsAtLeastWhatWeTouch) {
  const std::vector<char> held(64 << 20, 1);
  EXPECT_GE(peak_memory_bytes(), held.size());
  EXPECT_LT(peak_memory_bytes(), std::uint64_t{1} << 40);
}

TEST(AvailableMemory, IsThatOfSomeMachine) {
  EXPECT_GT(available_memory_bytes(), std::uint64_t{16} << 20);
  EXPECT_LT(available_memory_bytes(), std::uint64_t{1} << 50);  // the system says, else it would be 2^64 − 1
}

}  // namespace
}  // namespace exitance
