#include "geometry/matter.h"

#include <algorithm>

#include "geometry/contact.h"
#include "geometry/surface_pieces.h"

namespace exitance {
namespace {

using Loop = std::vector<Vec3>;
/// The corners of a polygon, the same whatever corner and hole it is given from; the outer loop first.
using Outline = std::vector<Loop>;

bool less(const Loop& a, const Loop& b) {
  return std::ranges::lexicographical_compare(a, b, lexicographically_less);
}

Loop from_least(Loop loop) {
  std::rotate(loop.begin(), std::ranges::min_element(loop, lexicographically_less), loop.end());
  return loop;
}

Loop reversed(Loop loop) {
  std::ranges::reverse(loop);
  return loop;
}

/// Holes may run either way: of both ways the lesser one counts.
Outline outline_of(const Polygon& polygon, bool turned_over) {
  Outline outline{from_least(turned_over ? reversed(polygon.outer) : polygon.outer)};
  for (const Loop& hole : polygon.holes)
    outline.push_back(std::ranges::min(from_least(hole), from_least(reversed(hole)), less));
  std::sort(outline.begin() + 1, outline.end(), less);
  return outline;
}

/// Of all polygons of a piece, in an order that does not depend on theirs.
std::vector<Outline> outlines_of(std::span<const Polygon> polygons, const SurfacePiece& piece, bool turned_over) {
  std::vector<Outline> outlines;
  for (const std::uint32_t p : piece.polygons) outlines.push_back(outline_of(polygons[p], turned_over));
  std::ranges::sort(
      outlines, [](const Outline& a, const Outline& b) { return std::ranges::lexicographical_compare(a, b, less); });
  return outlines;
}

}  // namespace

std::vector<Behind> find_matter(std::span<const Polygon> polygons, double near) {
  std::vector<Behind> behind(polygons.size(), Behind::nothing);
  const std::vector<SurfacePiece> pieces = find_surface_pieces(polygons, near).pieces;
  const auto set = [&](const SurfacePiece& piece, Behind what) {
    for (const std::uint32_t p : piece.polygons) behind[p] = what;
  };
  std::vector<const SurfacePiece*> solids, rooms;
  for (const SurfacePiece& piece : pieces) {
    if (!piece.closed || piece.volume == 0) continue;
    (piece.volume > 0 ? solids : rooms).push_back(&piece);
    set(piece, piece.volume > 0 ? Behind::solid : Behind::surroundings);
  }
  for (const SurfacePiece* room : rooms) {
    const std::vector<Outline> turned_over = outlines_of(polygons, *room, true);
    const auto other = std::ranges::find_if(solids, [&](const SurfacePiece* solid) {
      return solid->polygons.size() == turned_over.size() && outlines_of(polygons, *solid, false) == turned_over;
    });
    if (other == solids.end()) continue;
    set(*room, Behind::nothing);
    set(**other, Behind::nothing);
    solids.erase(other);
  }

  std::vector<std::uint32_t> walls;
  std::vector<Polygon> of_rooms;
  for (std::uint32_t p = 0; p < polygons.size(); ++p) {
    if (behind[p] != Behind::surroundings) continue;
    walls.push_back(p);
    of_rooms.push_back(polygons[p]);
  }
  for (const CoplanarOverlap& overlap : coplanar_overlaps(of_rooms, near)) {
    if (!overlap.same_facing) behind[walls[overlap.a]] = behind[walls[overlap.b]] = Behind::other_room;
  }
  return behind;
}

}  // namespace exitance
