#pragma once
// The polygon soup of a scene under edits.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"
#include "src/scene/edit.h"

namespace exitance {

/// All objects, in the order of the scene.
std::vector<std::uint32_t> objects_of(const EditedScene& scene);

/// The polygons of objects, one object's after the other's in the order given, with room for what edits bring. Which of
/// two in one plane lies on top is told by where they stand in the scene, whatever the order. order: every object once.
PolygonSoup make_soup(const EditedScene& scene, std::span<const std::uint32_t> order);

/// What `before` becomes by an edit of the geometry of one object, whose polygons there are `gone`; scene: as it is
/// now. Shares with `before` (PolygonSoup::edited), the object's polygons are those that arrived; or, where that cannot
/// be, is made anew in the order given.
PolygonSoup soup_after(const PolygonSoup& before, PolygonSoup::PolygonRange gone, const EditedScene& scene,
                       std::uint32_t object, std::span<const std::uint32_t> order);

}  // namespace exitance
