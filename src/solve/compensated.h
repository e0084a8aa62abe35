#pragma once
// Sums and dot products as if in twice the working precision: Ogita, Rump, Oishi, "Accurate sum and dot product", SIAM
// J. Sci. Comput. 26 (2005), algorithms TwoSum, TwoProduct (with a fused multiply-add), Sum2 and Dot2. Round to nearest
// is assumed; results that underflow are outside the bounds.

#include <cmath>
#include <cstdint>
#include <span>

namespace exitance {

/// Running sum. Relative to the sum of magnitudes, n terms leave an error of 2^-53 of the result and n² 2^-105 beside
/// it.
class CompensatedSum {
 public:
  CompensatedSum() = default;
  CompensatedSum(double high, double low) : high_(high), low_(low) {}

  void add(double term) {
    const double sum = high_ + term;
    const double part = sum - high_;
    low_ += (high_ - (sum - part)) + (term - part);
    high_ = sum;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    low_ += std::fma(a, b, -product);
    add(product);
  }
  void add(const CompensatedSum& other) {
    add(other.high_);
    low_ += other.low_;
  }
  double value() const { return high_ + low_; }
  double high() const { return high_; }
  double low() const { return low_; }

 private:
  double high_ = 0, low_ = 0;
};

/// out[b] = Σ_k values[k] · x[columns[k] · bands + b] for every band b: a compressed row times interleaved columns.
/// |out − exact| ≤ 2^-53 |exact| + (n 2^-52)² Σ|values x|, n = columns.size() (the paper's Proposition 5.5).
inline void row_product(std::span<const std::uint32_t> columns, std::span<const double> values, const double* x,
                        std::uint32_t bands, double* out) {
  const auto some_bands = [&]<int count>(std::uint32_t first, std::integral_constant<int, count>) {
    CompensatedSum sum[count];
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const double* at = x + std::size_t{columns[k]} * bands + first;
      for (int b = 0; b < count; ++b) sum[b].add_product(values[k], at[b]);
    }
    for (int b = 0; b < count; ++b) out[first + static_cast<std::uint32_t>(b)] = sum[b].value();
  };
  // Three sums (RGB) run side by side in the time that one takes.
  std::uint32_t first = 0;
  for (; first + 3 <= bands; first += 3) some_bands(first, std::integral_constant<int, 3>{});
  for (; first < bands; ++first) some_bands(first, std::integral_constant<int, 1>{});
}

}  // namespace exitance
