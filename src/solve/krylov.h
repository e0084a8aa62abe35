#pragma once
// The radiosity system by a Krylov method.

#include "src/solve/radiosity_system.h"

namespace exitance {

/// BiCGSTAB (van der Vorst 1992) on (I − diag(ρ) F) B = E, band after band, the matrix applied row by row in parallel.
/// B holds the start and receives the answer; a band without emission gets 0. Aims at ‖B − B*‖∞ ≤ tolerance / 2 · max E
/// through the 2-norm of the recursive residual, which the caller must verify: that can drift from the true one, and
/// bands may break down. contraction: of error_bound.h. Returns the steps of the slowest band, at most max_iterations.
std::uint64_t solve_krylov(const RadiositySystem& system, std::span<const double> contraction, double tolerance,
                           std::uint64_t max_iterations, std::span<double> B);

}  // namespace exitance
