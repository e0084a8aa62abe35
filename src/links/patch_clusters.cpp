#include "src/links/patch_clusters.h"

#include <algorithm>

namespace exitance {

PatchClusters::PatchClusters(const PatchTree& tree, const PolygonSoup& soup)
    : places_(tree.roots().size()), single_(tree.roots().size(), kNone) {
  std::vector<Box> boxes(tree.roots().size());
  for (std::uint32_t r = 0; r < tree.roots().size(); ++r) {
    if (!tree.root(r).present) continue;
    const Node& node = tree.node(tree.root(r).node_first);
    for (const Vec3& v : node.loop()) boxes[r].extend(v);
    std::vector<NodePoint> middle;
    node_points(node, 1, middle);
    places_[r] = {middle.front().at, normalized(soup.facets()[node.facet].plane.normal), node.open_area};
    roots_.push_back(r);
  }
  if (roots_.empty()) return;
  add(kNone, 0, static_cast<std::uint32_t>(roots_.size()), boxes);
  for (std::uint32_t c = 0; c < clusters_.size(); ++c) {
    if (clusters_[c].count > 1) {
      divide(c, boxes);
    } else {
      single_[roots_[clusters_[c].first]] = c;
    }
  }
}

void PatchClusters::add(std::uint32_t parent, std::uint32_t first, std::uint32_t count, std::span<const Box> boxes) {
  Cluster cluster;
  cluster.parent = parent;
  cluster.first = first;
  cluster.count = count;
  for (const std::uint32_t r : roots_of(cluster)) cluster.box.extend(boxes[r]);
  cluster.centre = 0.5 * (cluster.box.lower + cluster.box.upper);
  cluster.radius = norm(cluster.box.upper - cluster.box.lower) / 2;
  clusters_.push_back(cluster);
}

void PatchClusters::divide(std::uint32_t c, std::span<const Box> boxes) {
  const Cluster cluster = clusters_[c];
  const auto roots = std::span(roots_).subspan(cluster.first, cluster.count);
  auto second = std::stable_partition(roots.begin(), roots.end(), [&](std::uint32_t r) {
    return norm(boxes[r].upper - boxes[r].lower) > cluster.radius;
  });
  if (second == roots.begin() || second == roots.end()) {
    Box middles;
    for (const std::uint32_t r : roots) middles.extend(places_[r].middle);
    const Vec3 extent = middles.upper - middles.lower;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const double at = middles.lower[axis] + extent[axis] / 2;
    second = std::stable_partition(roots.begin(), roots.end(),
                                   [&](std::uint32_t r) { return places_[r].middle[axis] < at; });
  }
  if (second == roots.begin() || second == roots.end()) {
    second = roots.begin() + static_cast<std::ptrdiff_t>(roots.size() / 2);
  }
  const auto of_first = static_cast<std::uint32_t>(second - roots.begin());
  clusters_[c].first_child = static_cast<std::uint32_t>(clusters_.size());
  add(c, cluster.first, of_first, boxes);
  add(c, cluster.first + of_first, cluster.count - of_first, boxes);
}

}  // namespace exitance
