#include "geometry/matter.h"

#include <algorithm>
#include <set>

#include "geometry/contact.h"
#include "geometry/surface_pieces.h"

namespace exitance {
namespace {

/// The corners of a polygon, or of the same turned over, whatever corner and hole each is given from.
using Outline = std::vector<std::vector<Vec3>>;

bool less(const Vec3& a, const Vec3& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

bool less_loop(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return std::ranges::lexicographical_compare(a, b, less);
}

struct LessOutline {
  bool operator()(const Outline& a, const Outline& b) const {
    return std::ranges::lexicographical_compare(a, b, less_loop);
  }
};

/// Holes may run either way: of both ways the lesser one counts.
Outline outline_of(const Polygon& polygon, bool turned_over) {
  const auto from_least = [](std::vector<Vec3> loop) {
    std::ranges::rotate(loop, std::ranges::min_element(loop, less));
    return loop;
  };
  const auto reversed = [](std::vector<Vec3> loop) {
    std::ranges::reverse(loop);
    return loop;
  };
  Outline outline;
  for (const auto& hole : polygon.holes)
    outline.push_back(std::ranges::min(from_least(hole), from_least(reversed(hole)), less_loop));
  std::ranges::sort(outline, less_loop);
  outline.insert(outline.begin(), from_least(turned_over ? reversed(polygon.outer) : polygon.outer));
  return outline;
}

/// Whether one piece is the other turned over.
bool are_sides_of_a_sheet(std::span<const Polygon> polygons, const SurfacePiece& a, const SurfacePiece& b) {
  if (a.polygons.size() != b.polygons.size()) return false;
  std::multiset<Outline, LessOutline> of_a;
  for (const std::uint32_t p : a.polygons) of_a.insert(outline_of(polygons[p], false));
  return std::ranges::all_of(b.polygons, [&](std::uint32_t p) {
    const auto twin = of_a.find(outline_of(polygons[p], true));
    if (twin == of_a.end()) return false;
    of_a.erase(twin);
    return true;
  });
}

}  // namespace

std::vector<Behind> find_matter(std::span<const Polygon> polygons) {
  std::vector<Behind> behind(polygons.size(), Behind::nothing);
  const std::vector<SurfacePiece> pieces = find_surface_pieces(polygons).pieces;
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
    const auto other = std::ranges::find_if(
        solids, [&](const SurfacePiece* solid) { return are_sides_of_a_sheet(polygons, *room, *solid); });
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
  for (const CoplanarOverlap& overlap : coplanar_overlaps(of_rooms)) {
    if (!overlap.same_facing) behind[walls[overlap.a]] = behind[walls[overlap.b]] = Behind::other_room;
  }
  return behind;
}

}  // namespace exitance
