#pragma once
// All that an element sees at once, by rays as dense as cosθ / π around its normal.

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/polygon_soup.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/contacts.h"
#include "src/visibility/ray_caster.h"
#include "src/visibility/ray_options.h"
#include "src/visibility/sample_points.h"

namespace exitance {

struct HemisphereHits {
  std::vector<std::pair<std::uint32_t, std::uint64_t>> front;  ///< patch and hits of its front, ascending
  std::uint64_t missed = 0;   ///< rays that met nothing: of a closed scene, they leaked
  std::uint64_t covered = 0;  ///< that were not cast, as something lies on the point where they start
  std::uint64_t rays = 0;     ///< all of them

  /// The share that met the patch's front, and its standard error as of independent rays: too much for points that are
  /// spread evenly.
  double share(std::uint64_t hits) const { return static_cast<double>(hits) / static_cast<double>(rays); }
  double standard_error(std::uint64_t hits) const;
};

/// Of the two sides of a sheet that are cut into the same facets a ray meets the one that it comes from. Which of two
/// other surfaces in one plane it meets first is left to chance.
class HemisphereRays {
 public:
  /// Keeps a reference to the mesh. Throws std::invalid_argument on options out of range, std::runtime_error when
  /// Embree fails.
  HemisphereRays(const PatchMesh& mesh, const PolygonSoup& soup, const RayOptions& options);

  HemisphereHits from_point(const Element& element, std::uint64_t seed) const;  ///< its sample point
  /// From points spread over all pieces of an element or a patch.
  HemisphereHits from_area(std::span<const PatchPiece> pieces, std::uint64_t seed) const;

 private:
  template <std::size_t D, class RayOf>
  HemisphereHits count(const SamplePoints<D>& samples, std::uint64_t seed, const RayOf& ray_of) const;

  const PatchMesh& mesh_;
  const PolygonSoup& soup_;
  std::uint32_t replicates_;
  SamplePoints<2> directions_;
  SamplePoints<4> points_and_directions_;
  RayCaster caster_;
  std::optional<Contacts> contacts_;
};

}  // namespace exitance
