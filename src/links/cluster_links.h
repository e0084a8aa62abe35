#pragma once
// Links between clusters of patches, for what is too little to be looked at patch by patch (Smits, Arvo and Greenberg,
// "A clustering algorithm for radiosity in complex environments", SIGGRAPH 1994).
//
// A link from a cluster Q to a cluster P stands while what it could bring to any point of P is no more than eps2, as
// with links between patches. The bound is proven, as for any point
//   H ≤ max B of Q · min(1, (R / D)²), R the radius of the ball around Q's box, D its centre's distance from P's box,
//   H ≤ Σ A_j B_j / (π d²), d the distance of both boxes.
// Else its larger end is divided, down to pairs of single patches, which get links as they do without clusters: with
// eps2 = 0 there are the same links, and so the same solution. It holds for a cluster that sees itself, too: d = 0, it
// is divided until max B ≤ eps2.
//
// What a link brings is estimated: patch i of P receives, from the direction of Q's centre,
//   H_i = V cos θ_i / (π r_i²) Σ_j A_j cos θ_j B_j, r_i from its middle to Q's centre, θ_j towards P's centre,
// where Σ A_j cos θ_j is cut to the cross-section π R² of Q's ball (R no more than D). V is what is seen, exactly,
// between up to two patches of P and two of Q, of either child that whose projected area towards the other cluster is
// the largest, each from one point. As neither the estimate nor the truth exceeds the bound, a link's error is no more
// than eps2. Where the boxes touch or overlap, no direction means anything, and nothing is brought, which is wrong by
// no more, either. A patch that is an end of such a link is not divided for it, however large it is: it receives the
// same all over, which the bound covers, too.

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "src/links/link_index.h"
#include "src/links/link_sight.h"
#include "src/links/patch_clusters.h"

namespace exitance {

/// Light goes from the source to the destination.
struct ClusterLink {
  std::uint32_t source = 0, destination = 0;  ///< clusters
  double factor = 0;                          ///< V min(1, π R² / Σ A_j cos θ_j) / π; 0 where nothing is brought
};

class ClusterLinks {
 public:
  /// Of no clusters: brings nothing.
  ClusterLinks() = default;
  /// Of all patches that are there, with one link: everything sees itself. All must live as long.
  ClusterLinks(const PatchTree& tree, const Obstacles& obstacles);

  struct Refinement {
    std::uint64_t divided = 0;     ///< links that were
    std::vector<PatchPair> pairs;  ///< of patches that remain and face each other, ascending: to get links of their own
  };
  /// Divides links until none could bring more than eps2 (≥ 0) by the luminances of B, by node. In parallel; the same
  /// for any number of threads. Once `stop` is true nothing is divided any more. Throws LimitError when links and pairs
  /// would take more than `most_bytes`; there are no links then.
  Refinement refine(std::span<const double> luminance, double eps2, const std::function<bool()>& stop = {},
                    std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

  /// H [W/m²] of every root and band, which stands at [root * width + band], from values by node and band at
  /// [node * width + band]. Linear, and monotone. In parallel; the same bits for any number of threads.
  void gather(std::span<const double> B, std::size_t width, std::vector<double>& H) const;

  const PatchClusters& clusters() const { return clusters_; }
  std::span<const ClusterLink> links() const { return links_; }
  std::uint64_t bytes() const;
  bool empty() const { return links_.empty(); }

 private:
  double bound(const ClusterLink& link) const;
  void set_factors(std::span<ClusterLink> links);
  std::vector<std::uint32_t> faces_of(const Cluster& cluster, const Vec3& direction) const;

  const PatchTree* tree_ = nullptr;
  const Obstacles* obstacles_ = nullptr;
  PatchClusters clusters_;
  std::vector<ClusterLink> links_;      ///< by destination
  std::vector<std::size_t> first_;      ///< by cluster, and the end: its links as a destination
  std::vector<double> most_, emitted_;  ///< by cluster: the largest luminance, and Σ A Y of what is open
};

}  // namespace exitance
