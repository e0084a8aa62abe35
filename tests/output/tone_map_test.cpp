#include "src/output/tone_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace exitance {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

TEST(RgbOfBands, ThreeAreColoursOthersGrey) {
  EXPECT_THAT(rgb_of_bands(std::vector<double>{1, 2, 3}), ElementsAre(1, 2, 3));
  EXPECT_THAT(rgb_of_bands(std::vector<double>{4}), ElementsAre(4, 4, 4));
  EXPECT_THAT(rgb_of_bands(std::vector<double>{1, 2, 3, 6}), ElementsAre(3, 3, 3));
}

TEST(BrightLuminance, IsExceededByOnePercent) {
  std::vector<std::pair<double, double>> shown;
  for (int i = 1; i <= 1000; ++i) shown.emplace_back(i, 2.0);
  EXPECT_EQ(bright_luminance(shown), 991);
  EXPECT_EQ(bright_luminance({}), 0);
}

TEST(ToneMap, ShowsBrightThingsBrightAndSourcesWhite) {
  const ToneMap map(50);
  EXPECT_THAT(map({50, 50, 50}), ElementsAre(DoubleNear(0.8, 1e-12), DoubleNear(0.8, 1e-12), DoubleNear(0.8, 1e-12)));
  EXPECT_THAT(srgb(map({2000, 1500, 700})), ElementsAre(255, 255, 255));
  EXPECT_THAT(map({0, 0, 0}), ElementsAre(0, 0, 0));
  EXPECT_THAT(map({-1, 0, 0}), ElementsAre(0, 0, 0));
}

TEST(ToneMap, RisesWithoutAJump) {
  const ToneMap map(1);
  double last = 0;
  for (double x = 0; x < 4; x += 1e-3) {
    const double y = map({x, 0, 0})[0];
    EXPECT_GE(y, last);
    EXPECT_LT(y - last, 1e-3);
    EXPECT_LT(y, 1);
    last = y;
  }
}

TEST(ToneMap, OfDarknessIsBlack) {
  EXPECT_THAT(ToneMap(0)({0, 0, 0}), ElementsAre(0, 0, 0));
}

TEST(Srgb, HasTheStandardsValues) {
  // IEC 61966-2-1: linear 0.2140 is the code 127.5, 0.0031308 joins line and power.
  EXPECT_THAT(srgb({0, 1, 0.21404}), ElementsAre(0, 255, testing::AnyOf(127, 128)));
  EXPECT_THAT(srgb({0.0031308, 0.5, 2}), ElementsAre(10, 188, 255));
}

}  // namespace
}  // namespace exitance
