#pragma once
// Outlines of what is seen of a source, compared by where their edges lie.

#include <span>

#include "geometry/viewpoint.h"

namespace exitance {

/// Whether two outlines, seen from points next to each other, have the same edges, where those that lie in one line but
/// for rounding are one: of such, either may bound, by turns. Each line must bound as many stretches in both.
bool same_lines(std::span<const SeenEdge> here, std::span<const SeenEdge> there);

}  // namespace exitance
