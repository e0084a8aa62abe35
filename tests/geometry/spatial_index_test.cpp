#include "geometry/spatial_index.h"

#include <gtest/gtest.h>

#include <random>

namespace exitance {
namespace {

/// Largest value of the half-space's functional over the box, by its corners.
double reach(const HalfSpace& h, const Box& b) {
  double best = -std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 v{(corner & 1) != 0 ? b.upper.x : b.lower.x, (corner & 2) != 0 ? b.upper.y : b.lower.y,
                 (corner & 4) != 0 ? b.upper.z : b.lower.z};
    best = std::max(best, dot(h.normal, v) - h.offset);
  }
  return best;
}

struct Found {
  std::size_t needed = 0, returned = 0;
};

/// Searches at random among random boxes of a scene of the size, about the origin; every box that meets the region must
/// be among those found.
Found search_at_random(double size, const Vec3& origin, bool flat, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&](double scale) {
    return Vec3{uniform(random) * scale, uniform(random) * scale, uniform(random) * scale};
  };
  std::vector<Box> boxes(500);
  for (Box& b : boxes) {
    const Vec3 c = origin + point(size), d = point(0.05 * size);
    b.extend(c);
    b.extend(flat ? c : c + d);
  }
  boxes[17] = {};
  const SpatialIndex index(boxes);
  Found total;
  std::vector<std::uint32_t> found;
  for (int search = 0; search < 1000; ++search) {
    std::vector<HalfSpace> region;
    for (int k = 0; k < 4; ++k) {
      const Vec3 normal = point(1), through = origin + point(0.7 * size);
      region.push_back({normal, dot(normal, through) - 1e-12 * norm(normal) * (norm(through) + size)});
    }
    Box box;
    box.extend(origin + point(size));
    box.extend(origin + point(size));
    found.clear();
    index.find(region, box, found);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
    EXPECT_FALSE(std::binary_search(found.begin(), found.end(), 17u));
    total.returned += found.size();
    for (std::uint32_t k = 0; k < boxes.size(); ++k) {
      const bool meets = k != 17 && boxes[k].overlaps(box) &&
                         std::ranges::all_of(region, [&](const HalfSpace& h) { return reach(h, boxes[k]) >= 0; });
      total.needed += meets;
      if (meets) {
        EXPECT_TRUE(std::binary_search(found.begin(), found.end(), k)) << "box " << k;
      }
    }
  }
  return total;
}

TEST(Box, HoldsItsBoundaryAndMeetsWhatTouches) {
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    for (const double side : {-1.0, 1.0}) {
      const auto shifted = [&](double by) { return Box{box.lower + side * by * axis, box.upper + side * by * axis}; };
      EXPECT_TRUE(box.contains(side * axis));
      EXPECT_FALSE(box.contains(side * 1.5 * axis));
      EXPECT_TRUE(box.contains(side * 1.5 * axis, 0.5));
      EXPECT_FALSE(box.contains(side * 1.75 * axis, 0.5));
      EXPECT_TRUE(box.overlaps(shifted(2)));
      EXPECT_FALSE(box.overlaps(shifted(2.5)));
    }
  }
}

TEST(SpatialIndex, LeavesNothingOut) {
  for (const double size : {1.0, 1e-9, 3e7}) {
    for (const bool flat : {false, true}) {
      const Found all = search_at_random(size, {}, flat, 1);
      EXPECT_GT(all.needed, 200u);
      EXPECT_LT(all.returned, 2 * all.needed) << size;
    }
  }
}

TEST(SpatialIndex, LeavesNothingOutFarFromTheOrigin) {
  EXPECT_GT(search_at_random(1, {1e6, -1e6, 3e5}, false, 2).needed, 200u);
  EXPECT_GT(search_at_random(1e-3, {1e6, 1e6, 1e6}, true, 3).needed, 200u);
}

TEST(SpatialIndex, FindsWhatOnlyTouches) {
  std::vector<Box> boxes(100);
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    const double x = 0.1 * static_cast<double>(k);
    boxes[k].extend(Vec3{x, 0, 0});
    boxes[k].extend(Vec3{x + 0.1, 1, 0});
  }
  const SpatialIndex index(boxes);
  std::vector<std::uint32_t> found;
  Box point;
  point.extend(Vec3{boxes[40].upper.x, 1, 0});
  index.find(point, found);
  EXPECT_NE(std::ranges::find(found, 40u), found.end());
  found.clear();
  const std::vector<HalfSpace> touching{{{0, 0, 1}, 0}, {{1, 0, 0}, boxes[99].upper.x}};
  index.find(touching, index.bounds(), found);
  EXPECT_NE(std::ranges::find(found, 99u), found.end());
}

TEST(SpatialIndex, OfManyCoincidentBoxesFindsAll) {
  Box one;
  one.extend(Vec3{1, 2, 3});
  one.extend(Vec3{2, 3, 4});
  const SpatialIndex index(std::vector<Box>(1000, one));
  std::vector<std::uint32_t> found;
  index.find(one, found);
  EXPECT_EQ(found.size(), 1000u);
}

TEST(SpatialIndex, OfNothingFindsNothing) {
  std::vector<std::uint32_t> found;
  SpatialIndex(std::vector<Box>(3)).find(Box{}, found);
  SpatialIndex().find(Box{}, found);
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace exitance
