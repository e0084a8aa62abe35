#pragma once
// Where the shape of what a receiver sees of a source changes: along lines on the receiver, the traces of planes
// through a vertex and an edge (Gigus and Malik 1990 call them EV events), and where it meets other surfaces.

#include <cstdint>
#include <vector>

#include "geometry/polygon_soup.h"
#include "src/form_factor/area_cell.h"

namespace exitance {

/// A plane whose trace on the receiver matters only where both functionals `inside` are not negative.
struct VisualEvent {
  CutPlane plane;
  Vec3 inside[2];  ///< normals of half-spaces through plane.point; zero where there is no limit

  /// Whether the event may happen within the cell, at a line that cuts it.
  bool concerns(const AreaCell& cell) const;
};

/// Whether part of facet s can lie above facet r's plane while part of r lies above that of s: false means that they
/// exchange nothing. Exact.
bool face_each_other(const PolygonSoup& soup, std::uint32_t r, std::uint32_t s);

/// Facets that may hide something of the polygon from points of the facet, ascending: all that reach into the interior
/// of the convex hull of both, on the front sides of both. Exact where it says none: touching the hull's boundary is
/// not reaching in.
std::vector<std::uint32_t> occluders_between(const PolygonSoup& soup, std::uint32_t receiver_facet,
                                             std::uint32_t source_polygon);

/// Events on the receiver's facet of a source polygon and the occluders between them, most important first: planes of
/// the surfaces themselves, contacts in the receiver's plane, a vertex of the one against an edge of the other, and
/// occluders against each other where those are few. Events of three edges are none of these, and curved.
std::vector<VisualEvent> visual_events(const PolygonSoup& soup, std::uint32_t receiver_facet,
                                       std::uint32_t source_polygon, const std::vector<std::uint32_t>& occluders);

}  // namespace exitance
