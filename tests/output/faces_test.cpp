#include "src/output/faces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace exitance {
namespace {

using testing::ElementsAre;

std::vector<Vec3> rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
}

TEST(Faces, NeighboursOfOneSurfaceShareTheirCorners) {
  Faces faces(1e-9);
  faces.add(0, 0, 0, rectangle(0, 0, 1, 1));
  faces.add(0, 0, 1, rectangle(1 + 5e-10, -3e-10, 2, 1));
  EXPECT_EQ(faces.points().size(), 6u);
  EXPECT_THAT(faces.corners(1), ElementsAre(1, 4, 5, 2));
  EXPECT_EQ(faces.area(0), 1);
}

TEST(Faces, SurfacesDoNotShareCorners) {
  Faces faces(1e-9);
  faces.add(0, 0, 0, rectangle(0, 0, 1, 1));
  faces.add(1, 1, 1, rectangle(0, 0, 1, 1));
  EXPECT_EQ(faces.points().size(), 8u);
}

TEST(Faces, CloseButDistinctCornersStayApart) {
  Faces faces(1e-9);
  faces.add(0, 0, 0, rectangle(0, 0, 1, 1));
  faces.add(0, 0, 1, rectangle(1 + 1e-8, 0, 2, 1));
  EXPECT_EQ(faces.points().size(), 8u);
}

TEST(Faces, MergingDoesNotDependOnWhereTheGridFalls) {
  // Corners an ulp apart all along an edge, at coordinates of either sign.
  for (double x = -3; x < 3; x += 0.0137) {
    for (const double merge_distance : {0.0, 1e-9, 1e-3}) {
      Faces faces(merge_distance);
      faces.add(0, 0, 0, rectangle(x - 1, 0, x, 1));
      const double beside = merge_distance > 0 ? std::nextafter(x, 9.0) : x;
      faces.add(0, 0, 1, rectangle(beside, 0, x + 1, 1));
      EXPECT_EQ(faces.points().size(), 6u) << x;
    }
  }
}

TEST(PointAverages, WeighByArea) {
  Faces faces(1e-9);
  faces.add(0, 0, 0, rectangle(0, 0, 1, 1));
  faces.add(0, 0, 1, rectangle(1, 0, 4, 1));
  const std::vector<double> values{8, 80, 4, 40};  // two components
  EXPECT_THAT(point_averages(faces, values, 2), ElementsAre(8, 80, 5, 50, 5, 50, 8, 80, 4, 40, 4, 40));
}

TEST(PointAverages, HiddenElementsAreLeftOut) {
  Faces faces(1e-9);
  faces.add(0, 0, 0, rectangle(0, 0, 1, 1));
  faces.add(0, 0, 1, rectangle(1, 0, 2, 1));
  const std::vector<double> values{0, 4};
  const std::vector<std::uint8_t> hidden{1, 0};
  EXPECT_THAT(point_averages(faces, values, 1, hidden), ElementsAre(0, 4, 4, 0, 4, 4));
}

}  // namespace
}  // namespace exitance
