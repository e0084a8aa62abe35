#pragma once
// Which boxes overlap, of many.

#include <cstdint>
#include <functional>
#include <span>

#include "geometry/spatial_index.h"

namespace exitance {

using PairVisitor = std::function<void(std::uint32_t, std::uint32_t)>;

/// Visits every pair of an a and a b whose closed boxes overlap (touching counts) once, in no fixed order. Takes
/// (n + pairs) log n or so.
void for_each_near_pair(std::span<const Box> a, std::span<const Box> b, const PairVisitor& visit);

/// Every pair among the boxes, the smaller number first.
void for_each_near_pair(std::span<const Box> boxes, const PairVisitor& visit);

}  // namespace exitance
