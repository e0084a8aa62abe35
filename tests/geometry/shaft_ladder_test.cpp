// Inputs aimed at each stage of what tells whether something stands in a shaft, seen from a point, from a polygon or as
// a shadow volume: at sight, by clipping in doubles, by clipping exactly.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "geometry/open_region.h"
#include "geometry/point_shaft.h"
#include "geometry/shadow_volume.h"
#include "geometry/shaft.h"
#include "src/stress/placement.h"
#include "src/stress/shaft_oracle.h"

namespace exitance {
namespace {

/// How far the item's edge runs from the ridge of the shaft, on its inner or its outer side.
enum class Aim {
  sight,    ///< so far within that it has a corner there, or so far outside that a plane leaves out all of it
  clear,    ///< so that doubles tell, though no corner and no plane by itself does
  rounded,  ///< through it but for the rounding of all coordinates
  hair,     ///< by 2^-70 to 2^-200 of the coordinates' size
  on        ///< through it
};

/// A wedge whose ridge runs from the apex to `end`, its sides through `left` and `right`, and a triangle whose edge
/// passes the ridge half-way.
struct Wedge {
  Vec3 apex, end, left, right;
  std::array<Vec3, 3> item;

  Polygon near_end() const { return {{apex, apex + 0.5 * (left - end), apex + 0.5 * (right - end)}, {}}; }
  Polygon far_end() const { return {{end, right, left}, {}}; }
};

/// Within, the item's edge passes at the height h above the ridge; where h is 0 or less it stays outside.
Wedge aimed(Aim aim, Random& random) {
  const double sign = random.whole(0, 1) == 0 ? 1 : -1;
  double h = 0;
  if (aim == Aim::sight) h = sign > 0 ? 4 : -8;
  if (aim == Aim::clear) h = sign * random.real(0.01, 0.5);
  if (aim == Aim::hair) h = std::ldexp(sign, -random.whole(70, 200));
  const double a = random.whole(1, 9), b = random.whole(-9, 9), s = random.whole(1, 3), t = random.whole(1, 3);
  const Vec3 ridge{a, 0, b}, across{b, 0, -a}, up{0, 1, 0};
  // Doubles hold h beside nothing else: the ridge lies where y is 0.
  const auto at = [&](double along, double y, double beside) { return along * ridge + y * up + beside * across; };
  const bool has_corner_within = aim == Aim::sight && h > 0;
  Wedge wedge{
      {}, at(8, 0, 0), at(8, 2, 1), at(8, 2, -1), {at(4, h, has_corner_within ? 0 : s), at(4, h, -t), at(4, -9, 0)}};
  if (aim != Aim::hair && aim != Aim::on) {
    const Placement turn = random_rotation("turn", {3, -5, 2}, 1, random);
    for (Vec3* v : {&wedge.apex, &wedge.end, &wedge.left, &wedge.right, &wedge.item[0], &wedge.item[1], &wedge.item[2]})
      *v = turn(*v);
  }
  return wedge;
}

/// By rational arithmetic.
bool meets_wedge(const Wedge& w) {
  const auto plane = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return exact_plane({exact_point(a), exact_point(b), exact_point(c)});
  };
  return meets_open({exact_point(w.item[0]), exact_point(w.item[1]), exact_point(w.item[2])},
                    {plane(w.apex, w.end, w.left), plane(w.apex, w.right, w.end)});
}

class ShaftLadder : public testing::TestWithParam<Aim> {
 protected:
  static constexpr int kTimes = 400;
};

TEST_P(ShaftLadder, RegionsAreMetOnTheRungAimedAt) {
  Random random("regions");
  int at_sight = 0, met = 0;
  StageCounts counts, of_far;
  for (int k = 0; k < kTimes; ++k) {
    const Wedge w = aimed(GetParam(), random);
    const bool truth = meets_wedge(w);
    met += truth;
    std::array<Corner, 3> facet;
    for (std::size_t c = 0; c < 3; ++c) facet[c].at = w.item[c];
    const PlanePoints plane{&w.item[0], &w.item[1], &w.item[2]};
    const auto ask = [&](double reach, StageCounts& stages, int& sights) {
      OpenRegion region;
      region.clear(w.apex, reach);
      region.add(w.apex, w.end, w.left);
      region.add(w.apex, w.right, w.end);
      const auto seen = region.meets_at_sight(facet, stages);
      sights += seen.has_value();
      return seen ? *seen : region.meets(facet, plane, stages);
    };
    ASSERT_EQ(ask(1e3, counts, at_sight), truth);
    // Where points may be as far away as that, no double is certain.
    int ignored = 0;
    ASSERT_EQ(ask(1e300, of_far, ignored), truth);
  }
  EXPECT_GT(of_far.exact, GetParam() == Aim::sight ? 0u : unsigned{kTimes} - 1);
  EXPECT_EQ(at_sight, GetParam() == Aim::sight ? kTimes : 0);
  switch (GetParam()) {
    case Aim::sight:
    case Aim::clear:
      EXPECT_EQ(counts.exact, 0u);
      break;
    case Aim::rounded:
      EXPECT_GT(counts.exact, 0.9 * kTimes);
      break;
    default:
      EXPECT_EQ(counts.exact, unsigned{kTimes});
  }
  if (GetParam() == Aim::on) {
    EXPECT_EQ(met, 0);
  } else {
    EXPECT_GT(met, 0.3 * kTimes);
    EXPECT_LT(met, 0.7 * kTimes);
  }
}

TEST_P(ShaftLadder, ShaftsAndShadowsAgreeWithTheOracleOnTheRungAimedAt) {
  Random random("shafts");
  std::uint64_t filter = 0, exact = 0;
  int entered = 0;
  for (int k = 0; k < kTimes / 4; ++k) {
    const Wedge w = aimed(GetParam(), random);
    const std::vector<Polygon> polygons{w.near_end(), w.far_end(), {{w.item.begin(), w.item.end()}, {}}};
    const PolygonSoup soup(polygons);
    ASSERT_EQ(soup.facets().size(), 3u);
    const ShaftEnd near{0, {}}, far{1, {}};
    const ShaftOracle oracle(soup);
    const ExactEnd one = oracle.end(near), other = oracle.end(far);
    ASSERT_TRUE(oracle.face_each_other(one, other));
    const Shaft::Overlap truth = oracle.overlap(one, other, sides_of_hull(one, other), 2);
    const bool enters = truth != Shaft::Overlap::outside;
    ASSERT_EQ(enters, meets_wedge(w));
    entered += enters;

    Shaft shaft(soup, near, far);
    const StageCounts before = shaft.stage_counts();
    ASSERT_EQ(shaft.overlap(2), truth);
    filter += shaft.stage_counts().filter - before.filter;
    exact += shaft.stage_counts().exact - before.exact;

    PointShaft pyramid(soup);
    const Receiver receiver{w.apex, {}};
    pyramid.reset(receiver, far);
    ASSERT_EQ(pyramid.enters(2), enters);
    ASSERT_EQ(pyramid.blocks(2), truth == Shaft::Overlap::blocking);

    const ShadowCaster caster(soup, 2, 3);
    ShadowVolume shadow(caster);
    shadow.set_shooter(far);
    ASSERT_EQ(shadow.of(near) != Shade::outside, enters);
    ASSERT_EQ(shadow.at(receiver) != Shade::outside, enters);
  }
  if (GetParam() == Aim::sight || GetParam() == Aim::clear) {
    EXPECT_GT(filter, kTimes / 4u);
    EXPECT_EQ(exact, 0u);
  } else {
    EXPECT_GT(exact, kTimes / 5u);
  }
  EXPECT_EQ(entered > 0, GetParam() != Aim::on);
}

std::string name_of(const testing::TestParamInfo<Aim>& one) {
  static const std::array<std::string, 5> kNames = {"sight", "clear", "rounded", "hair", "on"};
  return kNames[static_cast<std::size_t>(one.param)];
}

INSTANTIATE_TEST_SUITE_P(Predicates, ShaftLadder,
                         testing::Values(Aim::sight, Aim::clear, Aim::rounded, Aim::hair, Aim::on), name_of);

}  // namespace
}  // namespace exitance
