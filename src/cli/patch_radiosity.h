#pragma once
// Radiosity with one constant value a patch, from area-averaged form factors.

#include <vector>

#include "src/form_factor/area_form_factors.h"

namespace exitance {

struct PatchRadiosity {
  std::vector<double> B, H, B_error;  ///< of patch p and band b at [p * bands + b]
};

/// Solves B = E + ρ F B. B_error bounds the distance to the solution with true form factors, as far as the form
/// factors' errors hold. E and rho: patch p and band b at [p * bands + b]. Throws InvalidSystem (radiosity_system.h).
PatchRadiosity patch_radiosity(const AreaFormFactors& form_factors, const std::vector<double>& E,
                               const std::vector<double>& rho, std::size_t bands);

}  // namespace exitance
