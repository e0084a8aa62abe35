#pragma once
// Shells: closed surfaces that bound a solid.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/vec3.h"

namespace exitance {

/// Whether triangles that form a connected, closed, consistently oriented manifold are the boundary of a bounded solid
/// seen from outside: they do not intersect themselves (decided exactly) and their signed volume is positive beyond
/// rounding. Triangles index into the vertices, counter-clockwise from the front; a collinear one makes the answer
/// false.
bool bounds_solid(std::span<const Vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace exitance
