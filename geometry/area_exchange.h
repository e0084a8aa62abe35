#pragma once
// The exchange between two facets as Lambert's form factor of the points of the smaller one, integrated over its area.

#include <optional>

#include "geometry/separated_exchange.h"

namespace exitance {

/// For facets of very different size or shape, between which the contour's terms cancel. Computed in Real: double or
/// long double. About `tolerance` [m²] may go to truncation. None if it would take more than some thousand points, as
/// where facets are close to each other along an edge, but not in one plane.
template <class Real>
std::optional<Exchange> area_exchange(const FacetPair& pair, double tolerance);

}  // namespace exitance
