#include "src/output/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <limits>

#include "src/scene/input_error.h"
#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string drawn(const Plot& plot) {
  const ScratchFolder scratch;
  write_plot(scratch / "plot.svg", plot);
  boost::property_tree::ptree tree;
  boost::property_tree::read_xml((scratch / "plot.svg").string(), tree);  // throws unless it is well-formed
  return contents(scratch / "plot.svg");
}

TEST(PlotTest, AxesSpanWholeDecadesAndPointsLieByTheirLogarithms) {
  const std::string svg = drawn({"T", "x", "y", {{"one", {{1, 1e-2}, {10, 1e-1}, {100, 1}}}}});
  EXPECT_THAT(svg, HasSubstr(">1e0</text>"));
  EXPECT_THAT(svg, HasSubstr(">1e2</text>"));
  EXPECT_THAT(svg, HasSubstr(">1e-2</text>"));
  EXPECT_THAT(svg, Not(HasSubstr(">1e3</text>")));
  // The corners of the frame and its middle.
  EXPECT_THAT(svg, HasSubstr("M80.00 420.00 L295.00 235.00 L510.00 50.00"));
}

TEST(PlotTest, WhatHasNoLogarithmIsLeftOutWithTheLineToIt) {
  const std::string svg =
      drawn({"", "", "", {{"gap", {{1, 1}, {2, 0}, {10, 10}, {std::numeric_limits<double>::infinity(), 1}}}}});
  EXPECT_THAT(svg, HasSubstr("M80.00 420.00 M510.00 50.00"));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(PlotTest, NamesAreEscapedAndEmptyPlotsDrawn) {
  EXPECT_THAT(drawn({"a < b & c", "", "", {}}), HasSubstr("a &lt; b &amp; c"));
  EXPECT_THAT(drawn({"", "", "", {}, "made with x < y"}), HasSubstr("made with x &lt; y"));
}

TEST(PlotTest, AFileThatCannotBeWrittenIsNamed) {
  EXPECT_THROW(write_plot("/nowhere/plot.svg", {}), InputError);
}

}  // namespace
}  // namespace exitance
