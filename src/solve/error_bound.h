#pragma once
// How far a solution can be from the true one, and whether its energy adds up.
//
// Rows of F sum to at most 1, so ‖(I − diag(ρ) F)⁻¹‖∞ ≤ 1 / (1 − max ρ), and any B whatever satisfies
// ‖B − B*‖∞ ≤ ‖E + ρ F B − B‖∞ / (1 − max ρ). Where errors of F lift a row's sum above 1, max ρ Σ_q F_pq takes the
// place of max ρ. All bounds include the rounding of their own evaluation and say nothing of the discretisation's
// error.

#include <cstdint>
#include <span>
#include <vector>

#include "src/solve/radiosity_system.h"

namespace exitance {

/// max_p ρ_p max(1, Σ_q F_pq) of each band, rounded up. Throws InvalidSystem when one reaches 1: nothing bounds the
/// solution then.
std::vector<double> contraction(const RadiositySystem& system);

/// What B misses of solving the system.
struct Residual {
  std::vector<double> H;         ///< F B, each patch and band
  std::vector<double> r;         ///< E + ρ H − B, each patch and band
  std::vector<double> norm;      ///< max |r| of each band
  std::vector<double> rounding;  ///< how far norm may be from exact, each band
  std::vector<double> max_B;     ///< max |B| of each band
};

Residual residual(const RadiositySystem& system, std::span<const double> B);

/// Bound of ‖B − B*‖∞ relative to max |B|, each band: (norm + rounding) / (1 − contraction) / max_B. 0 where all of
/// them are 0, infinite where only max_B is.
std::vector<double> error_bounds(std::span<const double> norm, std::span<const double> rounding,
                                 std::span<const double> contraction, std::span<const double> max_B);

/// What errors of the form factors add to the error bound, relative to max |B|, worst band:
/// max_p ρ_p Σ_q F_error_pq |B_q| / (1 − max ρ) / max |B|. Solution::error_bound plus this bounds the distance to the
/// solution with true form factors.
double form_factor_error(const RadiositySystem& system, std::span<const double> B);

/// Power [W, if E is in W/m²] of each band.
struct EnergyBalance {
  std::vector<double> emitted;   ///< Σ A E
  std::vector<double> absorbed;  ///< Σ A (1 − ρ) H
  std::vector<double> escaped;   ///< Σ_j A_j B_j (1 − Σ_i F_ji)
  std::vector<double> defect;    ///< |emitted − absorbed − escaped| / emitted; 0 when all are 0
  double worst_defect = 0;
};

/// Closes when A_i F_ij = A_j F_ji. area and row_sum: one a patch; rho, E, B, H: one a patch and band.
EnergyBalance energy_balance(std::span<const double> area, std::span<const double> row_sum, std::span<const double> rho,
                             std::span<const double> E, std::span<const double> B, std::span<const double> H,
                             std::uint32_t bands);

}  // namespace exitance
