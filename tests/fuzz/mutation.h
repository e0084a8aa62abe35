#pragma once
// Files that are nearly right.

#include <string>
#include <vector>

#include "src/stress/placement.h"

namespace exitance {

/// One of the seeds with one to six changes: bits, bytes, chunks and lines flipped, cut, repeated, exchanged with those
/// of another seed; numbers replaced by extreme ones, in digits or in binary. The same numbers give the same bytes.
std::string mutated(const std::vector<std::string>& seeds, Random& random);

}  // namespace exitance
