#pragma once
// A hierarchical radiosity solution in a scene that changes.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "src/links/link_update.h"
#include "src/scene/edit.h"
#include "src/solve/convergence_error.h"

namespace exitance {

/// What is done after an edit.
enum class LinkMethod : std::uint8_t {
  rebuild,  ///< everything from scratch
  direct,   ///< every link tested again, those that are affected un-refined and refined; then sweeps over all links
  hvt,      ///< the same by hierarchical visibility testing
  hvt_peu   ///< and by progressive energy update: only differences of significant links are shot
};

struct LinkOptions {
  MeshOptions mesh;  ///< what the patches are
  /// Shares of the largest luminance of E that is given: links are refined while B F is above eps2, un-refined when it
  /// falls below eps1, and left as they are by PEU where it could not change by more than B_eps. 0 ≤ eps1 ≤ eps2.
  double eps2 = 5e-3, eps1 = 2.5e-3, B_eps = 1e-4;
  /// [m²] no sub-patch is smaller, about; 0: a 6,000th of the area of all patches.
  double smallest_area = 0;
  unsigned points_per_edge = 2;  ///< squared, the points by which a sub-patch receives over a link
  /// Of the exchange of energy: bound of B's error relative to max B; of PEU, the share of energy that may stay unshot.
  double tolerance = 1e-6;
};

/// What building or updating did and took.
struct LinkUpdate {
  LinkWork work;
  LinkExchange exchange;     ///< of PEU, whose iterations are rounds of shots, without bounds
  std::uint64_t rounds = 0;  ///< of refinement and exchange, when built
  bool stopped = false;      ///< before all links were refined that should be
  double seconds_scene = 0;  ///< wall clock: obstacles and their indices, places of nodes
  double seconds_links = 0;  ///< finding, testing and refining links
  double seconds_exchange = 0;
  double seconds = 0;      ///< in all
  double cpu_seconds = 0;  ///< in all, of all threads: what else runs on the machine counts little
};

class LinkedRadiosity {
 public:
  /// Has no links yet. Throws std::invalid_argument on options out of range, and what PatchTree throws.
  LinkedRadiosity(Scene scene, const LinkOptions& options);

  const EditedScene& scene() const { return scene_; }
  const PatchTree& tree() const { return tree_; }
  const LinkIndex& links() const { return links_; }
  const NodeRadiosity& radiosity() const { return radiosity_; }
  const Obstacles& obstacles() const { return *obstacles_; }
  const LinkOptions& options() const { return options_; }

  /// From nothing: links are refined and energy is exchanged in turn, until a round refines none: B F of none was above
  /// eps2 then. `stop`, asked by any thread, ends the refinement early (LinkUpdate::stopped). Throws LimitError when
  /// the links would not fit in mesh.memory_limit.
  LinkUpdate build(const std::function<bool()>& stop = {});

  /// Edits that happen at once. Throws InvalidEdit, and has then done those before it. REQUIRES: built.
  LinkUpdate update(std::span<const Edit> edits, LinkMethod method);

  /// B by node and band of the same links, with every value as the scene has it, converged to 1e-12 of max B.
  std::vector<double> converged() const;

  /// The nodes that links divide patches into, whole patches included: by node, whether a link ends there or below.
  /// Only of what is there.
  std::vector<std::uint8_t> nodes_in_use() const;
  /// The smallest of those, and what lies beside them: they tile all patches. In the
  /// order of surfaces, those of one root side by side.
  std::vector<std::uint32_t> elements() const;

 private:
  LinkTask task(LinkScope scope) const;
  void exchange(LinkUpdate& update);

  LinkOptions options_;
  EditedScene scene_;
  std::unique_ptr<Obstacles> obstacles_, before_;
  PatchTree tree_;
  NodeRadiosity radiosity_;
  LinkIndex links_;
  double brightest_ = 0;                     ///< luminance of E
  std::vector<std::uint8_t> moved_, relit_;  ///< by object, of the edit that is being worked on
  bool any_stale_ = false;
};

/// Equation 7 over elements(). By node and band: the reference, what it was before and what it is.
ConvergenceError link_error(const PatchTree& tree, std::span<const std::uint32_t> elements, std::uint32_t bands,
                            std::span<const double> reference, std::span<const double> was,
                            std::span<const double> current);

}  // namespace exitance
