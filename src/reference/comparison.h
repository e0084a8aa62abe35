#pragma once
// How far a solution is from a reference: the area-weighted luminance norm of George, Sillion and Greenberg (1990),
// equation 7,
//
//   Error = √( Σ_i A_i (y_i^ref − y_i^cur)² / Σ_i A_i (y_i^ref)² ),
//
// for solutions of one scene on any two meshes.

#include <vector>

#include "src/reference/solution_record.h"

namespace exitance {

struct Comparison {
  /// Equation 7 with the elements of the current solution as i; y_i^ref is the reference's area mean over element i, so
  /// that what counts are an element's values and not how coarse it is.
  double error = 0;
  /// Likewise over the 1 % of the area where |y_ref − y_cur| is largest (the last element counts in part).
  double error_worst_1_percent = 0;
  /// The same as integrals over all surfaces, of y_ref and y_cur as functions of the point (record's degree): how
  /// coarse elements are counts, too.
  double pointwise_error = 0;
  std::vector<double> Y_reference, Y_current;  ///< of each element of the current solution
};

/// Elements are laid over each other surface by surface, each piece clipped by each, and polynomials are integrated
/// over what they share: exact but for rounding, whether one mesh refines the other or not.
///  - A reference that is 0 everywhere: errors are 0 if the other is, too, else infinite.
///  - Elements without area count for nothing.
///  - Solutions of different scenes (scene_hash), with different bands or without values for all their bands, and
///  meshes
///    that do not cover the same surfaces: InputError that names the current solution.
/// In parallel; any number of threads gives the same bits.
Comparison compare(const SolutionRecord& reference, const SolutionRecord& current);

/// ∫ (u − v)² dA over each patch, u and v the functions with those means over the elements (one value each) and
/// polynomials of those degrees.
std::vector<double> squared_distances(const PatchMesh& mesh, std::span<const double> u, std::uint32_t degree_u,
                                      std::span<const double> v, std::uint32_t degree_v);

}  // namespace exitance
