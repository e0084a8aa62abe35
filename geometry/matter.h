#pragma once
// What lies behind the polygons of a soup: of those that lie against each other it decides which are buried.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon.h"

namespace exitance {

enum class Behind : std::uint8_t {
  nothing,       ///< open surfaces and the sides of sheets, closed or not
  solid,         ///< matter: a closed piece of surface that looks out
  surroundings,  ///< matter: of a closed piece that looks in, a room
  other_room     ///< such a piece again: a wall without thickness between two rooms
};

constexpr bool is_matter(Behind behind) {
  return behind == Behind::solid || behind == Behind::surroundings;
}
constexpr bool is_of_room(Behind behind) {
  return behind == Behind::surroundings || behind == Behind::other_room;
}

/// By polygon, from the closed pieces of surface (surface_pieces.h) and from coplanar_overlaps (contact.h):
///  - a piece that looks in of which every polygon is one of a piece that looks out turned over, corner by corner, is
///    with that a closed sheet of two sides: nothing is behind either;
///  - a polygon of a room that overlaps one of a room, the same or another, against which it lies has that room behind
///    it, all over: a wall that is partly shared by two rooms bounds matter nowhere.
/// A solid that fills a room exactly is the same as a closed sheet, and taken for that. near [m]: of both.
/// REQUIRES: no defects but zero area (find_defect).
std::vector<Behind> find_matter(std::span<const Polygon> polygons, double near = 0);

}  // namespace exitance
