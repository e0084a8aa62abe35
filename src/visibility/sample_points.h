#pragma once
// Points spread over the unit square, or over the product of two: where rays go to, or where from and where to.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace exitance {

enum class Sampler : std::uint8_t {
  random,      ///< independent: errors fall as N^-1/2
  stratified,  ///< one at random in each cell of a grid as square as N divides; of two squares, cells paired at random
  sobol,       ///< Sobol's sequence, its digits shifted at random: N^-3/4 across a shadow's edge
  owen         ///< Sobol's sequence, scrambled as Owen (1995) does
};

std::string to_string(Sampler sampler);

/// A fixed number of points for every seed. D is 2 or 4. Any number of threads may ask at once.
template <std::size_t D>
class SamplePoints {
 public:
  using Point = std::array<double, D>;  ///< in (0, 1)

  /// count ≥ 1.
  SamplePoints(Sampler sampler, std::uint32_t count);

  std::uint32_t size() const { return count_; }

  /// The points first … first + points.size() − 1 of those that belong to the seed, neighbours mostly together. Every
  /// point is evenly distributed over all seeds.
  void take(std::uint64_t seed, std::uint32_t first, std::span<Point> points) const;

 private:
  Sampler sampler_;
  std::uint32_t count_;
  std::uint32_t columns_ = 1;                           ///< of the grid of strata
  std::vector<std::array<std::uint32_t, D>> sequence_;  ///< Sobol's, in units of 2^-32
};

extern template class SamplePoints<2>;
extern template class SamplePoints<4>;

}  // namespace exitance
