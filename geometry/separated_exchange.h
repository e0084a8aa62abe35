#pragma once
// The exchange between two facets that are well apart: a product Gauss rule on both areas. All its terms are positive,
// so that the smallest value has as many digits as the largest.

#include <optional>

#include "geometry/half_space_clip.h"

namespace exitance {

/// ∫∫ cosθ cosθ' / (π r²) dA dA' over what is left of two facets [m²].
struct Exchange {
  double integral = 0;
  double error = 0;  ///< estimate of |integral − true| that is meant to hold
};

/// The parts of two facets that lie in front of each other's planes.
struct FacetPair {
  const RadiatorFacet *a = nullptr, *b = nullptr;
  ClippedLoop of_a, of_b;

  bool faces() const { return !of_a.empty() && !of_b.empty(); }
};

/// With a relative truncation error of about `relative`; none if they are so near each other that it would take more
/// than some thousand pairs of points.
std::optional<Exchange> separated_exchange(const FacetPair& pair, double relative);

}  // namespace exitance
