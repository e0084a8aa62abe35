#pragma once
// A rule-made furnished room: a scene of any size for tests and measurements.

#include <cstdint>

#include "src/scene/scene.h"

namespace exitance {

/// A closed room, 3 m high, of exactly `polygons` polygons, with z upwards, in metres. Its floor is one polygon, its
/// ceiling and walls are grids of rectangles, the walls' with T-junctions. It is furnished with closed solids that
/// touch each other, the floor, the walls and the ceiling face to face in exactly the same coordinates, and nowhere
/// overlap: rugs, tables, chairs, shelves with books, cupboards, pictures, stacked boxes, columns, vases, lamps (which
/// emit). About one group of furniture stands on every 4 m²; up to 2,000 polygons the room grows with their number, to
/// 80 m², then the detail. Many pieces are turned, so that their coordinates are rounded, and some tilted, so that
/// their faces are planar up to rounding only. About half of the polygons that face a point of a surface are visible
/// from it, at least in part. The same number and seed give the same bits on any machine. polygons in 100 … 1,000,000,
/// else std::invalid_argument.
Scene make_furnished_room(std::uint32_t polygons, std::uint64_t seed);

}  // namespace exitance
