#pragma once
// Objects where none can be in the world: through walls, or out of the scene. Both are legal geometry.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/polygon_soup.h"
#include "src/scene/edit.h"
#include "src/scene/facet_range.h"

namespace exitance {

/// What is odd about where an object of the scene stands, in words; empty where nothing is:
///  - an edge of the object passes through the interior of another object's face, or the other way round (exact;
///    touching, edge on edge and faces in contact are in order);
///  - all of the object lies outside of the box around all others, if there are others.
/// Nothing is said of an object that is not there. soup: of the scene; facets: in it, by object, of all that is
/// present.
std::vector<std::string> find_trespass(const EditedScene& scene, const PolygonSoup& soup,
                                       std::span<const FacetRange> facets, std::uint32_t object);

}  // namespace exitance
