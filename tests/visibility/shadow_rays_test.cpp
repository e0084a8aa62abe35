#include "src/visibility/shadow_rays.h"

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

TEST(ShadowRays, IsTheClosedFormWhereNothingHides) {
  const std::vector<Polygon> polygons{ceiling(-1, 1, -1, 1, 1), flipped(ceiling(-2, 2, -2, 2, 0))};
  const PolygonSoup soup(polygons);
  const ShadowRays rays(soup, {.rays = 100, .replicates = 3});
  const SampledFormFactor f = rays.form_factor(kUpwards, {0, {}}, 1);
  EXPECT_NEAR(f.F, 4 * corner_form_factor(1, 1), 1e-15);
  EXPECT_NEAR(f.F_unoccluded, 4 * corner_form_factor(1, 1), 1e-15);
  EXPECT_LT(f.standard_error, 1e-15);
}

TEST(ShadowRays, ClipsSourcesAtTheHorizon) {
  // A wall that stands through the receiver's plane: its lower half counts for nothing.
  const std::vector<Polygon> polygons{{{{1, 1, -1}, {1, 1, 1}, {1, -1, 1}, {1, -1, -1}}, {}},
                                      {{{1, 1, 0}, {1, 1, 1}, {1, -1, 1}, {1, -1, 0}}, {}}};
  const PolygonSoup soup(polygons, std::vector<Role>{Role::unoccluding, Role::unoccluding});
  const ShadowRays rays(soup, {.rays = 64});
  const double whole = rays.form_factor({{0, 0, 0}, {0, 0, 1}}, {0, {}}, 1).F;
  // To a perpendicular rectangle of half-width 1 from the foot up to 1, at distance 1 (Howell's catalogue, B-4, twice).
  const double expected = (std::atan(1.0) - std::atan(std::sqrt(0.5)) * std::sqrt(0.5)) / std::numbers::pi;
  EXPECT_NEAR(whole, expected, 1e-15);
  EXPECT_NEAR(rays.form_factor({{0, 0, 0}, {0, 0, 1}}, {1, {}}, 1).F, expected, 1e-15);
  EXPECT_EQ(rays.form_factor({{0, 0, 2}, {0, 0, 1}}, {0, {}}, 1).F, 0) << "all below the horizon";
}

/// A shadow's edge of general direction, so that no symmetry helps.
std::vector<Polygon> partly_hidden() {
  return {ceiling(-1, 1, -1, 1, 1),
          flipped(ceiling(-2, 2, -2, 2, 0)),
          {{{-0.31, -2, 0.5}, {0.17, 2, 0.5}, {2, 2, 0.5}}, {}}};
}

double exact_form_factor(const PolygonSoup& soup) {
  Viewpoint view(soup);
  view.look_from(kUpwards);
  return view.form_factor({0, {}}).F;
}

/// What many independent estimates of one form factor miss of the truth.
struct Errors {
  double mean = 0, rms = 0, standard_error = 0;  ///< the last one: rms of those that the estimates claim
};

Errors errors_of(const PolygonSoup& soup, const RayOptions& options, double truth, std::uint64_t estimates) {
  const ShadowRays rays(soup, options);
  Errors errors;
  for (std::uint64_t seed = 0; seed < estimates; ++seed) {
    const SampledFormFactor f = rays.form_factor(kUpwards, {0, {}}, seed);
    errors.mean += (f.F - truth) / static_cast<double>(estimates);
    errors.rms += (f.F - truth) * (f.F - truth) / static_cast<double>(estimates);
    errors.standard_error += f.standard_error * f.standard_error / static_cast<double>(estimates);
  }
  errors.rms = std::sqrt(errors.rms);
  errors.standard_error = std::sqrt(errors.standard_error);
  return errors;
}

/// The power of N by which errors fall from 64 to 4,096 rays. 400 estimates know an rms to 1/√800, so that the power is
/// known to √2 / √800 / ln 64 = 0.012.
double rate(const PolygonSoup& soup, Sampler sampler, double truth) {
  const RayOptions few{.rays = 64, .sampler = sampler}, many{.rays = 4096, .sampler = sampler};
  return std::log(errors_of(soup, many, truth, 400).rms / errors_of(soup, few, truth, 400).rms) / std::log(64.0);
}

TEST(ShadowRays, ErrorsFallAsTheTextbookSays) {
  const PolygonSoup soup(partly_hidden());
  const double exact = exact_form_factor(soup);
  EXPECT_NEAR(rate(soup, Sampler::random, exact), -0.5, 0.05);
  // Only strata that an edge crosses count: N^½ of them, each of variance N^-2.
  EXPECT_NEAR(rate(soup, Sampler::stratified, exact), -0.75, 0.05);
  EXPECT_NEAR(rate(soup, Sampler::owen, exact), -0.75, 0.05);
  // The same of a digital shift, but for what one sequence's points happen to have to do with one edge.
  const double sobol = rate(soup, Sampler::sobol, exact);
  EXPECT_GT(sobol, -1);
  EXPECT_LT(sobol, -0.65);
}

TEST(ShadowRays, KernelWeightsAreUnbiasedButForTheirRatio) {
  const PolygonSoup soup(partly_hidden());
  const double exact = exact_form_factor(soup);
  for (const Sampler sampler : {Sampler::random, Sampler::stratified, Sampler::sobol, Sampler::owen}) {
    const Errors errors = errors_of(soup, {.rays = 1024, .sampler = sampler}, exact, 400);
    EXPECT_LT(std::fabs(errors.mean), 4 * errors.rms / 20 + exact / 1024) << to_string(sampler);
  }
}

TEST(ShadowRays, StandardErrorsAreThoseOfIndependentRays) {
  const PolygonSoup soup(partly_hidden());
  const double exact = exact_form_factor(soup);
  const Errors random = errors_of(soup, {.rays = 1024, .sampler = Sampler::random}, exact, 400);
  EXPECT_NEAR(random.standard_error / random.rms, 1, 0.15);
  const Errors replicated = errors_of(soup, {.rays = 64, .replicates = 16, .sampler = Sampler::owen}, exact, 400);
  EXPECT_NEAR(replicated.standard_error / replicated.rms, 1, 0.15);
  const Errors even = errors_of(soup, {.rays = 1024, .sampler = Sampler::owen}, exact, 400);
  EXPECT_GT(even.standard_error, 2 * even.rms) << "too much where points are spread evenly";
}

TEST(ShadowRays, FractionsStayBiased) {
  // Of [−1, 3] × [−1, 1] at height 1 all beyond x = 1 is hidden, half of the area and much less of the light.
  const PolygonSoup soup(
      std::vector<Polygon>{ceiling(-1, 3, -1, 1, 1), flipped(ceiling(-2, 2, -2, 2, 0)), ceiling(0.5, 1.5, -1, 1, 0.5)});
  const double near = 4 * corner_form_factor(1, 1), all = 2 * corner_form_factor(1, 1) + 2 * corner_form_factor(3, 1);
  EXPECT_NEAR(exact_form_factor(soup), near, 1e-12);
  const SampledFormFactor fraction =
      ShadowRays(soup, {.rays = 4096, .replicates = 16, .estimator = Estimator::fraction})
          .form_factor(kUpwards, {0, {}}, 1);
  EXPECT_NEAR(fraction.F, all / 2, 1e-3);
  EXPECT_LT(fraction.standard_error, 1e-4) << "it is sure of what is wrong";
  EXPECT_NEAR(ShadowRays(soup, {.rays = 4096, .replicates = 16}).form_factor(kUpwards, {0, {}}, 1).F, near, 1e-3);
}

TEST(ShadowRays, OneCentreRayIsAllOrNothing) {
  const double all = 4 * corner_form_factor(1, 1);
  for (const auto& [left, F] : {std::pair{0.1, all}, {-0.1, 0.0}}) {
    const PolygonSoup soup(std::vector<Polygon>{ceiling(-1, 1, -1, 1, 1), flipped(ceiling(-2, 2, -2, 2, 0)),
                                                ceiling(left, 1, -1, 1, 0.5)});
    const SampledFormFactor f = ShadowRays(soup, {.estimator = Estimator::centre}).form_factor(kUpwards, {0, {}}, 1);
    EXPECT_NEAR(f.F, F, 1e-15);
    EXPECT_EQ(f.rays, 1u);
    EXPECT_EQ(f.standard_error, std::numeric_limits<double>::infinity());
  }
}

/// Unit squares at distance 1 with a square of half the size at three quarters of it (Shapiro 1985): A F is known to 15
/// digits by another program's quadrature.
TEST(ShadowRays, ExchangesBetweenPolygonsAgreeWithShapiro) {
  constexpr double kShapiro = 0.115620602132415;
  const std::vector<Polygon> polygons{ceiling(0, 1, 0, 1, 1), flipped(ceiling(0, 1, 0, 1, 0)),
                                      ceiling(0.25, 0.75, 0.25, 0.75, 0.75)};
  const PolygonSoup soup(polygons);
  const Source kUpper{0, {}}, kLower{1, {}};
  constexpr double kUnoccluded = 0.19982489569838746;  // parallel unit squares at unit distance (Howell's C-11)
  for (const Sampler sampler : {Sampler::random, Sampler::stratified, Sampler::sobol, Sampler::owen}) {
    const ShadowRays rays(soup, {.rays = 4096, .replicates = 16, .sampler = sampler});
    const SampledFormFactor f = rays.exchange(kLower, kUpper, kUnoccluded, 3);
    EXPECT_NEAR(f.F, kShapiro, 4 * f.standard_error + 2e-6) << to_string(sampler);
    EXPECT_LT(f.standard_error, 1e-3);
    EXPECT_GT(f.standard_error, 0);
    EXPECT_NEAR(rays.exchange(kUpper, kLower, kUnoccluded, 3).F, kShapiro, 4 * f.standard_error + 2e-6);
  }
  EXPECT_EQ(ShadowRays(soup, {.estimator = Estimator::centre}).exchange(kLower, kUpper, kUnoccluded, 1).F, 0);
  EXPECT_EQ(ShadowRays(soup, {}).exchange(kUpper, {2, {}}, 1, 1).F, 0) << "the same way up";
}

TEST(ShadowRays, HalfIsHidden) {
  const auto polygons = half_hidden();
  const PolygonSoup soup(polygons);
  for (const std::uint32_t packet : {8u, 16u})
    for (const bool robust : {false, true}) {
      const ShadowRays rays(soup, {.rays = 1024, .replicates = 16, .packet = packet, .robust = robust});
      const SampledFormFactor f = rays.form_factor(kUpwards, {0, {}}, 3);
      // The shadow's edge lies along a column of the points: the offset of 2^-22 of the scene may turn a column over.
      EXPECT_NEAR(f.F, 2 * corner_form_factor(1, 1), 4 * f.standard_error + 1e-3) << packet << robust;
      EXPECT_GT(f.F, 0);
    }
}

// Rays know nothing of the kernel's geometry and the kernel nothing of theirs: standardised differences must look like
// Student's t of 15 degrees of freedom.
TEST(ShadowRays, AgreesWithExactVisibilityWithinItsStatistics) {
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
    const ShadowRays rays(soup, {.rays = 1024, .replicates = 16});
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

TEST(ShadowRays, NothingLeaksBetweenTrianglesThatShareAnEdge) {
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
    ShadowRays(soup, {.packet = packet}).cast({0.1, 0.02, -0.05}, through, visible);
    EXPECT_EQ(std::ranges::count(visible, 0), std::ssize(through));
  }
}

TEST(ShadowRays, FarFromTheOriginIsAsNear) {
  auto polygons = half_hidden();
  polygons[2].outer[0].y = -0.25;
  const PolygonSoup near(polygons);
  for (Polygon& p : polygons)
    for (Vec3& v : p.outer) v = v + Vec3{0x1p30, -0x1p28, 0x1p29};
  const PolygonSoup far(polygons);
  const Receiver receiver{kUpwards.point + Vec3{0x1p30, -0x1p28, 0x1p29}, kUpwards.normal, kUpwards.facet};
  const RayOptions options{.rays = 256, .replicates = 4};
  const SampledFormFactor f = ShadowRays(near, options).form_factor(kUpwards, {0, {}}, 2);
  EXPECT_EQ(f.F, ShadowRays(far, options).form_factor(receiver, {0, {}}, 2).F);
  EXPECT_GT(f.standard_error, 0);
}

TEST(ShadowRays, SameSeedSameBits) {
  auto polygons = half_hidden();
  polygons[2].outer[0].x = 0.3;
  const PolygonSoup soup(polygons);
  const ShadowRays rays(soup, {.rays = 64}), again(soup, {.rays = 64});
  EXPECT_EQ(rays.form_factor(kUpwards, {0, {}}, 1).F, again.form_factor(kUpwards, {0, {}}, 1).F);
  EXPECT_NE(rays.form_factor(kUpwards, {0, {}}, 1).F, rays.form_factor(kUpwards, {0, {}}, 2).F);
}

TEST(ShadowRays, TheRaysToMeasureAreThoseOfTheEstimate) {
  auto polygons = half_hidden();
  polygons[2].outer[0].x = 0.3;
  const PolygonSoup soup(polygons);
  const ShadowRays rays(soup, {.rays = 200});
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

TEST(ShadowRays, RefusesOptionsOutOfRange) {
  const PolygonSoup soup(half_hidden());
  EXPECT_THROW(ShadowRays(soup, {.rays = 0}), std::invalid_argument);
  EXPECT_THROW(ShadowRays(soup, {.replicates = 0}), std::invalid_argument);
  EXPECT_THROW(ShadowRays(soup, {.packet = 4}), std::invalid_argument);
  EXPECT_THROW(ShadowRays(soup, {.estimator = Estimator::hemisphere}), std::invalid_argument);
  EXPECT_THROW(ShadowRays(soup, {.offset = -1}), std::invalid_argument);
  EXPECT_THROW(ShadowRays(soup, {.offset = std::nan("")}), std::invalid_argument);
}

TEST(ShadowRays, ASceneWithoutOccludersHidesNothing) {
  const PolygonSoup soup(half_hidden(), std::vector<Role>(3, Role::unoccluding));
  const SampledFormFactor f = ShadowRays(soup, {.rays = 16}).form_factor(kUpwards, {0, {}}, 1);
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

TEST(ShadowRays, LeavesTheFloatingPointModeAndThePredicatesAlone) {
  const unsigned before = float_mode();
  ASSERT_EQ(before & (_MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON), 0u);
  const auto polygons = half_hidden();
  const PolygonSoup soup(polygons);
  const ShadowRays rays(soup, {.rays = 256});
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

TEST(ShadowRays, KeepsAModeThatWasSetBefore) {
  const PolygonSoup soup(half_hidden());
  const ShadowRays rays(soup, {.rays = 256});
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
