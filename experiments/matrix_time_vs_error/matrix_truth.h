#pragma once
// What a matrix of form factors is compared with, once it has been verified.

#include "src/form_factor/pair_rows.h"
#include "src/reference/matrix_comparison.h"

namespace exitance {

/// What is true of all pairs, and how it is known.
struct KnownMatrix {
  MatrixTruth truth;
  std::uint64_t by_points = 0;  ///< pairs whose integral did not reach the tolerance within its points
  /// Of what is taken for true: stated by the integral, or four standard errors; root mean square over all entries.
  double largest_error = 0, rms_error = 0;
};

/// Form factors between the patches of a scene by exact integration to a tolerance. Where an integral does not reach
/// it, the mean of what exact visibility sees from 32,768 points of the smaller patch, spread evenly by Owen's
/// scrambling in 16 independent sets, takes its place if four standard errors of it are less. Then it is verified: no
/// row sums to more than 1, no entry exceeds what its pair's areas allow, 40 pairs integrated over the other patch
/// agree within their errors, and 40 pairs agree with rays at two offsets within what rays know. Throws
/// std::runtime_error where that does not hold. The same bits for any number of threads.
KnownMatrix known_matrix(const ExchangeScene& exchange, double tolerance);

}  // namespace exitance
