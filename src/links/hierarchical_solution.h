#pragma once
// A scene's radiosity by hierarchical links, as a solution like those of gathering and shooting.

#include "src/links/linked_radiosity.h"
#include "src/solve/scene_solution.h"

namespace exitance {

struct HierarchicalOptions {
  LinkOptions links;
  std::uint64_t seed = 1;      ///< of the pairs whose reciprocity is measured
  std::function<bool()> stop;  ///< asked by any thread; ends the refinement early (SceneSolution::stopped)
};

struct HierarchicalSolution {
  SceneSolution solution;  ///< elements: those of LinkedRadiosity; patches.iterations: sweeps of the last exchange
  LinkUpdate update;
  LinkCounts links;
  std::uint64_t sub_patches = 0;                  ///< nodes in use
  std::uint64_t clusters = 0, cluster_links = 0;  ///< 0 without clusters
  LinkOptions options;                            ///< as they were used
};

/// Solves the scene; values of elements and patches are means over all of them, what is covered included. moves: by
/// object, what counts as dynamic in the counts. Closure, covered points and pairs are measured at up to 256 elements.
/// Energy balance and reciprocity are those of links and patches with their quadrature and thresholds; the balance is
/// that of the elements' open area, as nothing leaves or reaches what is covered. The same bits for any number of
/// threads. Throws what LinkedRadiosity and its tree throw, InputError for a scene in which no
/// surface has an area.
HierarchicalSolution solve_by_links(const Scene& scene, const HierarchicalOptions& options,
                                    std::span<const std::uint8_t> moves);

/// The elements of links, as patches (roots of the tree, in order) and elements of a mesh; of roots that are there.
PatchMesh mesh_of(const LinkedRadiosity& links);

}  // namespace exitance
