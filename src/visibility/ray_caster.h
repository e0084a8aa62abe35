#pragma once
// Rays against polygons in single precision (Embree).

#include <cstdint>
#include <memory>
#include <span>

#include "geometry/polygon_soup.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/ray_options.h"

namespace exitance {

/// What a ray meets first.
struct RayHit {
  std::uint32_t patch = kNone;  ///< kNone: an obstruction that is no patch, or nothing
  enum class Side : std::uint8_t { none, front, back } side = Side::none;
};

/// Occluders as Embree's triangles, in float coordinates relative to the middle of the scene. Any number of threads may
/// ask at once. Denormal numbers are flushed to zero while rays are cast only, as Embree wants it and exact predicates
/// must not have it.
class RayCaster {
 public:
  /// The occluding facets of a soup. Throws std::invalid_argument on options out of range, std::runtime_error when
  /// Embree fails.
  RayCaster(const PolygonSoup& soup, const RayOptions& options);
  /// The pieces of all patches, so that hits can name them, and the facets of what only obstructs. Pieces meet in
  /// rounded points, where few rays in a million may pass between them.
  RayCaster(const PatchMesh& mesh, const PolygonSoup& soup, const RayOptions& options);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// visible[k] = 1 where nothing stands between from[k] and to[k], else 0. `from` may be a single point, for all.
  /// REQUIRES: visible is as long as `to`.
  void cast(std::span<const Vec3> from, std::span<const Vec3> to, std::span<std::uint8_t> visible) const;

  /// What is met first from each point in each direction. REQUIRES: all three are equally long.
  void first_hits(std::span<const Vec3> from, std::span<const Vec3> direction, std::span<RayHit> hits) const;

  double offset() const;  ///< RayOptions::offset in this scene [m]

 private:
  struct EmbreeScene;
  std::unique_ptr<EmbreeScene> embree_;
};

}  // namespace exitance
