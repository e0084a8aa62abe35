#pragma once
// Solutions as records, for comparison with others without going through files.

#include "geometry/polygon_soup.h"
#include "src/form_factor/form_factor_matrix.h"
#include "src/reference/solution_record.h"
#include "src/scene/scene.h"
#include "src/solve/scene_solution.h"

namespace exitance {

/// What solve_scene found.
SolutionRecord record_of(const Scene& scene, const SceneSolution& solution);

/// B of the patches of a mesh, constant on each. The mesh must be of the scene and its soup, F patches × patches; its
/// errors are not looked at. Throws InvalidSystem when F makes no radiosity system: entries below 0, rows that sum to
/// more than materials absorb.
SolutionRecord solve_matrix(const Scene& scene, const PolygonSoup& soup, const PatchMesh& mesh, FormFactorMatrix F);

}  // namespace exitance
