#pragma once
// Luminance of solutions over links and of versions of a scene, as records: to be laid over others (comparison.h).

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "src/dynamic/dynamic_radiosity.h"
#include "src/links/hierarchical_solution.h"
#include "src/reference/solution_record.h"
#include "src/solve/radiosity_system.h"

namespace exitance {

/// Y: by element of the mesh. soup: the mesh's.
inline SolutionRecord luminance_record(PatchMesh mesh, const PolygonSoup& soup, std::vector<double> Y) {
  for (std::size_t k = 0; k < mesh.pieces.size(); ++k) {
    PatchPiece piece = mesh.pieces[k];
    if (piece.loop_count > 0 || !soup.is_present(piece.facet)) continue;
    const auto corners = soup.corners(soup.facets()[piece.facet]);
    piece.loop_first = static_cast<std::uint32_t>(mesh.points.size());
    piece.loop_count = static_cast<std::uint32_t>(corners.size());
    for (const Corner& c : corners) mesh.points.push_back(c.at);
    mesh.pieces.set(k, piece);
  }
  constexpr double unknown = std::numeric_limits<double>::infinity();
  SolutionRecord record;
  record.bands = 1;
  record.mesh = std::move(mesh);
  record.B = std::move(Y);
  record.error = {unknown, unknown, unknown, unknown};
  return record;
}

/// Of one that has all bands.
inline SolutionRecord luminance_record(SolutionRecord record) {
  record.B = luminance(record.B, record.bands, record.mesh.elements.size());
  record.bands = 1;
  record.scene_hash.clear();
  return record;
}

/// The elements are those of links.elements(), in this order.
inline SolutionRecord luminance_record(const LinkedRadiosity& links) {
  const std::vector<double> weights = luminance_weights(links.radiosity().bands());
  std::vector<double> Y;
  for (const std::uint32_t n : links.elements()) {
    Y.push_back(0);
    for (std::uint32_t b = 0; b < weights.size(); ++b) Y.back() += weights[b] * links.radiosity().whole_B(n, b);
  }
  return luminance_record(mesh_of(links), links.obstacles().soup(), std::move(Y));
}

/// The elements that are there.
inline std::vector<std::uint32_t> present_elements(const SceneVersion& version) {
  std::vector<std::uint32_t> elements;
  for (std::uint32_t e = 0; e < version.elements(); ++e) {
    if (version.has_element(e)) elements.push_back(e);
  }
  return elements;
}

/// By element of the state.
inline std::vector<double> luminance_of(const DynamicRadiosity& state) {
  return luminance(state.element_B(), state.bands(), state.version().elements());
}

/// The elements are those of present_elements, in this order.
inline SolutionRecord luminance_record(const DynamicRadiosity& state) {
  const SceneVersion& version = state.version();
  const std::vector<double> of_state = luminance_of(state);
  PatchMesh mesh;
  mesh.points = version.mesh().points;
  mesh.pieces = version.mesh().pieces;
  std::vector<double> Y;
  for (std::uint32_t p = 0; p < version.patches(); ++p) {
    if (version.object_of_patch(p) == SceneVersion::kVoid) continue;
    Patch patch = version.mesh().patches[p];
    const std::uint32_t first = std::exchange(patch.element_first, static_cast<std::uint32_t>(mesh.elements.size()));
    for (std::uint32_t e = first; e < first + patch.element_count; ++e) {
      Element element = version.mesh().elements[e];
      element.patch = static_cast<std::uint32_t>(mesh.patches.size());
      mesh.elements.push_back(element);
      Y.push_back(of_state[e]);
    }
    mesh.patches.push_back(patch);
  }
  return luminance_record(std::move(mesh), version.soup(), std::move(Y));
}

}  // namespace exitance
