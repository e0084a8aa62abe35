#pragma once
// The radiosity equation of a finite number of patches: B_p = E_p + ρ_p H_p, H_p = Σ_q F_pq B_q, for every band.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "src/form_factor/form_factor_matrix.h"

namespace exitance {

/// What counts of each band: of three the luminance 0.2126 R + 0.7152 G + 0.0722 B, of any other number the sum.
std::vector<double> luminance_weights(std::uint32_t bands);

/// Thrown when something is no radiosity system: sizes that do not match, a reflectance outside [0, 1), a number that
/// is not finite, or form factors of a row that sum to more than 1 by more than their errors.
class InvalidSystem : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// By how much more than its errors a row of that many form factors may sum to more than 1: a row made to sum to 1 in
/// plain arithmetic misses it by up to one rounding an entry.
constexpr double row_sum_rounding(std::size_t entries) {
  return static_cast<double>(entries + 4) * std::numeric_limits<double>::epsilon();
}

/// Patches, which shoot, cut into elements, which receive. Values of patch p and band b stand at [p * bands + b].
struct Discretisation {
  std::uint32_t bands = 3;
  std::vector<std::uint32_t> element_first{0};  ///< patches + 1: the elements of p are element_first[p] … [p + 1] − 1
  std::vector<double> element_area;             ///< [m²], > 0
  std::vector<double> rho;                      ///< reflectance of each patch and band, in [0, 1)
  std::vector<double> E;                        ///< self-emitted exitance of each patch and band, finite

  std::size_t patches() const { return element_first.size() - 1; }
  std::size_t elements() const { return element_area.size(); }
};

/// Throws InvalidSystem when the sizes do not match or a number is out of range; each patch needs an element.
void check(const Discretisation& discretisation);

/// Area of each patch [m²]: the sum of its elements'.
std::vector<double> patch_areas(const Discretisation& discretisation);

/// One unknown a patch and band. Values of patch p and band b stand at [p * bands + b].
struct RadiositySystem {
  std::uint32_t bands = 3;
  std::vector<double> area;  ///< [m²] of each patch, > 0
  std::vector<double> rho;   ///< in [0, 1)
  std::vector<double> E;     ///< finite
  FormFactorMatrix F;        ///< patches × patches

  std::size_t patches() const { return area.size(); }
};

/// Throws InvalidSystem when the sizes do not match, a number is out of range, or a row of F sums to more than 1 plus
/// its errors (row_sum_rounding aside; no bound of the solution's error could then be proven).
void check(const RadiositySystem& system);

/// The system of the patches, from the rows of their elements (elements × patches) averaged by area.
RadiositySystem make_system(const Discretisation& discretisation, const FormFactorMatrix& element_rows);

/// Exitance B and irradiance H of every patch and band, [W/m²] or whatever unit E has.
struct Solution {
  std::vector<double> B, H;
  std::uint64_t iterations = 0;  ///< sweeps or Krylov steps; shots
  double residual = 0;  ///< ‖E + ρ F B − B‖∞ (shooting: ‖unshot B‖∞) relative to max |B|, worst band
  double error_bound = 0;  ///< proven: ‖B − B*‖∞ relative to max |B|, worst band; B* solves the system with F as it is
  bool converged = false;  ///< whether error_bound is within the tolerance
};

/// H of every row and band: Σ_q F_iq B_q, one rounding away from exact. Rows in parallel; any number of threads gives
/// the same bits.
std::vector<double> irradiance(const FormFactorMatrix& rows, std::span<const double> B, std::uint32_t bands);

/// B of every element and band from its H: E + ρ H with its patch's E and ρ.
std::vector<double> element_exitance(const Discretisation& discretisation, std::span<const double> element_H);

}  // namespace exitance
