#include "src/form_factor/form_factor_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "src/stress/placement.h"
#include "tests/form_factor/closed_forms.h"

namespace exitance {
namespace {

using Loop = std::vector<Vec3>;

const Loop kFloor{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

struct Bounded {
  PolygonSoup soup;
  FormFactorBound bound;

  explicit Bounded(const Loop& source)
      : soup(std::array{Polygon{kFloor, {}}, Polygon{source, {}}}, std::array{Role::patch, Role::patch}),
        bound(soup, {0, {}}, {1, {}}) {}
  /// The greatest form factor from a grid of the cell's points, its corners but for a hair included.
  double seen_from(const AreaCell& cell) const {
    Viewpoint view(soup);
    double greatest = 0;
    constexpr int kSteps = 12;
    for (int i = 0; i <= kSteps; ++i) {
      const double s = std::clamp(static_cast<double>(i) / kSteps, 1e-6, 1 - 1e-6);
      const Vec3 from = first_side(cell, s).at, to = opposite_side(cell, s).at;
      for (int j = 0; j <= kSteps; ++j) {
        const double t = std::clamp(static_cast<double>(j) / kSteps, 1e-6, 1 - 1e-6);
        view.look_from({from + t * (to - from), {0, 0, 1}, 0});
        const PointFormFactor f = view.form_factor({1, {}}, {}, 1);
        if (f.side == Side::front) greatest = std::max(greatest, f.F);
      }
    }
    return greatest;
  }
};

const AreaCell kWhole{{kFloor[0], kFloor[1], kFloor[2], kFloor[3]}, 4};

TEST(FormFactorBound, IsNoLessThanWhatAnyPointSees) {
  Random random("bound");
  int tight = 0;
  for (int k = 0; k < 200; ++k) {
    const auto point = [&] { return Vec3{random.real(-2, 3), random.real(-2, 3), random.real(-0.5, 3)}; };
    const Bounded b(Loop{point(), point(), point()});
    const auto at = [&] { return Vec3{random.real(0, 1), random.real(0, 1), 0}; };
    AreaCell cell{{at(), at(), at(), Vec3{}}, 3};
    cell.corner[3] = cell.corner[0];
    const double seen = b.seen_from(cell), bound = b.bound.from(cell);
    EXPECT_LE(seen, bound) << k;
    EXPECT_LE(bound, 1);
    tight += seen > 0 && bound < 30 * seen;
  }
  EXPECT_GE(tight, 20);
}

/// Far away it is A cos cos / π r²; a cell of one point high above sees what the closed form says.
TEST(FormFactorBound, OfASmallCellFarAwayIsTheValue) {
  const Bounded b(Loop{{0, 0, 20}, {0, 1, 20}, {1, 1, 20}, {1, 0, 20}});
  const double value = opposite_rectangles(1, 1, 20), bound = b.bound.from(kWhole);
  EXPECT_GE(bound, value);
  EXPECT_LE(bound, 1.3 * value);
}

TEST(FormFactorBound, IsOneWhereTheyMayTouch) {
  EXPECT_EQ(Bounded(Loop{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}).bound.from(kWhole), 1) << "a shared edge";
  EXPECT_EQ(Bounded(Loop{{0.5, 0, -1}, {0.5, 1, -1}, {0.5, 1, 1}, {0.5, 0, 1}}).bound.from(kWhole), 1) << "pierced";
}

TEST(FormFactorBound, IsNothingInThePlaneOrBehind) {
  EXPECT_EQ(Bounded(Loop{{3, 0, 0}, {4, 0, 0}, {4, 1, 0}, {3, 1, 0}}).bound.from(kWhole), 0) << "in the plane";
  EXPECT_EQ(Bounded(Loop{{0, 0, -5}, {0, 1, -5}, {1, 1, -5}, {1, 0, -5}}).bound.from(kWhole), 0) << "below";
  EXPECT_EQ(Bounded(Loop{{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}}).bound.from(kWhole), 0) << "faces away";
}

/// A conic bulges out of its corners as far as its control point.
TEST(FormFactorBound, OfABentCellCoversItsBulge) {
  const Bounded b(Loop{{1.5, 0, 0.1}, {1.5, 0, 1}, {1.5, 1, 1}, {1.5, 1, 0.1}});
  const AreaCell bent{
      {Vec3{0.5, 0.2, 0}, Vec3{0.5, 0.8, 0}, Vec3{0.2, 0.5, 0}, Vec3{0.2, 0.5, 0}}, 3, {{1, 0.5, 0}, 4}};
  EXPECT_LE(b.seen_from(bent), b.bound.from(bent));
  EXPECT_GT(b.seen_from(bent), 0);
}

}  // namespace
}  // namespace exitance
