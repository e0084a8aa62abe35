#pragma once
// Whether an opinion is right.

#include "src/stress/point_contender.h"
#include "src/stress/visibility_oracle.h"

namespace exitance {

struct Verdict {
  bool is_wrong = false;
  double error = 0;           ///< of F
  double relative_error = 0;  ///< where the true F is at least 1e-15, else 0
};

/// Wrong: further from the truth than the margin and the rounding of F; or, where the contender commits itself, blocked
/// though some area is seen, open though some is hidden, away though some is above the horizon and faces the point.
Verdict judge(const Opinion& opinion, const OracleAnswer& truth);

}  // namespace exitance
