#include "geometry/level_facets.h"

#include <algorithm>
#include <cmath>

#include "geometry/level.h"

namespace exitance {
namespace {

Loop loop_of(std::span<const Corner> corners) {
  Loop loop;
  for (const Corner& c : corners) loop.push_back(c.at);
  return loop;
}

}  // namespace

bool are_level(const PolygonSoup& soup, std::uint32_t f, std::uint32_t g, double near) {
  const Plane &of_f = soup.facets()[f].plane, &of_g = soup.facets()[g].plane;
  if (!may_be_level(of_f.normal, of_g.normal)) return false;
  const auto corners_f = soup.corners(soup.facets()[f]), corners_g = soup.corners(soup.facets()[g]);
  const Box box_f = soup.box_of(f), box_g = soup.box_of(g);
  if (!box_f.grown(near).overlaps(box_g)) return false;
  // Most lie farther off each other's planes than level_area lets them. An area is at least half its plane's normal.
  const double size_f = norm(box_f.upper - box_f.lower), size_g = norm(box_g.upper - box_g.lower);
  const auto lies_off = [&](std::span<const Corner> corners, const Plane& plane, double size) {
    return std::ranges::any_of(corners, [&](const Corner& c) {
      return std::fabs(dot(plane.normal, c.at - plane.origin)) > 2.01 * near * size * (size_f + size_g);
    });
  };
  if (lies_off(corners_g, of_f, size_f) && lies_off(corners_f, of_g, size_g)) return false;
  return level_area(loop_of(corners_f), loop_of(corners_g), near) > 0;
}

bool backs(const PolygonSoup& soup, const Shell& shell, std::uint32_t own, std::uint32_t f, int side) {
  const Plane &plane = soup.facets()[f].plane, &of_own = soup.facets()[own].plane;
  const double above = soup.pile() * norm(plane.normal), below = -soup.pile() * norm(of_own.normal);
  return std::ranges::all_of(
             shell.vertices,
             [&](std::uint32_t v) { return side * dot(plane.normal, soup.vertices()[v] - plane.origin) <= above; }) ||
         std::ranges::all_of(soup.corners(soup.facets()[f]),
                             [&](const Corner& c) { return dot(of_own.normal, c.at - of_own.origin) >= below; });
}

}  // namespace exitance
