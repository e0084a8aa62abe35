#pragma once
// What two convex polygons exchange past convex bodies, by another route than the library's. That looks from points at
// what is seen of a polygon and integrates over points; this looks along directions: everything is
// projected along each direction, where what is lit is a convex polygon less convex shadows, and its area is integrated
// over the directions:
//   A_i F_ij = 1/pi * integral over directions of the area of (receiver ∩ source \ shadows) dω.
// The integrand has no kernel that grows where polygons touch or come near each other.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/vec3.h"

namespace exitance {

/// A planar convex polygon (one face, any orientation) or a convex polyhedron by its faces, of which those that hide
/// nothing may be missing.
using ConvexBody = std::vector<std::vector<Vec3>>;

struct ExchangeTruth {
  long double integral = 0;        ///< A_i F_ij [m²]
  long double error = 0;           ///< ten times the quadrature rules' own estimate, and rounding [m²]
  long double standard_error = 0;  ///< of a mean of samples [m²]; 0 where it is an integral
  long evaluations = 0;            ///< of areas
};

struct TruthOptions {
  long double tolerance = 1e-14L;  ///< of the integral, relative to the smaller polygon's area
  /// Of the spherical coordinates of directions: 0 lies in both polygons' planes, others do not. Each axis has events
  /// and panels of its own: two that agree check each other.
  int axis = 0;
};

/// Receiver and source, planar, run counter-clockwise seen from their fronts. In long double. All directions at which
/// the projection changes its combinatorics at a fixed longitude are found in closed form (a vertex over an edge:
/// linear; three edges in a point: quadratic), and those that show are where panels end; so are the longitudes of two
/// vertices in line, and of a vertex in line with two edges. Degenerate cases:
///  - parts below the other polygon's plane exchange nothing; occluders count between the two planes only;
///  - an occluder that lies in one of the planes, or beyond one, hides nothing; a body that stands on a polygon covers
///    it;
///  - an occluder that joins, pierces or duplicates another or a polygon is no special case.
ExchangeTruth exchange_truth(std::span<const Vec3> receiver, std::span<const Vec3> source,
                             std::span<const ConvexBody> occluders, const TruthOptions& options = {});

/// The same by a lattice of 1,597 directions that is shifted eight times at random (`seed`), in a tenth of a second at
/// most; where six standard errors are more than 1e-5 of the smaller polygon's area then, by one of 17,711, in a second
/// or two. The error is six standard errors, which of eight shifts fail once in some thousand times, and six
/// directions' share of the largest value, as what is seen in fewer directions may be missed by all.
ExchangeTruth sampled_exchange(std::span<const Vec3> receiver, std::span<const Vec3> source,
                               std::span<const ConvexBody> occluders, std::uint64_t seed);

}  // namespace exitance
