#include "src/reference/matrix_solution.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "src/scene/scene_hash.h"
#include "src/solve/gather.h"
#include "src/visibility/visibility.h"

namespace exitance {
namespace {

constexpr double kTolerance = 1e-12;

/// Every piece with its loop, as a record wants it.
PatchMesh with_loops(PatchMesh mesh, const PolygonSoup& soup) {
  for (std::size_t k = 0; k < mesh.pieces.size(); ++k) {
    PatchPiece piece = mesh.pieces[k];
    if (piece.loop_count > 0) continue;
    const auto corners = soup.corners(soup.facets()[piece.facet]);
    piece.loop_first = static_cast<std::uint32_t>(mesh.points.size());
    piece.loop_count = static_cast<std::uint32_t>(corners.size());
    for (const Corner& c : corners) mesh.points.push_back(c.at);
    mesh.pieces.set(k, piece);
  }
  return mesh;
}

SolutionRecord record(const Scene& scene, const PolygonSoup& soup, const PatchMesh& mesh, std::vector<double> B) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  return {.source = scene.name,
          .scene = scene.name,
          .scene_hash = scene_hash(scene),
          .unit = scene.unit,
          .bands = scene.bands,
          .mesh = with_loops(mesh, soup),
          .B = std::move(B),
          .error = {unknown, unknown, unknown, unknown}};
}

}  // namespace

SolutionRecord record_of(const Scene& scene, const SceneSolution& solution) {
  return record(scene, solution.soup, solution.mesh, solution.element_B);
}

SolutionRecord solve_matrix(const Scene& scene, const PolygonSoup& soup, const PatchMesh& mesh, FormFactorMatrix F) {
  std::ranges::fill(F.F_error, kBoundOfAny);  // no better is known of all of them
  const Discretisation d = discretise(scene, mesh);
  RadiositySystem system{d.bands, patch_areas(d), d.rho, d.E, std::move(F)};
  check(system);
  const Solution solution = gather(system, {.tolerance = kTolerance});
  std::vector<double> B;
  for (std::size_t p = 0; p < d.patches(); ++p) {
    for (std::uint32_t e = d.element_first[p]; e < d.element_first[p + 1]; ++e) {
      for (std::uint32_t b = 0; b < d.bands; ++b) B.push_back(solution.B[p * d.bands + b]);
    }
  }
  return record(scene, soup, mesh, std::move(B));
}

}  // namespace exitance
