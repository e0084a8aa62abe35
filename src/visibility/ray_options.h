#pragma once
// How rays sample visibility.

#include <cstdint>
#include <string>

#include "src/visibility/sample_points.h"

namespace exitance {

/// What is made of the rays.
enum class Estimator : std::uint8_t {
  /// Rays to points spread over the source, each weighted by its kernel cos cos / r²: F₀ Σ w V / Σ w, F₀ the analytic
  /// form factor without occluders. A ratio of two means: its bias falls as 1 / N, faster than its error.
  kernel,
  /// The same rays, unweighted: F₀ Σ V / N, the share of the source that is seen. Biased wherever the kernel varies
  /// over
  /// a source of which a part is hidden, however many rays there are.
  fraction,
  /// Rays in all directions, as dense as cosθ / π: the share that meets a patch first is its form factor. Unbiased; one
  /// set of rays fills the whole row.
  hemisphere,
  /// One ray between the centres, F₀ or nothing. No number of rays changes it.
  centre
};

struct RayOptions {
  std::uint32_t rays = 1024;     ///< of a replicate; ≥ 1. Powers of two make Sobol points evenest
  std::uint32_t replicates = 1;  ///< independent estimates, of which the mean is taken; ≥ 1
  Sampler sampler = Sampler::sobol;
  Estimator estimator = Estimator::kernel;
  std::uint32_t packet = 16;  ///< rays cast together: 8 or 16
  bool robust = true;         ///< no leaks between triangles that share an edge
  /// By how much of the scene's radius both ends of a ray are moved off their surfaces, along the normals, lest the ray
  /// hits the surface it starts from or goes to; ≥ 0. What lies nearer to a surface than this is not seen as in front
  /// of it, and F errs in proportion to it. The default is 16 roundings of a coordinate; with four, some rays still hit
  /// their own surfaces.
  double offset = 0x1p-20;
  /// Whether rays are told which points lie in contacts (Contacts). If not, those that start and end within one solid,
  /// beyond the surfaces that touch, find nothing between, however many they are.
  bool contacts = true;
  std::uint64_t seed = 1;  ///< of all questions about a scene; each draws its own from it
};

/// Throws std::invalid_argument when a number is out of range.
void check(const RayOptions& options);

std::string to_string(Estimator estimator);

}  // namespace exitance
