#pragma once
// A hierarchy above patches: groups of patches in space, halved down to single ones.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"
#include "geometry/spatial_index.h"
#include "src/links/patch_tree.h"

namespace exitance {

/// Some patches, or one.
struct Cluster {
  Box box;                             ///< around them
  Vec3 centre;                         ///< of the box
  double radius = 0;                   ///< of the ball around the box
  std::uint32_t first = 0, count = 0;  ///< its patches, among those of all clusters
  std::uint32_t parent = kNone;
  std::uint32_t first_child = kNone;  ///< of two, which stand side by side; kNone: of a single patch

  bool single() const { return first_child == kNone; }
};

/// Where a patch is, as seen from afar.
struct PatchPlace {
  Vec3 middle, normal;  ///< unit
  double area = 0;      ///< [m²] of it that nothing covers
};

/// Top-down. A patch whose box is more than half as long as its cluster's is parted from those that are smaller, so
/// that no small one shares its clusters with a wall; others are parted at the middle of the longest axis over their
/// middles, or, where all of these are in one place, half by half. The same tree gives the same clusters.
class PatchClusters {
 public:
  /// Of no patches.
  PatchClusters() = default;
  /// Of all that are there. soup: that of the tree's facets.
  PatchClusters(const PatchTree& tree, const PolygonSoup& soup);

  /// Parents before their children; the first holds everything. Empty where there is no patch.
  std::span<const Cluster> clusters() const { return clusters_; }
  const Cluster& cluster(std::uint32_t c) const { return clusters_[c]; }
  /// The roots of the tree, those of a cluster side by side.
  std::span<const std::uint32_t> roots_of(const Cluster& cluster) const {
    return std::span(roots_).subspan(cluster.first, cluster.count);
  }
  /// By root.
  const PatchPlace& place(std::uint32_t root) const { return places_[root]; }
  /// The cluster of this root alone, or kNone where it is not there.
  std::uint32_t cluster_of(std::uint32_t root) const { return single_[root]; }

 private:
  void divide(std::uint32_t cluster, std::span<const Box> boxes);
  void add(std::uint32_t parent, std::uint32_t first, std::uint32_t count, std::span<const Box> boxes);

  std::vector<Cluster> clusters_;
  std::vector<std::uint32_t> roots_;
  std::vector<PatchPlace> places_;
  std::vector<std::uint32_t> single_;
};

}  // namespace exitance
