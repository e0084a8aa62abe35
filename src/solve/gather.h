#pragma once
// Radiosity by gathering: the whole matrix at once.

#include <cstdint>
#include <functional>
#include <span>

#include "src/output/progress.h"
#include "src/solve/radiosity_system.h"

namespace exitance {

enum class GatherMethod : std::uint8_t {
  jacobi,        ///< one more bounce a sweep; rows in parallel
  gauss_seidel,  ///< in place, patch after patch; about half of Jacobi's sweeps
  krylov,        ///< BiCGSTAB, band after band; for reflectances near 1
  direct         ///< LU decomposition, band after band; up to kDirectLimit patches
};

/// Most patches that GatherMethod::direct takes: the dense matrix and its factors are 64 MB there.
inline constexpr std::size_t kDirectLimit = 2000;

struct GatherOptions {
  GatherMethod method = GatherMethod::gauss_seidel;
  double tolerance = 1e-12;               ///< of ‖B − B*‖∞ relative to max |B|, each band; > 0
  std::uint64_t max_iterations = 100000;  ///< sweeps or Krylov steps
  Progress progress = {};                 ///< fraction by the logarithm of the error bound
  std::function<bool()> stop = {};        ///< asked between sweeps: true ends the work with what there is; may be empty
  std::span<const double> start = {};     ///< B to begin with, by patch and band; empty: E
};

/// Solves every band to the tolerance, proven by the residual of what is returned (error_bound.h). Whatever the method,
/// its answer is verified that way and finished by Gauss–Seidel (Jacobi: Jacobi) sweeps where it falls short. When
/// rounding, max_iterations or `stop` ends it earlier, `converged` is false and error_bound says what was reached.
/// Throws InvalidSystem (see check and contraction), std::invalid_argument on a tolerance that is not positive and on a
/// start of another size than E, and LimitError when a direct solution is asked of more than kDirectLimit patches.
Solution gather(const RadiositySystem& system, const GatherOptions& options = {});

}  // namespace exitance
