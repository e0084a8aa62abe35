#pragma once
// What lies on a facet and covers some of it: there nothing is received, and nothing that is sent gets out.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"
#include "geometry/spatial_index.h"
#include "src/visibility/contacts.h"

namespace exitance {

/// A convex part of a facet's plane: where all values of its half-spaces, whose normals are of unit length and lie in
/// the plane, are positive.
struct Lid {
  std::vector<HalfSpace> sides;

  /// Whether a point of the plane lies under it; within the sides by double precision.
  bool covers(const Vec3& point) const;

  friend bool operator<(const Lid& a, const Lid& b);
};

/// The facets that cover some of the front of one (Contacts), exactly in its plane or up to rounding, ascending: in an
/// order that depends on where they lie only. What passes through a solid is not covered: that is a fault of the scene.
std::vector<Lid> lids_on(const PolygonSoup& soup, const Contacts& contacts, std::uint32_t facet);

/// Area [m²] of a convex polygon in the plane that no lid covers, in double precision; 0 or all of it where less than
/// 2^-30 of it is missing to that. Lids may overlap each other.
double open_area(std::span<const Vec3> loop, double area, std::span<const Lid> lids);

/// Whether a lid covers more than 2^-30 of the polygon's area [m²].
bool overlaps(std::span<const Vec3> loop, double area, const Lid& lid);

}  // namespace exitance
