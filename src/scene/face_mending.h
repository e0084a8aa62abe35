#pragma once
// Faces of meshes that are no polygons. Real meshes hold some, and a room should not fail for a bad face of its
// furniture.

#include "src/scene/scene.h"

namespace exitance {

/// Mends the surfaces whose boundary crosses or touches itself, with one warning a file that counts them and names the
/// first line:
///  - a boundary that visits a point twice is cut there into loops: one that runs the other way round is a hole (n-gons
///  with
///    holes are stored so, joined by an edge to and fro), others become surfaces of their own;
///  - what still is no polygon is replaced by its fan of triangles around its first vertex, those without area left
///  out.
/// The pieces stand where the face stood. Faces of zero area stay as they are (they make no patch and hide nothing) and
/// are counted in a warning. REQUIRES: finite coordinates, three vertices or more.
void mend_faces(Scene& scene);

}  // namespace exitance
