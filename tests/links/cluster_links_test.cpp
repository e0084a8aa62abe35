#include "src/links/cluster_links.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "src/scene/furnished_room.h"
#include "src/scene/input_error.h"
#include "src/solve/radiosity_system.h"
#include "tests/links/linked_rooms.h"

namespace exitance {
namespace {

LinkOptions clustered(double eps, double smallest_area = 0.3) {
  LinkOptions options;
  options.eps2 = eps;
  options.eps1 = eps / 2;
  options.smallest_area = smallest_area;
  options.mesh.patch_size = 2 * std::sqrt(smallest_area);
  options.tolerance = 1e-10;
  options.clusters = true;
  return options;
}

TEST(PatchClusters, PartAllPatches) {
  const Scene scene = make_furnished_room(300, 2);
  const LinkedRadiosity links(scene, clustered(1));
  const PatchTree& tree = links.tree();
  const PatchClusters clusters(tree, links.obstacles().soup());
  ASSERT_EQ(clusters.clusters().size(), 2 * tree.roots().size() - 1);
  std::set<std::uint32_t> seen;
  for (std::uint32_t c = 0; c < clusters.clusters().size(); ++c) {
    const Cluster& cluster = clusters.cluster(c);
    for (const std::uint32_t r : clusters.roots_of(cluster)) {
      for (const Vec3& v : tree.node(tree.root(r).node_first).loop()) {
        EXPECT_TRUE(cluster.box.contains(v));
        EXPECT_LE(norm(v - cluster.centre), cluster.radius * (1 + 1e-12));
      }
    }
    if (cluster.single()) {
      ASSERT_EQ(cluster.count, 1u);
      EXPECT_TRUE(seen.insert(clusters.roots_of(cluster).front()).second);
      EXPECT_EQ(clusters.cluster_of(clusters.roots_of(cluster).front()), c);
      continue;
    }
    const Cluster &a = clusters.cluster(cluster.first_child), &b = clusters.cluster(cluster.first_child + 1);
    EXPECT_EQ(a.parent, c);
    EXPECT_EQ(b.parent, c);
    EXPECT_EQ(a.first, cluster.first);
    EXPECT_EQ(b.first, a.first + a.count);
    EXPECT_EQ(a.count + b.count, cluster.count);
  }
  EXPECT_EQ(seen.size(), tree.roots().size());
}

// Every two patches that face each other exchange light once: over their own links, or by one link of their clusters.
TEST(ClusterLinks, JoinEveryPairOfPatchesOnce) {
  LinkedRadiosity links(make_furnished_room(150, 1), clustered(0.01));
  links.build();
  const PatchTree& tree = links.tree();
  const PatchClusters& clusters = links.cluster_links().clusters();
  const std::size_t n = tree.roots().size();
  std::vector<int> joined(n * n);
  for (const ClusterLink& link : links.cluster_links().links()) {
    for (const std::uint32_t r : clusters.roots_of(clusters.cluster(link.destination))) {
      for (const std::uint32_t s : clusters.roots_of(clusters.cluster(link.source))) ++joined[r * n + s];
    }
  }
  std::size_t of_patches = 0, of_clusters = 0;
  for (std::uint32_t r = 0; r < n; ++r) {
    for (std::uint32_t s = 0; s < n; ++s) {
      if (r == s) continue;
      const Node &a = tree.node(tree.root(r).node_first), &b = tree.node(tree.root(s).node_first);
      const bool linked = !links.links().between(r, s).empty();
      if (!face_each_other(a, b, links.obstacles().soup())) {
        EXPECT_FALSE(linked);
        continue;
      }
      ASSERT_EQ(joined[r * n + s] + linked, 1) << r << ", " << s;
      ++(linked ? of_patches : of_clusters);
    }
  }
  EXPECT_GT(of_patches, 100u);
  EXPECT_GT(of_clusters, 10 * of_patches);
}

TEST(ClusterLinks, CountForTheLimitOfMemory) {
  LinkedRadiosity links(make_furnished_room(150, 1), clustered(0.01));
  links.build();
  ClusterLinks again(links.tree(), links.obstacles());
  const std::uint64_t bytes = links.cluster_links().links().size_bytes();
  EXPECT_THROW(again.refine(links.radiosity().luminance(), 1e-4, {}, bytes), LimitError);
  EXPECT_TRUE(again.empty());
  // Room for the links between patches, 64 bytes each, but not for those between clusters, too.
  LinkOptions options = clustered(0.005, 10);
  LinkedRadiosity whole(make_furnished_room(600, 1), options);
  whole.build();
  std::uint64_t of_patches = 0;
  for (std::uint32_t r = 0; r < whole.links().roots(); ++r) of_patches += whole.links().of_receiver(r).size() * 64;
  options.mesh.memory_limit = of_patches + whole.cluster_links().links().size_bytes() / 2;
  LinkedRadiosity part(make_furnished_room(600, 1), options);
  EXPECT_THROW(part.build(), LimitError);
}

// Neither the estimate nor the truth, of form factors between patches past what stands between, is above the threshold,
// so neither is what the one misses the other by. As any pair of patches is joined once, what a receiver gets from the
// patches of a link's source alone is what that link brings.
TEST(ClusterLinks, NeitherBringNorMissMoreThanEps) {
  const double eps2 = 0.02;
  LinkedRadiosity links(make_furnished_room(150, 1), clustered(eps2));
  links.build();
  const Scene& scene = links.scene().scene();
  const std::vector<double> weights = luminance_weights(scene.bands);
  double brightest = 0;
  for (const Surface& s : scene.surfaces) {
    double sum = 0;
    for (std::size_t b = 0; b < weights.size(); ++b) sum += weights[b] * scene.materials[s.material].E[b];
    brightest = std::max(brightest, sum);
  }
  const double most = eps2 * brightest * 1.01;  // B has been exchanged once more since
  const PatchTree& tree = links.tree();
  const ClusterLinks& of_clusters = links.cluster_links();
  const PatchClusters& clusters = of_clusters.clusters();
  const std::span<const double> Y = links.radiosity().luminance();
  LinkSight sight(tree, links.obstacles(), 2);
  double largest_truth = 0, largest_brought = 0;
  for (std::size_t k = 0; k < of_clusters.links().size(); k += 5) {
    const ClusterLink& link = of_clusters.links()[k];
    const auto sources = clusters.roots_of(clusters.cluster(link.source));
    std::vector<double> B(tree.nodes().size()), H;
    for (const std::uint32_t s : sources) B[tree.root(s).node_first] = Y[tree.root(s).node_first];
    of_clusters.gather(B, 1, H);
    const auto receivers = clusters.roots_of(clusters.cluster(link.destination));
    for (std::size_t i = 0; i < receivers.size(); i += 1 + receivers.size() / 3) {
      const std::uint32_t receiver = tree.root(receivers[i]).node_first;
      double truth = 0;
      for (const std::uint32_t s : sources) {
        const std::uint32_t source = tree.root(s).node_first;
        if (s == receivers[i] || !face_each_other(tree.node(receiver), tree.node(source), links.obstacles().soup()))
          continue;
        const Sight between = sight.between_roots(receiver, source);
        truth +=
            Y[source] * (between.state == Sight::State::open ? sight.form_factor(receiver, source)
                                                             : sight.visible_form_factor(receiver, source, between));
        sight.forget(between);
      }
      ASSERT_LE(truth, most);
      ASSERT_LE(H[receivers[i]], most);
      ASSERT_GE(H[receivers[i]], 0);
      ASSERT_TRUE(link.factor > 0 || H[receivers[i]] == 0);
      largest_truth = std::max(largest_truth, truth);
      largest_brought = std::max(largest_brought, H[receivers[i]]);
    }
  }
  EXPECT_GT(largest_truth, most / 20);
  EXPECT_GT(largest_brought, most / 20);
}

TEST(ClusterLinks, SeeThemselvesUntilTheyAreTooBright) {
  LinkedRadiosity scene(room_with_things(), clustered(0.01));
  ClusterLinks links(scene.tree(), scene.obstacles());
  std::vector<double> luminance(scene.tree().nodes().size(), 0.5);
  EXPECT_EQ(links.refine(luminance, 0.5).divided, 0u);
  ASSERT_EQ(links.links().size(), 1u);
  std::vector<double> H;
  links.gather(luminance, 1, H);
  EXPECT_EQ(*std::ranges::max_element(H), 0);
  EXPECT_GT(links.refine(luminance, 0.49).divided, 0u);
  EXPECT_GT(links.links().size(), 1u);
  ClusterLinks all(scene.tree(), scene.obstacles());
  const auto pairs = all.refine(luminance, 0).pairs;
  EXPECT_TRUE(all.empty());
  EXPECT_TRUE(std::ranges::is_sorted(pairs));
  EXPECT_EQ(std::ranges::adjacent_find(pairs), pairs.end());
}

TEST(ClusterLinks, WithoutAThresholdLeaveTheLinksThatThereAreWithoutThem) {
  Scene scene = empty_room();  // all of it is lit
  add(scene, "lamp", box_faces({1.8, 1.6, 1}, {2.1, 1.9, 1.2}, 3, 0));
  add(scene, "shelf", box_faces({2.2, 0.3, 0.9}, {2.9, 1.3, 1}, 2, 0));
  LinkOptions options = clustered(0, 1);
  options.mesh.patch_size = 1.5;
  LinkedRadiosity with(scene, options);
  options.clusters = false;
  LinkedRadiosity without(scene, options);
  with.build();
  without.build();
  EXPECT_TRUE(with.cluster_links().empty());
  for (std::uint32_t r = 0; r < with.links().roots(); ++r) {
    const auto a = with.links().of_receiver(r), b = std::as_const(without.links()).of_receiver(r);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].code, b[k].code);
      EXPECT_EQ(a[k].source, b[k].source);
      EXPECT_EQ(a[k].transfer(), b[k].transfer());
    }
  }
  for (std::size_t n = 0; n < with.tree().nodes().size(); ++n)
    EXPECT_NEAR(with.radiosity().B()[n], without.radiosity().B()[n], 1e-9);
}

// Against the solution by links of all pairs, as the threshold falls.
TEST(ClusterLinks, ErrorFallsWithTheThreshold) {
  const Scene scene = make_furnished_room(150, 1);
  const std::vector<std::uint8_t> moves(scene.objects.size());
  double before = 0.2;
  for (const double eps : {0.02, 0.005, 0.001}) {
    LinkOptions options = clustered(eps);
    options.mesh.patch_size = 1;
    LinkedRadiosity links(scene, options);
    options.clusters = false;
    LinkedRadiosity all(scene, options);
    EXPECT_TRUE(links.build().exchange.converged);
    all.build();
    double missed = 0, whole = 0;
    for (const Root& root : links.tree().roots()) {
      const double area = links.tree().node(root.node_first).area;
      const double B = all.radiosity().luminance()[root.node_first];
      missed += area * std::pow(links.radiosity().luminance()[root.node_first] - B, 2);
      whole += area * B * B;
    }
    const double error = std::sqrt(missed / whole);
    EXPECT_LT(error, 0.6 * before) << eps;
    before = error;
    EXPECT_LT(links.links().count(links.tree(), moves).patch_pairs,
              all.links().count(all.tree(), moves).patch_pairs / 2)
        << eps;
  }
  EXPECT_LT(before, 0.005);
}

TEST(ClusterLinks, AnyNumberOfThreadsGivesTheSameBits) {
  std::vector<std::vector<double>> B;
  for (const std::size_t threads : {1, 3}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    LinkedRadiosity links(make_furnished_room(150, 1), clustered(0.01));
    links.build();
    B.emplace_back(links.radiosity().B().begin(), links.radiosity().B().end());
  }
  EXPECT_TRUE(same_bits(B[0], B[1]));
}

TEST(ClusterLinks, AreRebuiltAndNotUpdated) {
  LinkedRadiosity links(room_with_things(), clustered(0.01));
  links.build();
  const Edit edit = move_to(1, {0.4, 0.2, 0});
  for (const LinkMethod method : {LinkMethod::direct, LinkMethod::hvt, LinkMethod::hvt_peu})
    EXPECT_THROW(links.update({&edit, 1}, method), std::invalid_argument);
  links.update({&edit, 1}, LinkMethod::rebuild);
  LinkedRadiosity anew(links.scene().scene(), clustered(0.01));
  anew.build();
  EXPECT_TRUE(same_bits(links.radiosity().B(), anew.radiosity().B()));
}

}  // namespace
}  // namespace exitance
