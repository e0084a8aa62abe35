#pragma once
// What a converged solution lacks for being cut into elements: radiosity gathered on a finer mesh.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "src/dynamic/dynamic_radiosity.h"
#include "src/scene/edit.h"

namespace exitance {

/// For each patch or element of a finer mesh of the same scene, the elements of a version that lie there.
class CoarseElements {
 public:
  CoarseElements(const SceneVersion& version, std::size_t surfaces) : version_(version), of_surface_(surfaces) {
    for (std::uint32_t e = 0; e < version.elements(); ++e) {
      if (version.has_element(e))
        of_surface_[version.mesh().patches[version.mesh().elements[e].patch].surface].push_back(e);
    }
  }

  /// Of a surface, the one whose sample point is nearest.
  std::uint32_t nearest(std::uint32_t surface, const Vec3& point) const {
    return *std::ranges::min_element(of_surface_[surface], {}, [&](std::uint32_t e) {
      const Vec3 d = version_.mesh().elements[e].sample - point;
      return dot(d, d);
    });
  }

 private:
  const SceneVersion& version_;
  std::vector<std::vector<std::uint32_t>> of_surface_;
};

/// By element and band of the state, B on `elements`, ascending; elsewhere the state's. On each of them light is
/// gathered by exact visibility at all sample points of the finer mesh that lie on it, from all patches of the finer
/// mesh, which have the radiosity of the state's elements where they lie. A finer mesh's solution differs from this by
/// what the errors of the state's elements bring after one more reflection, which averages them. REQUIRES: the state is
/// converged and `finer` cuts the scene as it is now. In parallel.
inline std::vector<double> finer_radiosity(const DynamicRadiosity& state, const EditedScene& scene,
                                           const MeshOptions& finer, std::span<const std::uint32_t> elements) {
  const std::uint32_t bands = state.bands();
  const std::vector<double> coarse = state.element_B();
  const CoarseElements places(state.version(), scene.scene().surfaces.size());
  const SceneVersion version(scene, finer);
  const PatchMesh& mesh = version.mesh();
  std::vector<std::uint32_t> place(mesh.elements.size());
  std::vector<double> B(mesh.patches.size() * bands);
  for (std::uint32_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    const Patch& patch = mesh.patches[element.patch];
    place[e] = places.nearest(patch.surface, element.sample);
    for (std::uint32_t b = 0; b < bands; ++b)
      B[std::size_t{element.patch} * bands + b] +=
          element.area / patch.area * coarse[std::size_t{place[e]} * bands + b];
  }
  std::vector<std::uint32_t> points;
  for (std::uint32_t e = 0; e < place.size(); ++e) {
    if (std::ranges::binary_search(elements, place[e])) points.push_back(e);
  }
  std::vector<double> H(points.size() * bands);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 1), [&](const auto& some) {
    for (std::size_t k = some.begin(); k < some.end(); ++k) {
      const PointRow row = version.row(points[k]);
      for (std::size_t i = 0; i < row.column.size(); ++i) {
        for (std::uint32_t b = 0; b < bands; ++b)
          H[k * bands + b] += row.F[i] * B[std::size_t{row.column[i]} * bands + b];
      }
    }
  });
  std::vector<double> power(coarse.size()), area(state.version().elements());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double a = mesh.elements[points[k]].area;
    area[place[points[k]]] += a;
    for (std::uint32_t b = 0; b < bands; ++b) power[std::size_t{place[points[k]]} * bands + b] += a * H[k * bands + b];
  }
  std::vector<double> found = coarse;
  for (const std::uint32_t e : elements) {
    if (area[e] == 0) continue;
    const std::uint32_t surface = state.version().mesh().patches[state.version().mesh().elements[e].patch].surface;
    const Material& material = scene.scene().materials[scene.scene().surfaces[surface].material];
    for (std::uint32_t b = 0; b < bands; ++b)
      found[std::size_t{e} * bands + b] =
          material.E[b] + material.rho[b] * (power[std::size_t{e} * bands + b] / area[e]);
  }
  return found;
}

}  // namespace exitance
