#pragma once
// Form factors to one source by rays between the two: what exact visibility is compared with.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/visibility/contacts.h"
#include "src/visibility/pair_counts.h"
#include "src/visibility/ray_caster.h"
#include "src/visibility/ray_options.h"
#include "src/visibility/sample_points.h"

namespace exitance {

/// A form factor as rays estimate it; or A_i F_ij [m²] of two polygons.
struct SampledFormFactor {
  double F = 0;
  /// From the spread of the replicates; with a single one, as if its rays were independent; infinite for
  /// Estimator::centre. Nothing bounds the error: what no ray has met is in no spread.
  double standard_error = 0;
  double F_unoccluded = 0;    ///< what it would be without occluders, by Lambert's formula
  std::uint64_t rays = 0;     ///< that were cast
  std::uint64_t arrived = 0;  ///< of them

  /// The pair's class, as the rays tell.
  std::uint64_t& count_in(PairCounts& pairs) const;
};

/// The same of several pieces whose rays are independent.
class SampledSum {
 public:
  void add(const SampledFormFactor& f, double times = 1);
  SampledFormFactor value() const;

 private:
  SampledFormFactor sum_;
  double variance_ = 0;
};

/// Any number of threads may ask at once.
class ShadowRays {
 public:
  /// Keeps a reference to the soup. Throws std::invalid_argument on options out of range and for
  /// Estimator::hemisphere, which asks for no single source, std::runtime_error when Embree fails.
  ShadowRays(const PolygonSoup& soup, const RayOptions& options);

  /// Whether something lies on the receiver, which then sees nothing. Rays do not find out: form_factor has no meaning
  /// there. Always false for a receiver on no facet and without RayOptions::contacts.
  bool covered(const Receiver& receiver) const;

  /// F from the receiver to the visible part of the source, from whichever side it is seen, with the source clipped at
  /// the receiver's horizon, by the estimator asked for. The points on the source are drawn from `seed`: give each
  /// question its own.
  SampledFormFactor form_factor(const Receiver& receiver, const Source& source, std::uint64_t seed) const;

  /// A_i F_ij = A_j F_ji of two convex, planar polygons, each clipped by the other's plane: rays between points spread
  /// over both. `unoccluded`: what it would be without occluders. Loops run counter-clockwise seen from the front.
  SampledFormFactor exchange(const Source& i, const Source& j, double unoccluded, std::uint64_t seed) const;

  /// Where form_factor would cast its first replicate's rays from and to: for measuring rays alone.
  struct Rays {
    Vec3 from;
    std::vector<Vec3> to;
  };
  Rays shadow_rays(const Receiver& receiver, const Source& source, std::uint64_t seed) const;

  /// visible[k] = 1 where nothing stands between `from` and to[k], else 0. REQUIRES: visible is as long as `to`.
  void cast(const Vec3& from, std::span<const Vec3> to, std::span<std::uint8_t> visible) const {
    caster_.cast({&from, 1}, to, visible);
  }

  const RayOptions& options() const { return options_; }

 private:
  template <std::size_t D, class RayOf, class Cast>
  SampledFormFactor sample(const SamplePoints<D>& samples, double unoccluded, std::uint64_t seed, const RayOf& ray_of,
                           const Cast& cast) const;

  const PolygonSoup* soup_;
  RayOptions options_;
  SamplePoints<2> on_source_;
  SamplePoints<4> on_both_;
  RayCaster caster_;
  std::optional<Contacts> contacts_;
};

}  // namespace exitance
