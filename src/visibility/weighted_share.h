#pragma once
// The share of a weight that rays bring through, and how sure it is.

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace exitance {

class WeightedShare {
 public:
  void add(double weight, bool arrives) {
    all_ += weight;
    all_squares_ += weight * weight;
    if (!arrives) return;
    seen_ += weight;
    seen_squares_ += weight * weight;
    ++arrived_;
  }

  /// Ends one of several independent sets of rays.
  void end_replicate() {
    const double share = all_ > 0 ? seen_ / all_ : 0;
    ++replicates_;
    sum_ += share;
    squares_ += share * share;
    if (all_ > 0) {
      const double squares = (1 - 2 * share) * seen_squares_ + share * share * all_squares_;
      independent_variance_ = std::fmax(squares, 0.0) / (all_ * all_);
    }
    all_ = seen_ = all_squares_ = seen_squares_ = 0;
  }

  /// Mean of the replicates.
  double value() const { return sum_ / replicates_; }

  /// From the spread of the replicates. Of a single one: as if its rays were independent, to first order in 1 / N,
  /// which is too much for points that are spread evenly.
  double standard_error() const {
    if (replicates_ < 2) return std::sqrt(independent_variance_);
    const double mean = value();
    return std::sqrt(std::fmax(squares_ / replicates_ - mean * mean, 0.0) / (replicates_ - 1));
  }

  std::uint64_t arrived() const { return arrived_; }  ///< rays

 private:
  double all_ = 0, seen_ = 0, all_squares_ = 0, seen_squares_ = 0;  // of this replicate
  double sum_ = 0, squares_ = 0, independent_variance_ = 0;
  std::uint32_t replicates_ = 0;
  std::uint64_t arrived_ = 0;
};

}  // namespace exitance
