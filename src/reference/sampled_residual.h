#pragma once
// What a solution misses of its own light, gathered at points: what its polynomials have not seen shows there.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"
#include "src/scene/patch_mesh.h"
#include "src/solve/radiosity_system.h"
#include "src/visibility/contacts.h"

namespace exitance {

/// A solution on the elements of a mesh, each one convex piece on a plane patch. Values by element and band.
struct MeshSolution {
  const PatchMesh& mesh;
  const RadiositySystem& system;  ///< one unknown an element, form factors between elements
  std::uint32_t degree = 0;       ///< of the polynomials that B is on patches (patch_polynomials.h)
  std::span<const double> B;      ///< means over elements
  std::span<const double> shot;   ///< what elements shoot (PatchPolynomials::shooting_values)
};

/// B as polynomials have it, against E + ρ H at points, H from exact visibility of the elements and what they shoot.
/// Estimates that compare what is fitted to the same means agree on what no mean shows, such as a shadow that is small
/// against an element; points that have nothing to do with elements' means do not.
class SampledResidual {
 public:
  /// Keeps a reference to the soup.
  explicit SampledResidual(const PolygonSoup& soup) : soup_(soup), contacts_(soup) {}

  /// Estimates of ∫ (Y gathered − Y)² dA over each of the named patches, Y luminance. Light that comes straight from
  /// emitters, whose shadows are the sharpest, is gathered at 64 points of each element and the rest at one, as that
  /// asks for the form factors to all elements; the norms of both are added. Where the mean of the 64 points misses
  /// that of the element, light varies in spots that they do not see: these are taken to be of 1/256 of it.
  ///
  /// In parallel; the same bits for any number of threads. Nothing where `stop`, which may be empty, says so: it is
  /// asked between blocks of points.
  std::optional<std::vector<double>> squares(const MeshSolution& solution, std::span<const std::uint32_t> patches,
                                             const std::function<bool()>& stop) const;

 private:
  const PolygonSoup& soup_;
  Contacts contacts_;
};

}  // namespace exitance
