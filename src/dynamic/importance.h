#pragma once
// Which patches shoot most towards what changed.

#include <cstdint>
#include <span>
#include <vector>

#include "src/dynamic/version_difference.h"

namespace exitance {

/// By patch [m²]: Σ A_e F_ep over the elements e of the changed objects as they were, and of those as they are: the
/// power that reaches them of a unit of exitance that patch p has shot. The patch's own area for patches of changed
/// objects, which take back all that they shot. known: rows of changed objects as they are, where they have been looked
/// for. In parallel; any number of threads gives the same bits.
std::vector<double> exact_importance(const VersionDifference& difference, const ObjectRows& known);

/// The paper's estimate of the same: of some points in each changed object, as it was and as it is, a differential area
/// that faces the patch receives F B; its form factor sees past all other objects, exactly. It is multiplied with a
/// quarter of the object's area (what a convex body shows on average), so that it estimates the same power, and the
/// points' share of it. So that a patch that no point sees is not left to the very end, a fiftieth of what light spread
/// evenly over the scene would give is added. One point: the middle of the object's box; more: the middles of an even
/// division of it. Only of `patches`, of the earlier version; takes time by their number.
/// Weaknesses that the paper states: objects that are not small beside the distance; objects that are not about as
/// large from all sides; points that are hidden where other parts are not, or the other way round.
std::vector<double> estimated_importance(const VersionDifference& difference, std::uint32_t points,
                                         std::span<const std::uint32_t> patches);

}  // namespace exitance
