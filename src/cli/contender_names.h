#pragma once
// Contenders as they are named on the command line.

#include <string>
#include <vector>

#include "src/reference/contender.h"

namespace exitance {

/// "exact:T" (tolerance T), "rays:N", "rays:N:SAMPLER:ESTIMATOR" (either may be left out), or a matrix file (.h5, .csv,
/// .txt). defaults: of rays. Throws CLI::ValidationError for what is none of them.
std::vector<Contender> contenders_named(const std::vector<std::string>& names, const RayOptions& defaults);

}  // namespace exitance
