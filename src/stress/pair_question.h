#pragma once
// What a receiver and a source exchange: form factors between polygons.

#include "src/stress/verdict.h"

namespace exitance {

/// F from the receiver to the source and back, as `cases` answers (both_ways: integrated over both), or as matrices are
/// made (over one of them), to 1e-6.
Opinion ask_pair(const Question& question, bool both_ways);

/// Within the errors of both: F, F back. Takes a tenth of a second. Throws
/// OutOfReach (pair_oracle.h) where the oracle cannot tell.
Truth pair_truth(const Question& question);

}  // namespace exitance
