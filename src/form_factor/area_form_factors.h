#pragma once
// Form factors between polygons: F_ij is the mean over i of the form factor from its points to j.

#include <cstdint>
#include <span>
#include <vector>

#include "src/form_factor/area_mean.h"

namespace exitance {

/// Exchange between two polygons. A_i F_ij = A_j F_ji by construction: both come from the better-conditioned one of two
/// independent integrals, and their error covers what the other one says.
struct PairFormFactor {
  double F = 0, F_reverse = 0;
  double F_error = 0, F_reverse_error = 0;  ///< estimates of |F − true F| that are meant to hold
  bool reached = true;                      ///< whether both errors are within the tolerance
};

/// A soup and the same one with nothing in the way.
class AreaScene {
 public:
  AreaScene(std::span<const Polygon> polygons, std::span<const Role> roles);

  const PolygonSoup& soup() const { return soup_; }
  AreaViews views() const { return {Viewpoint(soup_), Viewpoint(open_)}; }
  double area(std::uint32_t polygon) const { return area_[polygon]; }  ///< [m²]

 private:
  PolygonSoup soup_, open_;
  std::vector<double> area_;
};

/// F from polygon i to j and back, i ≠ j, both patches of positive area. Each of the two integrals takes at most
/// `points` points.
PairFormFactor pair_form_factor(const AreaScene& scene, AreaViews& views, std::uint32_t i, std::uint32_t j,
                                double tolerance, std::uint64_t points);

/// Points that each integral of a scene of so many pairs may take, so that the whole of it ends within seconds.
std::uint64_t points_per_integral(std::uint64_t pairs);

/// A full matrix: entry (i, j) at [i * n + j].
struct AreaFormFactors {
  std::size_t n = 0;
  std::vector<double> F, F_error;
  std::vector<double> area;  ///< [m²]
  bool reached = true;
};

/// All pairs of the scene's polygons, which must be patches of positive area. In parallel; any number of threads gives
/// the same bits.
AreaFormFactors area_form_factors(const AreaScene& scene, double tolerance);

}  // namespace exitance
