#pragma once
// What a version of a scene converges to, by a way of its own: all form factors at once, and gathering.

#include <vector>

#include "src/dynamic/dynamic_radiosity.h"

namespace exitance {

/// B by element and band of the present scene, solved by gathering to 1e-13 of max B from all rows of form factors;
/// nothing of what has been shot is used. 0 where an element is not there. In parallel; any number of threads gives the
/// same bits.
std::vector<double> converged_reference(const DynamicRadiosity& state);

/// Equation 7 of George, Sillion and Greenberg 1990 over elements that are there, and over the 1 % of them (at least
/// one) whose luminance changed most, |y_ref − y_before|; of equals the first. by element and band: `reference`, what
/// it `was` before (may be shorter: 0), and `current`. 0 / 0 is 0.
struct ConvergenceError {
  double all = 0, worst_1_percent = 0;
};
ConvergenceError convergence_error(const SceneVersion& version, std::uint32_t bands,
                                   const std::vector<double>& reference, const std::vector<double>& was,
                                   const std::vector<double>& current);

}  // namespace exitance
