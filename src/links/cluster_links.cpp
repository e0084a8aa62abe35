#include "src/links/cluster_links.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "src/scene/input_error.h"

namespace exitance {
namespace {

/// Links or patches that a thread takes at once, at least.
constexpr std::size_t kTogether = 64;

double distance(const Box& a, const Box& b) {
  Vec3 gap;
  for (int axis = 0; axis < 3; ++axis)
    gap[axis] = std::max({0.0, a.lower[axis] - b.upper[axis], b.lower[axis] - a.upper[axis]});
  return norm(gap);
}

}  // namespace

ClusterLinks::ClusterLinks(const PatchTree& tree, const Obstacles& obstacles)
    : tree_(&tree), obstacles_(&obstacles), clusters_(tree, obstacles.soup()) {
  if (clusters_.clusters().size() > 1) links_.push_back({0, 0, 0});
  first_.assign(clusters_.clusters().size() + 1, links_.size());
  first_[0] = 0;
}

std::uint64_t ClusterLinks::bytes() const {
  return links_.capacity() * sizeof(ClusterLink) + first_.capacity() * sizeof(std::size_t) +
         clusters_.clusters().size() * (sizeof(Cluster) + sizeof(PatchPlace) + 2 * sizeof(std::uint32_t));
}

/// Of H at any point of the destination, in luminance.
double ClusterLinks::bound(const ClusterLink& link) const {
  const Cluster &to = clusters_.cluster(link.destination), &from = clusters_.cluster(link.source);
  const double R = from.radius, d = distance(to.box, from.box), D = distance(to.box, {from.centre, from.centre});
  const double of_ball = D > R ? R * R / (D * D) : 1;
  const double of_power = d > 0 ? emitted_[link.source] / (std::numbers::pi * d * d) : most_[link.source];
  return std::min(most_[link.source] * of_ball, of_power);
}

ClusterLinks::Refinement ClusterLinks::refine(std::span<const double> luminance, double eps2,
                                              const std::function<bool()>& stop, std::uint64_t most_bytes) {
  const std::span<const Cluster> clusters = clusters_.clusters();
  most_.assign(clusters.size(), 0);
  emitted_.assign(clusters.size(), 0);
  for (std::size_t c = clusters.size(); c-- > 0;) {  // children stand behind their parents
    if (clusters[c].single()) {
      const std::uint32_t r = clusters_.roots_of(clusters[c]).front();
      const Root& root = tree_->root(r);
      most_[c] = *std::ranges::max_element(luminance.subspan(root.node_first, root.node_count));
      // At most: of what is covered, too, so that without threshold what is wholly covered is linked like the rest.
      emitted_[c] = tree_->node(root.node_first).area * luminance[root.node_first];
    } else {
      const std::uint32_t a = clusters[c].first_child, b = a + 1;
      most_[c] = std::max(most_[a], most_[b]);
      emitted_[c] = emitted_[a] + emitted_[b];
    }
  }

  Refinement refinement;
  std::vector<ClusterLink> standing, made, divided, next;
  std::vector<std::uint8_t> divides;
  std::atomic<bool> stopped = false;
  bool first = true;
  for (std::vector<ClusterLink> links = std::move(links_); !links.empty(); links = std::move(next), first = false) {
    divides.assign(links.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, links.size(), kTogether), [&](const auto& range) {
      if (stop && !stopped && stop()) stopped = true;
      for (std::size_t k = range.begin(); k < range.end(); ++k) divides[k] = !stopped && bound(links[k]) > eps2;
    });
    next.clear();
    for (std::size_t k = 0; k < links.size(); ++k) {
      const std::size_t all = standing.size() + made.size() + links.size() + next.size();
      if (all * sizeof(ClusterLink) + refinement.pairs.size() * sizeof(PatchPair) > most_bytes)
        throw LimitError("there is no memory for the links of groups of patches; choose a larger threshold");
      if (divides[k] == 0) {
        (first ? standing : made).push_back(links[k]);
        continue;
      }
      ++refinement.divided;
      const Cluster &to = clusters[links[k].destination], &from = clusters[links[k].source];
      const bool divides_to = !to.single() && (from.single() || to.radius >= from.radius);
      for (std::uint32_t child = 0; child < 2; ++child) {
        ClusterLink link;
        link.destination = divides_to ? to.first_child + child : links[k].destination;
        link.source = divides_to ? links[k].source : from.first_child + child;
        const Cluster &to_child = clusters[link.destination], &from_child = clusters[link.source];
        if (!to_child.single() || !from_child.single()) {
          next.push_back(link);
          continue;
        }
        const std::uint32_t r = clusters_.roots_of(to_child).front(), s = clusters_.roots_of(from_child).front();
        const Node &receiver = tree_->node(tree_->root(r).node_first), &source = tree_->node(tree_->root(s).node_first);
        if (r != s && face_each_other(receiver, source, obstacles_->soup())) refinement.pairs.push_back({r, s});
      }
    }
  }
  std::ranges::sort(refinement.pairs);
  set_factors(made);
  standing.insert(standing.end(), made.begin(), made.end());
  const auto by_ends = [](const ClusterLink& a, const ClusterLink& b) {
    return std::pair(a.destination, a.source) < std::pair(b.destination, b.source);
  };
  std::ranges::sort(standing, by_ends);
  links_ = std::move(standing);
  first_.assign(clusters.size() + 1, 0);
  for (const ClusterLink& link : links_) ++first_[link.destination + 1];
  for (std::size_t c = 0; c < clusters.size(); ++c) first_[c + 1] += first_[c];
  return refinement;
}

/// Of either child, or of the one that there is, the patch with the largest projected area; none where none has any.
std::vector<std::uint32_t> ClusterLinks::faces_of(const Cluster& cluster, const Vec3& direction) const {
  std::vector<std::uint32_t> faces;
  const auto add = [&](const Cluster& part) {
    double most = 0;
    std::uint32_t found = kNone;
    for (const std::uint32_t r : clusters_.roots_of(part)) {
      const double area = clusters_.place(r).area * dot(clusters_.place(r).normal, direction);
      if (area <= most) continue;
      most = area;
      found = r;
    }
    if (found != kNone) faces.push_back(found);
  };
  if (cluster.single()) {
    add(cluster);
  } else {
    add(clusters_.cluster(cluster.first_child));
    add(clusters_.cluster(cluster.first_child + 1));
  }
  return faces;
}

void ClusterLinks::set_factors(std::span<ClusterLink> links) {
  tbb::enumerable_thread_specific<std::unique_ptr<LinkSight>> sights(
      [&] { return std::make_unique<LinkSight>(*tree_, *obstacles_, 1); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, links.size(), kTogether), [&](const auto& range) {
    LinkSight& sight = *sights.local();
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      ClusterLink& link = links[k];
      link.factor = 0;
      const Cluster &to = clusters_.cluster(link.destination), &from = clusters_.cluster(link.source);
      if (distance(to.box, from.box) == 0) continue;
      const Vec3 direction = normalized(from.centre - to.centre);
      const std::vector<std::uint32_t> receivers = faces_of(to, direction), sources = faces_of(from, -1 * direction);
      double all = 0, seen = 0;
      for (const std::uint32_t r : receivers) {
        for (const std::uint32_t s : sources) {
          const std::uint32_t receiver = tree_->root(r).node_first, source = tree_->root(s).node_first;
          if (!face_each_other(tree_->node(receiver), tree_->node(source), obstacles_->soup())) continue;
          const double F = sight.form_factor(receiver, source);
          const Sight between = sight.between_roots(receiver, source);
          all += F;
          seen += between.state == Sight::State::open ? F : sight.visible_form_factor(receiver, source, between);
          sight.forget(between);
        }
      }
      if (!(all > 0)) continue;
      double projected = 0;
      for (const std::uint32_t r : clusters_.roots_of(from))
        projected += clusters_.place(r).area * std::max(0.0, -dot(clusters_.place(r).normal, direction));
      const double R = std::min(from.radius, distance(to.box, {from.centre, from.centre}));
      const double cut = std::min(1.0, std::numbers::pi * R * R / projected);
      link.factor = std::min(1.0, seen / all) * cut / std::numbers::pi;
    }
  });
}

void ClusterLinks::gather(std::span<const double> B, std::size_t width, std::vector<double>& H) const {
  // Of each link: its factor times what the source sends towards the destination.
  std::vector<double> sent(links_.size() * width);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, links_.size(), kTogether), [&](const auto& range) {
    std::vector<long double> sum(width);
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      const ClusterLink& link = links_[k];
      if (link.factor == 0) continue;
      const Cluster &to = clusters_.cluster(link.destination), &from = clusters_.cluster(link.source);
      const Vec3 direction = normalized(to.centre - from.centre);
      std::ranges::fill(sum, 0);
      for (const std::uint32_t r : clusters_.roots_of(from)) {
        const PatchPlace& place = clusters_.place(r);
        const double projected = place.area * dot(place.normal, direction);
        if (projected <= 0) continue;
        const std::size_t node = tree_->root(r).node_first;
        for (std::size_t b = 0; b < width; ++b) sum[b] += static_cast<long double>(projected) * B[node * width + b];
      }
      for (std::size_t b = 0; b < width; ++b) sent[k * width + b] = static_cast<double>(link.factor * sum[b]);
    }
  });
  H.assign(tree_->roots().size() * width, 0);
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(tree_->roots().size()), kTogether),
                    [&](const auto& range) {
                      std::vector<long double> sum(width);
                      for (std::uint32_t r = range.begin(); r < range.end(); ++r) {
                        const PatchPlace& place = clusters_.place(r);
                        std::ranges::fill(sum, 0);
                        for (std::uint32_t c = clusters_.cluster_of(r); c != kNone; c = clusters_.cluster(c).parent) {
                          for (std::size_t k = first_[c]; k < first_[c + 1]; ++k) {
                            if (links_[k].factor == 0) continue;
                            const Vec3 d = clusters_.cluster(links_[k].source).centre - place.middle;
                            const double cosine = dot(place.normal, d);
                            if (cosine <= 0) continue;
                            const double square = dot(d, d), geometry = cosine / (square * std::sqrt(square));
                            for (std::size_t b = 0; b < width; ++b)
                              sum[b] += static_cast<long double>(geometry) * sent[k * width + b];
                          }
                        }
                        for (std::size_t b = 0; b < width; ++b) H[r * width + b] = static_cast<double>(sum[b]);
                      }
                    });
}

}  // namespace exitance
