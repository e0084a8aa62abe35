#pragma once
// The radiosity system by LU decomposition.

#include "src/solve/radiosity_system.h"

namespace exitance {

/// B of (I − diag(ρ) F) B = E, band after band, by LU decomposition with partial pivoting of the dense matrix: 2 · 8 ·
/// n² bytes and 2/3 n³ operations a band for n patches.
void solve_direct(const RadiositySystem& system, std::span<double> B);

}  // namespace exitance
