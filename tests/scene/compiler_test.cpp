// What the compiler must not get wrong. See cmake/compile_options.cmake.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace exitance {
namespace {

[[gnu::noinline]] std::vector<double> two_of_a_kind_and_two_zeros() {
  return {0.2, 0.2, 0, 0};
}

TEST(Compiler, StoresLiteralsAsTheyAreWritten) {
  EXPECT_THAT(two_of_a_kind_and_two_zeros(), testing::ElementsAre(0.2, 0.2, 0, 0));
}

}  // namespace
}  // namespace exitance
