#pragma once
// How far a solution is from the converged one of the same elements.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace exitance {

/// Equation 7 of George, Sillion and Greenberg 1990: root mean square of luminance, weighted by area, relative to that
/// of the reference.
struct ConvergenceError {
  double all = 0;
  double worst_1_percent = 0;  ///< of the 1 % (at least one) whose luminance changed most, |y_ref − y_was|
};

/// Over `elements`, of the given areas [m²]. By element and band: `reference`, what it `was` before (may be shorter:
/// 0), and `current`. Of equal changes the first count; where all of the reference is 0 (what has become dark), errors
/// are relative to what it was; 0 / 0 is 0.
ConvergenceError convergence_error(std::span<const std::uint32_t> elements,
                                   const std::function<double(std::uint32_t)>& area, std::uint32_t bands,
                                   std::span<const double> reference, std::span<const double> was,
                                   std::span<const double> current);

/// The 1 % (at least one) of `elements` whose luminance changed most, ascending, as above.
std::vector<std::uint32_t> most_changed(std::span<const std::uint32_t> elements, std::uint32_t bands,
                                        std::span<const double> reference, std::span<const double> was);

}  // namespace exitance
