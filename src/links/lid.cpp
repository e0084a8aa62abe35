#include "src/links/lid.h"

#include <algorithm>
#include <array>
#include <utility>

#include "geometry/convex_part.h"

namespace exitance {
namespace {

/// Of an area: what rounding leaves where polygons meet at their edges.
constexpr double kNothing = 0x1p-30;

using Loop = std::vector<Vec3>;

double area_of(std::span<const Vec3> loop) {
  Vec3 sum;
  for (std::size_t k = 1; k + 1 < loop.size(); ++k) sum = sum + cross(loop[k] - loop[0], loop[k + 1] - loop[0]);
  return 0.5 * norm(sum);
}

double value(const HalfSpace& side, const Vec3& v) {
  return dot(side.normal, v) - side.offset;
}

/// Of a convex loop what lies on one side of a line: sign 1 inside, −1 outside.
Loop part(const Loop& loop, const HalfSpace& side, double sign) {
  return convex_part(loop, [&](const Vec3& v) { return sign * value(side, v); });
}

std::array<double, 4> key(const HalfSpace& side) {
  return {side.normal.x, side.normal.y, side.normal.z, side.offset};
}

/// Of the edges from corner to corner, which run clockwise where the facet that they are of looks against the plane.
Lid lid_of(std::span<const Corner> corners, const Vec3& normal, bool against) {
  Lid lid;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 &a = corners[k].at, &b = corners[(k + 1) % corners.size()].at;
    if (a == b) continue;
    const Vec3 inward = normalized(cross(normal, against ? a - b : b - a));
    lid.sides.push_back({inward, dot(inward, a)});
  }
  std::ranges::sort(lid.sides, {}, key);
  return lid;
}

}  // namespace

bool Lid::covers(const Vec3& point) const {
  return std::ranges::all_of(sides, [&](const HalfSpace& side) { return value(side, point) > 0; });
}

bool operator<(const Lid& a, const Lid& b) {
  return std::ranges::lexicographical_compare(a.sides, b.sides, {}, key, key);
}

std::vector<Lid> lids_on(const PolygonSoup& soup, const Contacts& contacts, std::uint32_t facet) {
  std::vector<Lid> lids;
  if (!contacts.may_be_covered(facet)) return lids;
  const Vec3 normal = normalized(soup.facets()[facet].plane.normal);
  for (const std::uint32_t t : contacts.covering(facet)) {
    const Facet& f = soup.facets()[t];
    lids.push_back(lid_of(soup.corners(f), normal, dot(f.plane.normal, normal) < 0));
  }
  std::sort(lids.begin(), lids.end());
  return lids;
}

double open_area(std::span<const Vec3> loop, double area, std::span<const Lid> lids) {
  std::vector<Loop> open{Loop(loop.begin(), loop.end())}, left;
  for (const Lid& lid : lids) {
    left.clear();
    for (Loop& piece : open) {
      if (!overlaps(piece, area, lid)) {
        left.push_back(std::move(piece));
        continue;
      }
      for (const HalfSpace& side : lid.sides) {
        Loop beside = part(piece, side, -1);
        if (area_of(beside) > 0) left.push_back(std::move(beside));
        piece = part(piece, side, 1);
      }
    }
    open.swap(left);
  }
  double sum = 0;
  for (const Loop& piece : open) sum += area_of(piece);
  return sum <= kNothing * area ? 0 : area - sum <= kNothing * area ? area : sum;
}

bool overlaps(std::span<const Vec3> loop, double area, const Lid& lid) {
  Loop under(loop.begin(), loop.end());
  for (const HalfSpace& side : lid.sides) {
    under = part(under, side, 1);
    if (area_of(under) <= kNothing * area) return false;
  }
  return true;
}

}  // namespace exitance
