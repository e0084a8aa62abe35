#pragma once
// Radiosity of the nodes of quadtrees: what links bring is pushed down to the leaves and pulled up as means (Hanrahan,
// Salzman and Aupperle, "A rapid hierarchical radiosity algorithm", SIGGRAPH 1991).

#include <cstdint>
#include <span>
#include <vector>

#include "src/links/abandon.h"
#include "src/links/cluster_links.h"
#include "src/links/link_index.h"
#include "src/links/patch_tree.h"
#include "src/scene/scene.h"

namespace exitance {

/// Sweeps or rounds of shots after which an exchange of energy ends at the latest.
inline constexpr std::uint64_t kMostExchanges = 10'000;

/// How far a solution over links is from the one that they have. All are relative to max B, of the worst band.
struct LinkExchange {
  std::uint64_t iterations = 0;  ///< sweeps
  double residual = 0;           ///< what the last sweep changed
  /// Proven, rounding included: ‖B − B*‖∞ ≤ ‖r‖∞ max w / (1 − d), r what a sweep changes, for any w > 0 with
  /// w − ρ F w ≥ 1 − d > 0. Here w is 1 and its first reflections, by the largest ρ of each patch. Row sums of ρ F may
  /// exceed 1 somewhere, as those of few points do in narrow gaps.
  double error_bound = 0;
  bool converged = false;
  double factor = 0;  ///< of the bound: max w / (1 − d)
};

/// B [W/m²] of every node and band at [node * bands + band]; of a leaf E + ρ H with H the sum of what its own links and
/// those of the nodes above it bring, E where all of it is covered; of others the mean of the leaves, weighted by their
/// open areas: links bring what is seen, which is never what is covered. 0 where nothing is there.
class NodeRadiosity {
 public:
  /// The tree must live as long.
  NodeRadiosity(const PatchTree& tree, const EditedScene& scene);

  std::uint32_t bands() const { return bands_; }
  std::span<const double> B() const { return B_; }
  /// Mean over all of a node, where what is covered has its E.
  double whole_B(std::uint32_t node, std::uint32_t band) const;
  /// By node.
  std::span<const double> luminance() const { return Y_; }
  /// By root and band.
  std::span<const double> rho() const { return rho_; }
  std::span<const double> E() const { return E_; }

  /// Every node gets its E: nothing has been exchanged.
  void start_over();

  /// After an edit of the geometry of an object: nodes that are new, or there again, get their E. What is gone keeps
  /// its B until it is cleared, so that it can be told what its links brought.
  void change_geometry(const EditedScene& scene, std::uint32_t object);
  void clear_what_is_gone();
  /// After the edits: what covers nodes is now what the tree says. B follows with H as it is, and what that changes, of
  /// means, too, remains to be shot.
  void change_covering();
  /// Reflectances and emissions of an object are now those of the scene. B becomes E' + ρ' H with H as it is; what that
  /// changes remains to be shot.
  void change_materials(const EditedScene& scene, std::uint32_t object);

  /// Sweeps over all links, each of which gathers at all patches at once (Jacobi), until the error bound is within the
  /// tolerance, or rounding, or `most` sweeps end it. `abandon` is asked before each. In parallel; the same bits for
  /// any number of threads. What clusters bring, patches receive evenly.
  LinkExchange gather(const LinkIndex& links, const ClusterLinks& clusters, double tolerance,
                      const Abandon& abandon = {}, std::uint64_t most = kMostExchanges);

  /// [W/m²] what a link that changed brings more than before; to be pushed. Different receiving roots: any threads.
  void receive(std::uint32_t node, double transfer, std::uint32_t source);
  /// Pushes what was received and shoots it on, the patches with the most unshot energy (A |ΔB|, luminance, A what is
  /// open) first: in rounds of those that have a tenth of the most, until no more than `share` of the energy that all
  /// patches had at most is left or `most` rounds are done. `abandon` is asked before each. Returns the rounds.
  std::uint64_t shoot(const LinkIndex& links, double share, const Abandon& abandon = {},
                      std::uint64_t most = kMostExchanges);

  /// H [W/m²] of a leaf, each band, as of the last exchange.
  std::span<const double> leaf_H(std::uint32_t node) const { return {H_.data() + std::size_t{node} * bands_, bands_}; }

 private:
  void fit_arrays();
  void set_materials(const EditedScene& scene, std::uint32_t object);
  void start(std::uint32_t root);
  double B_of_leaf(std::uint32_t node, std::uint32_t band) const;
  void renew(std::uint32_t root);
  void pull(std::uint32_t root, std::vector<double>& values, std::size_t bands);
  void pull_changes(std::uint32_t root);
  template <class Changed>
  void pull(std::uint32_t root, std::vector<double>& values, std::size_t bands, const Changed& changed);
  void find_luminance(std::uint32_t root);

  const PatchTree* tree_;
  std::uint32_t bands_;
  std::vector<double> weights_;
  std::vector<double> rho_, E_;                     ///< by root and band
  std::vector<double> B_, next_, H_;                ///< by node and band
  std::vector<double> Y_;                           ///< by node
  std::vector<double> w_, next_w_;                  ///< by node, of the error bound
  std::vector<double> received_, unshot_;           ///< by node and band
  std::vector<std::uint8_t> has_received_, there_;  ///< by root
  std::vector<std::uint8_t> weighs_anew_;           ///< by root: its means have changed by themselves; not yet shot
};

/// By node: Σ F over its links, those of the nodes above it and those of clusters.
std::vector<double> row_sums(const LinkIndex& links, const ClusterLinks& clusters, const PatchTree& tree);

/// Sets the energy of every link, B F of its source; or of all links from some patches; or of links with all their
/// descendants. REQUIRES of the first: the index keeps no changes.
void set_energies(LinkIndex& links, const PatchTree& tree, std::span<const double> luminance);
void set_energies(LinkIndex& links, const PatchTree& tree, std::span<const double> luminance,
                  std::span<const std::uint32_t> sources);
void set_energies(std::span<Link> links, const PatchTree& tree, std::span<const double> luminance);

/// Form factor by which a link's energy is judged: form_factor itself; where no point of the receiver lies in front of
/// the source, but some of what is open of it may, what a small source at the distance of the nodes' middles would
/// have.
double judged_form_factor(const Node& receiver, const Node& source, double form_factor);

}  // namespace exitance
