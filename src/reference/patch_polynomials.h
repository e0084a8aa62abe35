#pragma once
// Functions on a mesh that are known by their means over elements: on every patch a polynomial, fitted to the means of
// its elements, and on every element shifted so that its mean is right. Degree 0 is constant on every element.

#include <cstdint>
#include <span>
#include <vector>

#include "src/scene/patch_mesh.h"

namespace exitance {

/// Values of several bands are interleaved: value of element e and band b at [e * bands + b].
class PatchPolynomials {
 public:
  static constexpr std::uint32_t kHighestDegree = 3;

  /// The degree that a grid of n² elements determines, with some to spare: n − 1, but no more than kHighestDegree.
  static std::uint32_t degree_of_grid(std::uint32_t n);

  /// The mesh must outlive it, and in degrees above 0 each of its patches must be plane and have
  /// enough elements in general position, as a grid has. Throws std::invalid_argument where there are fewer than terms.
  PatchPolynomials(const PatchMesh& mesh, std::uint32_t degree);

  /// Terms of the polynomial of a patch.
  std::size_t terms() const { return (degree_ + 1) * (degree_ + 2) / 2; }

  /// Coefficients [(patch * terms + term) * bands + band] by least squares, elements weighted by area. The polynomial's
  /// mean over a patch is that of the elements.
  std::vector<double> fit(std::span<const double> means, std::uint32_t bands) const;

  /// All terms at a point of a patch, as values of one band: the polynomial is their product with its coefficients.
  void terms_at(std::uint32_t patch, const Vec3& point, std::span<double> terms) const;

  /// Mean over element e of the polynomial of its patch, of one band.
  double mean(std::uint32_t element, std::span<const double> coefficients, std::uint32_t bands,
              std::uint32_t band) const;

  /// What elements have to shoot for H of a function that varies within them, though form factors know constant
  /// exitance only: its mean over each element plus a correction with which Σ_c F_ic · value_c is the integral of
  /// kernel times function wherever the kernel, too, is a polynomial of that degree on the patch. A function that is
  /// constant on a patch is left as it is.
  std::vector<double> shooting_values(std::span<const double> means, std::uint32_t bands) const;

 private:
  struct Frame {
    Vec3 centre, along, across;  ///< coordinates are dot products with the vector from the centre, −1 … 1 on the patch
  };

  const PatchMesh* mesh_;
  std::uint32_t degree_;
  std::vector<Frame> frames_;
  std::vector<std::size_t> first_;  // of each patch in the following, terms × elements
  std::vector<double> mean_;        // [element][term]: mean of a term over an element
  std::vector<double> fit_;         // [term][element]
  std::vector<double> correction_;  // [element][term]: of shooting values, by coefficients
};

}  // namespace exitance
