#pragma once
// A solution as files and as a report.

#include <filesystem>

#include "src/output/report.h"
#include "src/scene/scene.h"
#include "src/solve/scene_solution.h"

namespace exitance {

/// Everything that scene and solution tell, and the build's manifest; memory, times of loading and writing, threads and
/// options are the caller's to add.
Report make_report(const Scene& scene, const SceneSolution& solution);

/// Writes solution.vtp (B, H, E, rho and row_sum of the elements), solution.ply and image.png (as the scene's camera
/// sees it, else a camera of our choice). Throws InputError when that fails.
void write_solution(const std::filesystem::path& folder, const Scene& scene, const SceneSolution& solution);

}  // namespace exitance
