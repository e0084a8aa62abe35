#pragma once
// A hierarchical radiosity solution in a scene that changes.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "src/links/abandon.h"
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
  /// Shares of the largest luminance of E that is given: links are refined while B F, F a bound for any point of the
  /// receiver (most_form_factor), is above eps2, un-refined when it falls below eps1, and left as they are by PEU where
  /// what they bring could not change by more than B_eps. 0 ≤ eps1 ≤ eps2.
  double eps2 = 5e-3, eps1 = 2.5e-3, B_eps = 1e-4;
  /// [m²] no sub-patch is smaller, about; 0: default_smallest_area.
  double smallest_area = 0;
  unsigned points_per_edge = 2;  ///< squared, the points by which a sub-patch receives over a link
  /// Whether pairs of patches get links of their own only where those of their clusters do not do (cluster_links.h).
  /// Nothing but rebuilding follows an edit then.
  bool clusters = false;
  std::uint64_t most_rounds = 30;  ///< of refinement and exchange, when links are built
  /// Of the exchange of energy: bound of B's error relative to max B; of PEU, the share of energy that may stay unshot.
  double tolerance = 1e-6;
};

/// [m²] a 6,000th of the area of all patches, those included that an edit may bring.
double default_smallest_area(const Scene& scene);

/// What building or updating did and took.
struct LinkUpdate {
  LinkWork work;
  LinkExchange exchange;         ///< of PEU, whose iterations are rounds of shots, without bounds
  std::uint64_t rounds = 0;      ///< of refinement and exchange, when built
  bool stopped = false;          ///< before all links were refined that should be, when built
  std::uint64_t pairs_left = 0;  ///< of patches, at whose links an interrupted update has not looked
  double seconds_scene = 0;      ///< wall clock: obstacles and their indices, places of nodes
  double seconds_links = 0;      ///< finding, testing and refining links
  double seconds_exchange = 0;
  double seconds = 0;      ///< in all
  double cpu_seconds = 0;  ///< in all, of all threads: what else runs on the machine counts little
};

/// When an update ends early, and what it has done by then.
struct LinkInterruption {
  /// Asked now and then, by any thread where everything is rebuilt or in any order; what has been looked at then is
  /// exchanged all the same: neither that, nor finding the pairs that are to be looked at, ends early.
  std::function<bool()> stop;
  LinkOrder order = LinkOrder::importance;
  /// Asked throughout, between patches and sweeps, by any thread: once it is true the update throws Abandoned.
  Abandon abandon;
};

class LinkedRadiosity {
 public:
  /// Has no links yet. Throws std::invalid_argument on options out of range, and what PatchTree throws.
  LinkedRadiosity(Scene scene, const LinkOptions& options);
  LinkedRadiosity(const LinkedRadiosity&) = delete;  // what it has refers to its tree
  LinkedRadiosity& operator=(const LinkedRadiosity&) = delete;

  const EditedScene& scene() const { return scene_; }
  const PatchTree& tree() const { return tree_; }
  const LinkIndex& links() const { return links_; }
  const ClusterLinks& cluster_links() const { return clusters_; }
  const NodeRadiosity& radiosity() const { return radiosity_; }
  const Obstacles& obstacles() const { return *obstacles_; }
  const LinkOptions& options() const { return options_; }

  /// From nothing: links are refined and energy is exchanged in turn, until a round refines none: B F of none was above
  /// eps2 then. `stop`, asked by any thread, or most_rounds end the refinement early (LinkUpdate::stopped); the order
  /// does not count. Throws LimitError when the links would not fit in mesh.memory_limit, and Abandoned; it is to be
  /// built again then.
  LinkUpdate build(const LinkInterruption& interruption = {});

  /// Edits that happen at once. What an interrupted update leaves keeps its links as they were, until work_off, which
  /// leaves the links that the update would have left, or marked stale until later updates. Rebuilding ends early as
  /// build does (LinkUpdate::stopped), and nothing goes on with it. All or nothing: throws
  /// InvalidEdit, what PatchTree throws, Abandoned and what `stop` and `abandon` throw, LimitError when there would be
  /// too many links, std::invalid_argument for clusters with another method than rebuild, and is then as before.
  /// REQUIRES: built.
  LinkUpdate update(std::span<const Edit> edits, LinkMethod method, const LinkInterruption& interruption = {});

  /// Goes on with what the last update left, the same way. Once nothing is left, direct and hvt leave the bits that an
  /// update leaves which was not interrupted, B included; hvt_peu leaves links whose values are the same, and a B that
  /// differs by what its shots may leave unshot. REQUIRES: built.
  LinkUpdate work_off(const LinkInterruption& interruption = {});

  /// What links bring together that updates have left as they were (Link::stale and below), by node, luminance of ρ H
  /// [W/m²]: about by how much B may be off at most, before that is reflected on. Empty where nothing was left, as by
  /// HVT that was not interrupted.
  std::vector<double> left_as_it_was() const;

  /// B by node and band of the same links, with every value as the scene has it, converged to 1e-12 of max B. Throws
  /// Abandoned as updates do.
  std::vector<double> converged(const Abandon& abandon = {}) const;

  /// The nodes that links divide patches into, whole patches included: by node, whether a link ends there or below.
  /// Only of what is there.
  std::vector<std::uint8_t> nodes_in_use() const;
  /// The smallest of those, and what lies beside them: they tile all patches. In the
  /// order of surfaces, those of one root side by side.
  std::vector<std::uint32_t> elements() const;

 private:
  /// What an update looks at, one after the other.
  enum class Stage : std::uint8_t {
    sight,      ///< what objects that moved affect, and what is stale
    materials,  ///< what brings more or less light than before
    new_light   ///< once it was exchanged: what is stale and comes from patches that are much brighter now
  };
  /// What an interrupted update left, and what it goes by.
  struct Pending {
    LinkMethod method = LinkMethod::hvt;
    Stage stage = Stage::sight;
    std::vector<PendingPair> pairs;  ///< of this stage; empty where they have not been sought yet
    std::shared_ptr<const Obstacles> before;
    std::vector<std::uint8_t> moved, relit;  ///< by object
    /// As it stood when the first pairs were left: by it links are refined, and gathering begins from it in the end.
    std::shared_ptr<const NodeRadiosity> radiosity;
    bool any_stale = false;                  ///< before this stage
    bool skipped = false;                    ///< whether this stage has left something stale
  };

  LinkTask task(LinkScope scope) const;
  std::uint64_t bytes_left() const;
  template <class Work>
  LinkUpdate all_or_nothing(const Work& work);
  void change(std::span<const Edit> edits, LinkMethod method, const LinkInterruption& interruption, LinkUpdate& update);
  void follow(Pending pending, const LinkInterruption& interruption, LinkUpdate& update);
  bool look_at_pairs(Pending& pending, LinkScope scope, const LinkInterruption& interruption, LinkUpdate& update,
                     const std::vector<std::uint32_t>* sources = nullptr);
  void judge_all();
  std::vector<std::uint32_t> judge_what_is_brighter();
  void mark_pending(LinkIndex& links) const;
  void gather(LinkUpdate& update, const Abandon& abandon);
  void shoot(LinkUpdate& update, const Abandon& abandon);

  LinkOptions options_;
  EditedScene scene_;
  std::shared_ptr<const Obstacles> obstacles_;
  PatchTree tree_;
  NodeRadiosity radiosity_;
  LinkIndex links_;
  ClusterLinks clusters_;
  double brightest_ = 0;  ///< luminance of E
  /// By node: at most the luminance by which the energies of links from it were found, and at most what it has.
  std::vector<double> judged_;
  bool any_stale_ = false;  ///< whether some link may be
  std::optional<Pending> pending_;
};

/// Equation 7 over what is open of elements(). By node and band: the reference, what it was before and what it is.
ConvergenceError link_error(const PatchTree& tree, std::span<const std::uint32_t> elements, std::uint32_t bands,
                            std::span<const double> reference, std::span<const double> was,
                            std::span<const double> current);

}  // namespace exitance
