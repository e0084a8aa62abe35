#include "geometry/half_space_clip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/geometry/rational_points.h"

namespace exitance {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double between(double a, double b) { return a + (b - a) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  Vec3 point() { return {between(-2, 2), between(-2, 2), between(-2, 2)}; }
  Vec3 lattice_point() { return {std::floor(between(-2, 3)), std::floor(between(-2, 3)), std::floor(between(-2, 3))}; }

 private:
  std::mt19937_64 bits_;
};

/// A point of the triangle's plane as far as doubles hold it, or next to that by an ulp along an axis.
Vec3 near_plane(const Loop& t, Random& random) {
  Vec3 v = t[0] + random.between(-1, 2) * (t[1] - t[0]) + random.between(-1, 2) * (t[2] - t[0]);
  const double whither =
      random.between(-1, 1) < 0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
  if (random.between(0, 1) < 0.5) v.z = std::nextafter(v.z, whither);
  return v;
}

TEST(HalfSpaceClip, SignsAreExactHoweverNearThePlane) {
  Random random(11);
  std::array<int, 3> vertices{};
  int clipped = 0, none = 0;
  for (int k = 0; k < 4000; ++k) {
    const bool lattice = k % 2 == 0;
    const auto draw = [&] { return lattice ? random.lattice_point() : random.point(); };
    const std::vector<Loop> plane_loop = {{draw(), draw(), draw()}};
    const auto other = [&] {
      return lattice || random.between(0, 1) < 0.3 ? draw() : near_plane(plane_loop[0], random);
    };
    const std::vector<Loop> facet_loop = {{other(), other(), other()}};
    const Radiator plane(plane_loop), facet(facet_loop);
    if (plane.facets().empty() || facet.facets().empty()) continue;

    const Point a = exact(plane_loop[0][0]), b = exact(plane_loop[0][1]), c = exact(plane_loop[0][2]);
    const Loop& loop = facet.facets()[0].loop;
    std::vector<int> signs;
    for (const Vec3& v : loop) {
      signs.push_back(sign(determinant(b - a, c - a, exact(v) - a)));
      ++vertices[static_cast<std::size_t>(signs.back() + 1)];
    }
    const auto kept = clip_in_front(facet.facets()[0], plane.facets()[0]);
    if (std::ranges::none_of(signs, [](int s) { return s > 0; })) {
      EXPECT_TRUE(kept.empty()) << "nothing of it lies in front";
      ++none;
      continue;
    }
    std::size_t next_kept = 0;
    for (std::uint32_t i = 0; i < signs.size(); ++i) {
      const auto j = static_cast<std::uint32_t>((i + 1) % signs.size());
      if (signs[i] != -1) {
        ASSERT_LT(next_kept, kept.size());
        EXPECT_EQ(kept[next_kept].from, i);
        EXPECT_FALSE(kept[next_kept++].is_crossing());
      }
      if (signs[i] != 0 && signs[j] == -signs[i]) {
        ASSERT_LT(next_kept, kept.size());
        EXPECT_EQ(kept[next_kept].from, i);
        EXPECT_EQ(kept[next_kept++].to, j);
        ++clipped;
      }
    }
    EXPECT_EQ(next_kept, kept.size());
  }
  for (const int count : vertices) EXPECT_GT(count, 200) << "behind, on, in front";
  EXPECT_GT(clipped, 500);
  EXPECT_GT(none, 100);
}

}  // namespace
}  // namespace exitance
