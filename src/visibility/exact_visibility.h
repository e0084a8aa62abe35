#pragma once
// Exact visibility of a mesh's patches from its sample points.

#include <utility>

#include "geometry/polygon_soup.h"
#include "src/visibility/contacts.h"
#include "src/visibility/visibility.h"

namespace exitance {

/// Proven error that double precision must reach, else extended precision is asked. True errors are about a thousandth
/// of it: a source behind hundreds of occluders has hundreds of arcs, each with its own worst case.
inline constexpr double kPointTolerance = 1e-11;

class ExactVisibility final : public MeshVisibility {
 public:
  /// Keeps references. The mesh must be of the soup's scene (make_patch_mesh).
  ExactVisibility(const PatchMesh& mesh, const PolygonSoup& soup) : ExactVisibility(mesh, soup, Contacts(soup)) {}
  /// The same with the soup's contacts, where they are known.
  ExactVisibility(const PatchMesh& mesh, const PolygonSoup& soup, Contacts contacts)
      : mesh_(mesh), soup_(soup), contacts_(std::move(contacts)) {}

  const PatchMesh& mesh() const override { return mesh_; }
  std::unique_ptr<Observer> observer() const override;
  const Contacts& contacts() const { return contacts_; }

 private:
  const PatchMesh& mesh_;
  const PolygonSoup& soup_;
  Contacts contacts_;
};

}  // namespace exitance
