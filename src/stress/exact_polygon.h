#pragma once
// Convex loops, planes and half-spaces with rational coordinates, of which the oracles are made.

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <vector>

#include "geometry/facets.h"

namespace exitance {

using ExactKernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPoint = ExactKernel::Point_3;
using ExactLoop = std::vector<ExactPoint>;

ExactPoint exact_point(const Vec3& p);
ExactLoop exact_loop(const Loop& loop);
ExactPoint exact_mean(const ExactLoop& points);

/// The half-space normal · (v − origin) ≥ 0.
struct ExactSide {
  ExactPoint origin;
  ExactKernel::Vector_3 normal;
  ExactKernel::FT value(const ExactPoint& p) const { return normal * (p - origin); }
  int sign(const ExactPoint& p) const { return static_cast<int>(CGAL::sign(value(p))); }
};

/// Of a loop counter-clockwise seen from the front. Throws std::logic_error where it has no area.
ExactSide exact_plane(const ExactLoop& loop);

/// The part of a convex loop where value ≥ 0.
ExactLoop clipped(const ExactLoop& loop, const ExactSide& side);

/// Of a convex loop.
bool has_area(const ExactLoop& loop);

}  // namespace exitance
