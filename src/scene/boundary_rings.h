#pragma once
// Where the mesh of an object ends: holes, and the rims of sheets.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon.h"

namespace exitance {

/// A ring of edges that only one face of an object has.
struct BoundaryRing {
  std::uint32_t polygon = 0;  ///< one of those that it bounds
  std::size_t edges = 0;
  double length = 0;  ///< [m]
};

/// The rings of every object whose faces form a manifold when vertices of equal coordinates are one, object by object.
/// Of objects with other edges, and of those with a polygon that has holes, none: where they end is not told by their
/// connectivity. object[k]: that of polygon k.
std::vector<BoundaryRing> find_boundary_rings(std::span<const Polygon> polygons, std::span<const std::uint32_t> object);

}  // namespace exitance
