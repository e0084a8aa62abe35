#pragma once
// The faces of a mesh of patches and elements.

#include "geometry/polygon_soup.h"
#include "src/output/faces.h"
#include "src/scene/patch_mesh.h"

namespace exitance {

/// One face for each piece of each element, in their order. Corners of one surface are merged where they differ by
/// rounding only. The mesh must be of the soup's scene.
Faces faces_of(const PatchMesh& mesh, const PolygonSoup& soup);

}  // namespace exitance
