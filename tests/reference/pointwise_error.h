#pragma once
// How far a solution of one band is, as a function of the point, from one that is known everywhere.

#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "src/form_factor/area_cell.h"
#include "src/reference/patch_polynomials.h"
#include "src/scene/patch_mesh.h"

namespace exitance {

/// True B at a point of a surface.
using Truth = std::function<double(std::uint32_t surface, const Vec3& point)>;

/// ∫ (B − truth)² dA and ∫ truth² dA over the mesh, B polynomials of that degree with the given means over elements, by
/// Gauss rules on 2^halvings parts of each element.
inline std::pair<double, double> squares_of(const PatchMesh& mesh, std::uint32_t degree, std::span<const double> B,
                                            const Truth& truth, int halvings) {
  const PatchPolynomials polynomials(mesh, degree);
  const std::vector<double> coefficients = polynomials.fit(B, 1);
  std::vector<double> terms(polynomials.terms());
  std::vector<WeightedPoint> points;
  double missed = 0, all = 0;
  for (std::uint32_t e = 0; e < mesh.elements.size(); ++e) {
    const std::uint32_t patch = mesh.elements[e].patch;
    const double shift = B[e] - polynomials.mean(e, coefficients, 1, 0);
    std::vector<AreaCell> cells = cells_of(mesh.loop(mesh.elements[e]));
    for (int k = 0; k < halvings; ++k) {
      std::vector<AreaCell> halves;
      for (const AreaCell& cell : cells) {
        const auto [one, other] = bisect(cell);
        halves.insert(halves.end(), {one, other});
      }
      cells = std::move(halves);
    }
    for (const AreaCell& cell : cells) {
      gauss_points(cell, 12, points);
      for (const WeightedPoint& x : points) {
        polynomials.terms_at(patch, x.point, terms);
        double value = shift;
        for (std::size_t t = 0; t < terms.size(); ++t) value += terms[t] * coefficients[patch * terms.size() + t];
        const double wanted = truth(mesh.patches[patch].surface, x.point);
        missed += x.weight * (value - wanted) * (value - wanted);
        all += x.weight * wanted * wanted;
      }
    }
  }
  return {missed, all};
}

/// The norm of equation 7 of what is missed.
inline double pointwise_error(const PatchMesh& mesh, std::uint32_t degree, std::span<const double> B,
                              const Truth& truth, int halvings) {
  const auto [missed, all] = squares_of(mesh, degree, B, truth, halvings);
  return std::sqrt(missed / all);
}

}  // namespace exitance
