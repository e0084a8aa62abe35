#pragma once
// The connected pieces of surface in a polygon soup: which are closed, which way they face, which lie within which.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/edge_matching.h"
#include "geometry/polygon.h"

namespace exitance {

struct SurfacePiece {
  std::vector<std::uint32_t> polygons;  ///< ascending
  double area = 0;                      ///< [m²]
  bool closed = false;                  ///< every edge is cancelled or ends on the surface of another piece (contact)
  /// Of a closed piece [m³]: positive when the fronts look out, negative when they look in (a room). 0 for open pieces
  /// and for those that bound nothing (sheets of two sides). Where a piece ends on others the missing part is taken as
  /// a cone.
  double volume = 0;
  bool enclosed = false;  ///< lies in front of another closed piece that looks in
  bool encloses = false;  ///< another piece lies inside this closed one
};

struct OpenEdge {
  DirectedEdge edge;
  bool in_contact = false;  ///< lies on the surface of another piece
};

struct SurfacePieces {
  std::vector<SurfacePiece> pieces;
  std::vector<std::uint32_t> piece_of_polygon;
  std::vector<OpenEdge> open_edges;
};

/// Edges and contacts are decided exactly or within `near` [m] (edge_matching.h, edge_contact.h), and what is no thicker
/// than that bounds nothing. A piece counts as enclosed when at least half of its area has its front within the other
/// one, seen just above the middles of its facets; so a table on the floor, a rug on it, and a box outside that leans
/// against the wall are told apart. REQUIRES: no defects but zero area (find_defect).
SurfacePieces find_surface_pieces(std::span<const Polygon> polygons, double near = 0);

}  // namespace exitance
