#pragma once
// An interval by its middle, in long double, and a bound of the distance to the true value.

#include <cmath>
#include <limits>
#include <optional>

namespace exitance {

/// Every operation adds to the bound what its own rounding may add, u |result|, u = 2^-64 (2^-53 where long double is
/// no longer than double), and what its arguments' errors make of it (running error analysis, Wilkinson 1963). The
/// bound's own roundings, up to 2^-52 of it in each operation, are left to `certain_error`. Nothing under- or overflows
/// where long double has 15 bits of exponent and the arguments are products of up to twelve doubles of moderate size;
/// where it does, the bound is not finite and decides nothing.
class Bounded {
 public:
  explicit Bounded(double v) : value_(v) {}

  long double value() const { return value_; }
  /// Bound of the error after up to 2^12 operations.
  long double certain_error() const { return 1.001L * error_; }

  friend Bounded operator+(const Bounded& a, const Bounded& b) { return sum(a.value_ + b.value_, a, b); }
  friend Bounded operator-(const Bounded& a, const Bounded& b) { return sum(a.value_ - b.value_, a, b); }
  friend Bounded operator*(const Bounded& a, const Bounded& b) {
    Bounded c(0);
    c.value_ = a.value_ * b.value_;
    c.error_ = std::fabs(a.value_) * b.error_ + a.error_ * (std::fabs(b.value_) + b.error_) + rounding(c.value_);
    return c;
  }

 private:
  static long double rounding(long double v) {
    constexpr long double u = std::numeric_limits<long double>::epsilon() / 2;
    return u * std::fabs(v);
  }
  static Bounded sum(long double value, const Bounded& a, const Bounded& b) {
    Bounded c(0);
    c.value_ = value;
    c.error_ = a.error_ + b.error_ + rounding(value);
    return c;
  }

  long double value_, error_ = 0;
};

/// Sign of a value that does not hold 0, or is exactly 0.
inline std::optional<int> certain_sign(const Bounded& a) {
  if (a.value() > a.certain_error()) return 1;
  if (a.value() < -a.certain_error()) return -1;
  if (a.value() == 0 && a.certain_error() == 0) return 0;
  return std::nullopt;
}

}  // namespace exitance
