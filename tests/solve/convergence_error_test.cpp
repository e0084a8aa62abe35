#include "src/solve/convergence_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace exitance {
namespace {

using testing::ElementsAre;

/// 250 elements of which those numbered 40, 7 and 200 change most, in this order; one band.
struct Room {
  std::vector<std::uint32_t> elements = std::vector<std::uint32_t>(250);
  std::vector<double> was = std::vector<double>(250, 1.0), reference = was;

  Room() {
    std::iota(elements.begin(), elements.end(), 0u);
    reference[40] = 5;
    reference[7] = -2;
    reference[200] = 3;
  }
};

TEST(ConvergenceError, TheMostChangedAreOneInAHundredAscending) {
  const Room room;
  EXPECT_THAT(most_changed(room.elements, 1, room.reference, room.was), ElementsAre(7, 40, 200));
  EXPECT_THAT(most_changed(std::vector<std::uint32_t>{3, 200, 9}, 1, room.reference, room.was), ElementsAre(200));
}

TEST(ConvergenceError, OfEqualChangesTheFirstCount) {
  const std::vector<std::uint32_t> elements{5, 1, 3};
  const std::vector<double> was(6, 0.0), reference(6, 1.0);
  EXPECT_THAT(most_changed(elements, 1, reference, was), ElementsAre(5));
}

TEST(ConvergenceError, OverTheMostChangedIsThatOfThemAlone) {
  const Room room;
  std::vector<double> current = room.reference;
  current[40] += 1;
  current[0] += 2;
  const auto area = [](std::uint32_t) { return 1.0; };
  const ConvergenceError error = convergence_error(room.elements, area, 1, room.reference, room.was, current);
  EXPECT_NEAR(error.worst_1_percent, std::sqrt(1.0 / (25 + 4 + 9)), 1e-15);
  EXPECT_NEAR(error.all, std::sqrt(5.0 / (247 + 25 + 4 + 9)), 1e-15);
}

}  // namespace
}  // namespace exitance
