#pragma once
// Where the shape of what a receiver sees of a source changes: along lines on the receiver, the traces of planes
// through a vertex and an edge (Gigus and Malik 1990 call them EV events), and where it meets other surfaces.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/form_factor/visual_event.h"

namespace exitance {

/// The edges of a source and of what stands between.
std::vector<SeenEdge> edges_of(const PolygonSoup& soup, const Source& source, std::span<const std::uint32_t> items);

/// Events on the receiver of a source and of what stands between them, items of the soup's index: planes of the
/// surfaces themselves, contacts in the receiver's plane, a vertex of the one against an edge of the other, and
/// occluders against each other; each stretch of a line once, and only where a line of sight to the source shows it
/// (EventReach). Events of three edges are none of these, and curved; nor are those at the horizon, of a vertex in the
/// receiver's plane, where what appears counts for nothing at first; nor those of occluders against each other where
/// there are too many pairs of them.
std::vector<VisualEvent> visual_events(const PolygonSoup& soup, const Source& receiver, const Source& source,
                                       std::span<const std::uint32_t> items);

}  // namespace exitance
