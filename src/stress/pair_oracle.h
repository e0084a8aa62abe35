#pragma once
// What two polygons exchange past obstacles, by another route than the library's: convex pieces and convex bodies,
// given to exchange_truth.h, after contacts have been settled with rational coordinates.

#include <cstdint>
#include <stdexcept>

#include "src/stress/question.h"

namespace exitance {

/// A question that the oracle cannot tell the answer of, and why.
class OutOfReach : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct PairOracleAnswer {
  long double F = 0, F_reverse = 0;
  long double error = 0, reverse_error = 0;
  long double standard_error = 0, reverse_standard_error = 0;  ///< of samples; within the error
};

enum class Care : std::uint8_t {
  sampled,  ///< along directions, in a second or two: to six standard errors, mostly 3e-5 of the smaller one at most;
            ///< but what is seen in few directions may be missed, which makes the error larger
  full  ///< to some 1e-8, along two axes, which takes ten seconds; the error covers what these say of each other
};

/// Form factors between the fronts of receiver and source. What lies within 1e-11 of their size of the plane of one of
/// them is in contact with it: where it lies in front, exactly, or in the plane and covers it (Role), it is cut off;
/// solids that stand on it cover it whatever rounding has done. The error covers the gaps of contacts, and
/// parts that rise above a plane by less than 1e-14 of the size. Throws
/// OutOfReach where receiver and source lie in one plane but for rounding, or where there are more pieces, or edges
/// between, than can be looked at. REQUIRES: what `answer` (point_question.h) does not refuse.
PairOracleAnswer oracle_pair_form_factors(const Question& question, Care care);

}  // namespace exitance
