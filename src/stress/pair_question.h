#pragma once
// What a receiver and a source exchange: form factors between polygons.

#include "src/stress/verdict.h"

namespace exitance {

/// F from the receiver to the source and back, as `cases` answers (both_ways: integrated over both), or as matrices are
/// made (over one of them), to 1e-4 or by 5,000 points for each pair of facets.
Opinion ask_pair(const Question& question, bool both_ways);

/// Within the errors of both: F, and F back. Sampled first; what is further apart than the margin and six standard
/// errors then is wrong where it disagrees with the full oracle, too (pair_oracle.h). Verdict::error is by how much F
/// differs beyond the oracle's error, or six standard errors. Throws OutOfReach, and so may the judge, where the oracle
/// cannot tell.
Truth pair_truth(const Question& question);

}  // namespace exitance
