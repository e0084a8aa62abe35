#pragma once
// The number type of last resort.

#include <boost/multiprecision/mpfr.hpp>

namespace exitance {

/// 80 decimal digits, 266 bits.
using Extended =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<80, boost::multiprecision::allocate_stack>,
                                  boost::multiprecision::et_off>;

}  // namespace exitance
