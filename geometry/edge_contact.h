#pragma once
// Whether edges end on surfaces: the rim of a box without a bottom that stands on a floor.

#include <span>
#include <vector>

#include "geometry/edge_matching.h"
#include "geometry/facets.h"

namespace exitance {

/// A facet and the piece of surface (edge_matching.h) it belongs to.
struct PieceFacet {
  Loop loop;
  std::uint32_t polygon = 0;
  std::uint32_t piece = 0;
};

/// For each edge, whether every point of it lies on some facet of another piece (edges and corners of facets included),
/// whose plane holds the edge: exactly or, where `near` is not 0, within so much [m], as far as double precision tells;
/// edges that are no longer than that count as if. piece_of_polygon: the piece that each polygon belongs to.
std::vector<bool> edges_in_contact(std::span<const DirectedEdge> edges, std::span<const PieceFacet> facets,
                                   std::span<const std::uint32_t> piece_of_polygon, double near = 0);

}  // namespace exitance
