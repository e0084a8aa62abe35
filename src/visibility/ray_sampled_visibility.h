#pragma once
// Visibility of a mesh's patches from its sample points by rays: what exact visibility is compared with.

#include <memory>

#include "geometry/polygon_soup.h"
#include "src/visibility/ray_options.h"
#include "src/visibility/visibility.h"

namespace exitance {

class RaySampledVisibility final : public MeshVisibility {
 public:
  /// Keeps references. The mesh must be of the soup's scene. Throws std::invalid_argument on options out of range,
  /// std::runtime_error when Embree fails.
  RaySampledVisibility(const PatchMesh& mesh, const PolygonSoup& soup, const RayOptions& options);
  ~RaySampledVisibility() override;

  const PatchMesh& mesh() const override { return mesh_; }

  /// Pairs are counted as the rays tell: open where all arrive, blocked where none does. With Estimator::hemisphere
  /// those are partial of which a ray meets something and facing away the others, and an entry takes a whole row.
  std::unique_ptr<Observer> observer() const override;

 private:
  struct Rays;
  const PatchMesh& mesh_;
  const PolygonSoup& soup_;
  std::unique_ptr<Rays> rays_;
};

}  // namespace exitance
