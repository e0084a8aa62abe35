#include "src/output/heat_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(HeatMap, ColoursByTheLogarithmAndPrintsMarks) {
  const ScratchFolder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const HeatMap map{.title = "a < b",
                    .row_names = {"one", "two"},
                    .panels = {{"left", {"x", "y"}, {{{1e-4, ""}, {1, "7"}}, {{1e-2, ""}, {0, ""}}}},
                               {"right", {"z"}, {{{nan, ""}}, {{1e9, ""}}}}},
                    .lowest = 1e-4,
                    .highest = 1,
                    .scale_label = "error",
                    .note = "made & noted"};
  write_heat_map(folder / "map.svg", map);
  const std::string svg = contents(folder / "map.svg");
  EXPECT_THAT(svg, HasSubstr("a &lt; b"));
  EXPECT_THAT(svg, HasSubstr("made &amp; noted"));
  EXPECT_THAT(svg, HasSubstr(">7</text>"));
  const auto fields = [&](const std::string& colour) {
    const std::string field = "height=\"16\" fill=\"" + colour + "\"";
    std::size_t count = 0;
    for (auto at = svg.find(field); at != std::string::npos; at = svg.find(field, at + 1)) ++count;
    return count;
  };
  EXPECT_EQ(fields("#4575b4"), 1u) << "the lowest";
  EXPECT_EQ(fields("#ffffbf"), 1u) << "half way of the logarithms";
  EXPECT_EQ(fields("#d73027"), 2u) << "the highest, and beyond";
  EXPECT_EQ(fields("#fff"), 2u) << "0 and NaN have no colour";
}

}  // namespace
}  // namespace exitance
