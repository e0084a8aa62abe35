#include "src/visibility/ray_sampled_visibility.h"

#include <gtest/gtest.h>
#include <immintrin.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "geometry/predicates.h"

namespace exitance {
namespace {

/// A number in [low, high) of 53 random bits.
double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

/// A horizontal rectangle that faces down.
Polygon ceiling(double x0, double x1, double y0, double y1, double z) {
  return {{{x0, y0, z}, {x0, y1, z}, {x1, y1, z}, {x1, y0, z}}, {}};
}

Polygon flipped(Polygon polygon) {
  std::ranges::reverse(polygon.outer);
  return polygon;
}

/// Form factor from the origin, facing up, to the rectangle [0, a] × [0, b] at height 1 (Howell's catalogue, B-3).
double corner_form_factor(double a, double b) {
  const double p = std::hypot(1, a), q = std::hypot(1, b);
  return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * std::numbers::pi);
}

constexpr Receiver kUpwards{{0, 0, 0}, {0, 0, 2}, 1};

/// The source [−1, 1]² at height 1, the floor that the receiver lies on, and a plate that hides the half x > 0.
std::vector<Polygon> half_hidden() {
  return {ceiling(-1, 1, -1, 1, 1), flipped(ceiling(-2, 2, -2, 2, 0)), ceiling(0, 1, -1, 1, 0.5)};
}

TEST(RaySampledVisibility, IsTheClosedFormWhereNothingHides) {
  const std::vector<Polygon> polygons{ceiling(-1, 1, -1, 1, 1), flipped(ceiling(-2, 2, -2, 2, 0))};
  const PolygonSoup soup(polygons);
  const RaySampledVisibility rays(soup, {.rays = 100, .replicates = 3});
  const SampledFormFactor f = rays.form_factor(kUpwards, {0, {}}, 1);
  EXPECT_NEAR(f.F, 4 * corner_form_factor(1, 1), 1e-15);
  EXPECT_NEAR(f.F_unoccluded, 4 * corner_form_factor(1, 1), 1e-15);
  EXPECT_LT(f.standard_error, 1e-15);
}

TEST(RaySampledVisibility, ClipsSourcesAtTheHorizon) {
  // A wall that stands through the receiver's plane: its lower half counts for nothing.
  const std::vector<Polygon> polygons{{{{1, 1, -1}, {1, 1, 1}, {1, -1, 1}, {1, -1, -1}}, {}},
                                      {{{1, 1, 0}, {1, 1, 1}, {1, -1, 1}, {1, -1, 0}}, {}}};
  const PolygonSoup soup(polygons, std::vector<Role>{Role::unoccluding, Role::unoccluding});
  const RaySampledVisibility rays(soup, {.rays = 64});
  const double whole = rays.form_factor({{0, 0, 0}, {0, 0, 1}}, {0, {}}, 1).F;
  // To a perpendicular rectangle of half-width 1 from the foot up to 1, at distance 1 (Howell's catalogue, B-4, twice).
  const double expected = (std::atan(1.0) - std::atan(std::sqrt(0.5)) * std::sqrt(0.5)) / std::numbers::pi;
  EXPECT_NEAR(whole, expected, 1e-15);
  EXPECT_NEAR(rays.form_factor({{0, 0, 0}, {0, 0, 1}}, {1, {}}, 1).F, expected, 1e-15);
  EXPECT_EQ(rays.form_factor({{0, 0, 2}, {0, 0, 1}}, {0, {}}, 1).F, 0) << "all below the horizon";
}

TEST(RaySampledVisibility, ErrorsOfSobolPointsFallAsAtAnEdge) {
  // A shadow's edge of general direction, so that no symmetry helps.
  const std::vector<Polygon> polygons{ceiling(-1, 1, -1, 1, 1),
                                      flipped(ceiling(-2, 2, -2, 2, 0)),
                                      {{{-0.31, -2, 0.5}, {0.17, 2, 0.5}, {2, 2, 0.5}}, {}}};
  const PolygonSoup soup(polygons);
  Viewpoint view(soup);
  view.look_from(kUpwards);
  const double exact = view.form_factor({0, {}}).F;
  double previous = std::numeric_limits<double>::infinity();
  for (const std::uint32_t n : {64u, 1024u, 16384u}) {
    const SampledFormFactor f =
        RaySampledVisibility(soup, {.rays = n, .replicates = 32}).form_factor(kUpwards, {0, {}}, 5);
    EXPECT_LT(std::fabs(f.F - exact), 4 * f.standard_error) << n;
    // Near N^-3/4 (and at least N^-0.6; random points: N^-1/2).
    EXPECT_LT(f.standard_error, previous * std::pow(16, -0.6)) << n;
    previous = f.standard_error;
  }
}

TEST(RaySampledVisibility, HalfIsHidden) {
  const auto polygons = half_hidden();
  const PolygonSoup soup(polygons);
  for (const std::uint32_t packet : {8u, 16u})
    for (const bool robust : {false, true}) {
      const RaySampledVisibility rays(soup, {.rays = 1024, .replicates = 16, .packet = packet, .robust = robust});
      const SampledFormFactor f = rays.form_factor(kUpwards, {0, {}}, 3);
      // The shadow's edge lies along a column of the points: the offset of 2^-22 of the scene may turn a column over.
      EXPECT_NEAR(f.F, 2 * corner_form_factor(1, 1), 4 * f.standard_error + 1e-3) << packet << robust;
      EXPECT_GT(f.F, 0);
    }
}

// Rays know nothing of the kernel's geometry and the kernel nothing of theirs: standardised differences must look like
// Student's t of 15 degrees of freedom.
TEST(RaySampledVisibility, AgreesWithExactVisibilityWithinItsStatistics) {
  std::mt19937_64 random(20240607);
  const auto point = [&](double z0, double z1) {
    return Vec3{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, z0, z1)};
  };
  std::vector<double> z;
  for (std::uint64_t scene = 0; scene < 200; ++scene) {
    std::vector<Polygon> polygons{{{point(1, 2), point(1, 2), point(1, 2)}, {}}};
    const std::size_t occluders = 1 + random() % 12;
    for (std::size_t k = 0; k < occluders; ++k) {
      const Vec3 middle = point(0.2, 1.2);
      const auto corner = [&] { return middle + 0.5 * point(-1, 1); };
      polygons.push_back({{corner(), corner(), corner()}, {}});
    }
    const PolygonSoup soup(polygons);
    const Receiver receiver{point(-0.5, 0), point(1, 2)};
    Viewpoint view(soup);
    view.look_from(receiver);
    const double exact = view.form_factor({0, {}}).F;
    const RaySampledVisibility rays(soup, {.rays = 1024, .replicates = 16});
    const SampledFormFactor f = rays.form_factor(receiver, {0, {}}, scene);
    EXPECT_LE(exact, f.F_unoccluded * (1 + 1e-12));
    if (f.F > 0.02 * f.F_unoccluded && f.F < 0.98 * f.F_unoccluded) {
      z.push_back((f.F - exact) / f.standard_error);
    } else {
      EXPECT_NEAR(f.F, exact, 6 * f.standard_error + 1e-3 * f.F_unoccluded);
    }
  }
  ASSERT_GT(z.size(), 80u);
  double mean = 0, square = 0, worst = 0;
  for (const double value : z) {
    mean += value / static_cast<double>(z.size());
    square += value * value / static_cast<double>(z.size());
    worst = std::max(worst, std::fabs(value));
  }
  EXPECT_LT(std::fabs(mean), 4 * std::sqrt(15.0 / 13 / static_cast<double>(z.size())));
  EXPECT_NEAR(std::sqrt(square), std::sqrt(15.0 / 13), 0.3);
  EXPECT_LT(worst, 6);
}

TEST(RaySampledVisibility, NothingLeaksBetweenTrianglesThatShareAnEdge) {
  // An octahedron around the origin, turned so that all coordinates are rounded; rays to its edges and corners.
  const Vec3 u = normalized({1, 2, 3}), v = normalized(cross(u, {0, 0, 1})), w = cross(u, v);
  const std::array<Vec3, 6> corner{u, v, w, -u, -v, -w};
  std::vector<Polygon> polygons;
  std::vector<Vec3> through;
  std::mt19937_64 random(1);
  for (const std::size_t a : {0u, 3u})
    for (const std::size_t b : {1u, 4u})
      for (const std::size_t c : {2u, 5u}) {
        polygons.push_back({{corner[a], corner[b], corner[c]}, {}});
        for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}})
          for (int k = 0; k < 500; ++k) {
            const double t = uniform(random, 0, 1);
            through.push_back(2.0 * ((1 - t) * corner[p] + t * corner[q]));
          }
      }
  const PolygonSoup soup(polygons);
  std::vector<std::uint8_t> visible(through.size(), 7);
  for (const std::uint32_t packet : {8u, 16u}) {
    RaySampledVisibility(soup, {.packet = packet}).cast({0.1, 0.02, -0.05}, through, visible);
    EXPECT_EQ(std::ranges::count(visible, 0), std::ssize(through));
  }
}

TEST(RaySampledVisibility, FarFromTheOriginIsAsNear) {
  auto polygons = half_hidden();
  polygons[2].outer[0].y = -0.25;
  const PolygonSoup near(polygons);
  for (Polygon& p : polygons)
    for (Vec3& v : p.outer) v = v + Vec3{0x1p30, -0x1p28, 0x1p29};
  const PolygonSoup far(polygons);
  const Receiver receiver{kUpwards.point + Vec3{0x1p30, -0x1p28, 0x1p29}, kUpwards.normal, kUpwards.facet};
  const RayOptions options{.rays = 256, .replicates = 4};
  const SampledFormFactor f = RaySampledVisibility(near, options).form_factor(kUpwards, {0, {}}, 2);
  EXPECT_EQ(f.F, RaySampledVisibility(far, options).form_factor(receiver, {0, {}}, 2).F);
  EXPECT_GT(f.standard_error, 0);
}

TEST(RaySampledVisibility, SameSeedSameBits) {
  auto polygons = half_hidden();
  polygons[2].outer[0].x = 0.3;
  const PolygonSoup soup(polygons);
  const RaySampledVisibility rays(soup, {.rays = 64}), again(soup, {.rays = 64});
  EXPECT_EQ(rays.form_factor(kUpwards, {0, {}}, 1).F, again.form_factor(kUpwards, {0, {}}, 1).F);
  EXPECT_NE(rays.form_factor(kUpwards, {0, {}}, 1).F, rays.form_factor(kUpwards, {0, {}}, 2).F);
  EXPECT_EQ(rays.form_factor(kUpwards, {0, {}}, 1).standard_error, std::numeric_limits<double>::infinity());
}

TEST(RaySampledVisibility, TheRaysToMeasureAreThoseOfTheEstimate) {
  auto polygons = half_hidden();
  polygons[2].outer[0].x = 0.3;
  const PolygonSoup soup(polygons);
  const RaySampledVisibility rays(soup, {.rays = 200});
  const auto cast = rays.shadow_rays(kUpwards, {0, {}}, 4);
  std::vector<std::uint8_t> visible(cast.to.size());
  rays.cast(cast.from, cast.to, visible);
  double seen = 0, all = 0;
  for (std::size_t k = 0; k < cast.to.size(); ++k) {
    const double r2 = dot(cast.to[k], cast.to[k]), kernel = cast.to[k].z / (r2 * r2);
    all += kernel;
    seen += visible[k] * kernel;
  }
  const SampledFormFactor f = rays.form_factor(kUpwards, {0, {}}, 4);
  EXPECT_EQ(cast.to.size(), 200u);
  EXPECT_NEAR(f.F, f.F_unoccluded * seen / all, 1e-6);
}

TEST(RaySampledVisibility, RefusesOptionsOutOfRange) {
  const PolygonSoup soup(half_hidden());
  EXPECT_THROW(RaySampledVisibility(soup, {.rays = 0}), std::invalid_argument);
  EXPECT_THROW(RaySampledVisibility(soup, {.replicates = 0}), std::invalid_argument);
  EXPECT_THROW(RaySampledVisibility(soup, {.packet = 4}), std::invalid_argument);
  EXPECT_THROW(RaySampledVisibility(soup, {.offset = -1}), std::invalid_argument);
  EXPECT_THROW(RaySampledVisibility(soup, {.offset = std::nan("")}), std::invalid_argument);
}

TEST(RaySampledVisibility, ASceneWithoutOccludersHidesNothing) {
  const PolygonSoup soup(half_hidden(), std::vector<Role>(3, Role::unoccluding));
  const SampledFormFactor f = RaySampledVisibility(soup, {.rays = 16}).form_factor(kUpwards, {0, {}}, 1);
  EXPECT_NEAR(f.F, 4 * corner_form_factor(1, 1), 1e-15);
}

/// The control bits of the floating-point unit: rounding, masks, flush-to-zero, denormals-are-zero.
unsigned float_mode() {
  return _mm_getcsr() & 0xffc0u;
}

/// Four points whose determinant, of the size of 1e-321, is nothing but denormal numbers.
std::array<Vec3, 4> tiny_points(std::mt19937_64& random) {
  std::array<Vec3, 4> points;
  for (Vec3& p : points) p = 1e-107 * Vec3{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
  return points;
}

TEST(RaySampledVisibility, LeavesTheFloatingPointModeAndThePredicatesAlone) {
  const unsigned before = float_mode();
  ASSERT_EQ(before & (_MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON), 0u);
  const auto polygons = half_hidden();
  const PolygonSoup soup(polygons);
  const RaySampledVisibility rays(soup, {.rays = 256});
  EXPECT_EQ(float_mode(), before);

  std::mt19937_64 random(9);
  StageCounts counts;
  volatile double smallest = std::numeric_limits<double>::denorm_min();
  for (int k = 0; k < 2000; ++k) {
    const auto [a, b, c, d] = tiny_points(random);
    const int sign = orientation(a, b, c, d, counts);
    ASSERT_EQ(sign, orientation_exact(a, b, c, d));
    rays.form_factor(kUpwards, {0, {}}, static_cast<std::uint64_t>(k));
    ASSERT_EQ(orientation(a, b, c, d, counts), sign);
    ASSERT_EQ(orientation_exact(a, b, c, d), sign);
    ASSERT_EQ(float_mode(), before);
    ASSERT_GT(smallest * 1.0, 0);
  }

  // Nor in the threads that Embree built its hierarchy with, or that cast rays.
  std::atomic<int> changed = 0;
  tbb::parallel_for(0, 1000, [&](int k) {
    changed += float_mode() != before;
    rays.form_factor(kUpwards, {0, {}}, static_cast<std::uint64_t>(k));
    changed += float_mode() != before;
  });
  EXPECT_EQ(changed, 0);
}

TEST(RaySampledVisibility, KeepsAModeThatWasSetBefore) {
  const PolygonSoup soup(half_hidden());
  const RaySampledVisibility rays(soup, {.rays = 256});
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | _MM_ROUND_UP);
  const unsigned set = float_mode();
  rays.form_factor(kUpwards, {0, {}}, 1);
  const unsigned after = float_mode();
  _mm_setcsr(before);
  EXPECT_EQ(after, set);
}

}  // namespace
}  // namespace exitance
