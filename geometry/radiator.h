#pragma once
// A polygon prepared for exchange with many others: its facets with planes and areas.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/facets.h"
#include "geometry/predicates.h"

namespace exitance {

/// A convex, exactly planar facet of positive area, counter-clockwise seen from its front.
struct RadiatorFacet {
  Loop loop;                                ///< no point twice in a row; collinear vertices allowed
  std::array<std::uint32_t, 3> spanning{};  ///< vertices that define the plane exactly, counter-clockwise
  Vec3 normal;                              ///< unit, relative error 2^-49
  double area = 0;                          ///< [m²], relative error 2^-46
  Vec3 centre;                              ///< of a sphere around it
  double radius = 0;

  PlanePoints plane() const { return {&loop[spanning[0]], &loop[spanning[1]], &loop[spanning[2]]}; }
};

/// Twice the area of a triangle [m²], relative error 2^-47, needles included; exactly 0 if the points are collinear.
double doubled_area(const Vec3& a, const Vec3& b, const Vec3& c);

class Radiator {
 public:
  /// Cuts the polygon into facets (facets.h); a polygon of zero area has none. The polygon must be free of the other
  /// defects of find_defect.
  explicit Radiator(const Polygon& polygon);
  /// Takes loops that are facets already.
  explicit Radiator(std::span<const Loop> facets);

  std::span<const RadiatorFacet> facets() const { return facets_; }
  double area() const { return area_; }  ///< [m²], relative error 2^-45

 private:
  std::vector<RadiatorFacet> facets_;
  double area_ = 0;
};

}  // namespace exitance
