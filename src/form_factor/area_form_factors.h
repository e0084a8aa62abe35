#pragma once
// All form factors between a few patches, as a full matrix.

#include <cstddef>
#include <vector>

#include "src/form_factor/pair_form_factor.h"

namespace exitance {

/// A full matrix: entry (i, j) at [i * n + j].
struct AreaFormFactors {
  std::size_t n = 0;
  std::vector<double> F, F_error;
  std::vector<double> area;  ///< [m²]
  bool reached = true;
};

/// In parallel; any number of threads gives the same bits.
AreaFormFactors area_form_factors(const ExchangeScene& scene, const PairOptions& options);

}  // namespace exitance
