#pragma once
// The exchange between two polygons by another route than the kernel's: Lambert's formula for a point, integrated over
// one polygon's area by adaptive cubature, after clipping with rational coordinates.

#include "geometry/polygon.h"

namespace exitance {

struct OracleExchange {
  long double integral = 0;  ///< A_i F_ij [m²]
  long double error = 0;     ///< estimate from the last refinement
};

/// By a double exponential rule in long double: right to some 17 digits wherever the polygons touch, but not where they
/// come near without touching an edge. Takes about a tenth of a second.
OracleExchange oracle_exchange(const Polygon& a, const Polygon& b);

/// By adaptive Gauss rules in 50 digits, until the estimate is below `tolerance` times the value or that takes too
/// long: for separated polygons whose value is small against what it is computed from. Takes a few seconds at most.
OracleExchange fine_oracle_exchange(const Polygon& a, const Polygon& b, double tolerance = 1e-18);

}  // namespace exitance
