#pragma once
// Visibility by shadow rays, in single precision (Embree): what exact visibility is compared with.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"
#include "geometry/viewpoint.h"

namespace exitance {

struct RayOptions {
  std::uint32_t rays = 1024;     ///< of a replicate; ≥ 1. Powers of two make Sobol points evenest
  std::uint32_t replicates = 1;  ///< independent estimates, of which the mean is taken; ≥ 1, from 2 on with an error
  std::uint32_t packet = 16;     ///< rays cast together: 8 or 16
  bool robust = true;            ///< no leaks between triangles that share an edge
  /// By how much of the scene's radius both ends of a ray are moved off their surfaces, along the normals, lest the ray
  /// hits the surface it starts from or goes to; ≥ 0. What lies nearer to a surface than this is not seen as in front
  /// of it, and F errs in proportion to it. The default is four roundings of a coordinate: with half as much rays begin
  /// to hit their own surfaces.
  double offset = 0x1p-22;
};

/// A form factor as rays estimate it.
struct SampledFormFactor {
  double F = 0;
  double standard_error = 0;  ///< from the spread of the replicates; infinite when there is only one
  double F_unoccluded = 0;    ///< what it would be without occluders, by Lambert's formula
};

/// The occluding facets of a soup as Embree's triangles, in float coordinates relative to the middle of the scene. Any
/// number of threads may ask at once. Flushing denormal numbers to zero is switched on around the casting of rays only.
class RaySampledVisibility {
 public:
  /// Keeps a reference to the soup. Throws std::invalid_argument on options out of range, std::runtime_error when
  /// Embree fails.
  RaySampledVisibility(const PolygonSoup& soup, const RayOptions& options);
  ~RaySampledVisibility();
  RaySampledVisibility(RaySampledVisibility&&) noexcept;
  RaySampledVisibility& operator=(RaySampledVisibility&&) noexcept;

  /// F from the receiver to the visible part of the source, from whichever side it is seen, with the source clipped at
  /// the receiver's horizon: F₀ Σ w V / Σ w, F₀ the analytic form factor without occluders, w each ray's kernel cos cos
  /// / r². Points on the source are Sobol's with a digital shift drawn from `seed`: give each question its own. Unlike
  /// exact visibility it knows no surface by identity: what lies in the plane of receiver or source covers nothing.
  SampledFormFactor form_factor(const Receiver& receiver, const Source& source, std::uint64_t seed) const;

  /// Where form_factor would cast its first replicate's rays from and to: for measuring rays alone.
  struct Rays {
    Vec3 from;
    std::vector<Vec3> to;
  };
  Rays shadow_rays(const Receiver& receiver, const Source& source, std::uint64_t seed) const;

  /// visible[k] = 1 where nothing stands between `from` and to[k], else 0. REQUIRES: visible is as long as `to`.
  void cast(const Vec3& from, std::span<const Vec3> to, std::span<std::uint8_t> visible) const;

 private:
  struct EmbreeScene;
  const PolygonSoup* soup_;
  RayOptions options_;
  std::vector<std::array<std::uint32_t, 2>> points_;  ///< Sobol's, neighbours together
  std::unique_ptr<EmbreeScene> embree_;
};

}  // namespace exitance
