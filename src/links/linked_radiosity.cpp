#include "src/links/linked_radiosity.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "src/output/run_clock.h"
#include "src/scene/input_error.h"
#include "src/solve/radiosity_system.h"

namespace exitance {
namespace {

/// Rounds of refinement and exchange that building may take, and to what those before the last converge.
constexpr std::uint64_t kMostRounds = 30;
/// About what a link takes in the index.
constexpr std::uint64_t kBytesALink = sizeof(Link) + 16;
constexpr double kWhileBuilding = 1e-3;
constexpr double kConverged = 1e-12;
constexpr double kShareOfArea = 1.0 / 6'000;

double total_area(const Scene& scene) {
  double area = 0;
  for (const auto* surfaces : {&scene.surfaces, &scene.absent}) {
    for (const Surface& s : *surfaces) area += s.obstruction_only ? 0 : norm(area_vector(s.polygon));
  }
  return area;
}

double largest_emission(const Scene& scene) {
  const std::vector<double> weights = luminance_weights(scene.bands);
  double largest = 0;
  for (const auto* surfaces : {&scene.surfaces, &scene.absent}) {
    for (const Surface& s : *surfaces) {
      double Y = 0;
      for (std::size_t b = 0; b < weights.size(); ++b) Y += weights[b] * scene.materials[s.material].E[b];
      largest = std::max(largest, s.obstruction_only ? 0 : Y);
    }
  }
  return largest;
}

LinkOptions checked(LinkOptions options, const Scene& scene) {
  const bool in_range = options.eps1 >= 0 && options.eps1 <= options.eps2 && std::isfinite(options.eps2) &&
                        options.B_eps >= 0 && options.smallest_area >= 0 && options.tolerance > 0 &&
                        options.points_per_edge >= 1 && options.points_per_edge <= 20;
  if (!in_range) throw std::invalid_argument("links: 0 ≤ eps1 ≤ eps2, B_eps ≥ 0, smallest_area ≥ 0, tolerance > 0");
  if (options.smallest_area == 0) options.smallest_area = kShareOfArea * total_area(scene);
  if (!(options.smallest_area > 0)) throw std::invalid_argument("no surface has an area; there is nothing to link");
  return options;
}

}  // namespace

LinkedRadiosity::LinkedRadiosity(Scene scene, const LinkOptions& options)
    : options_(checked(options, scene)),
      scene_(std::move(scene)),
      obstacles_(std::make_unique<Obstacles>(scene_)),
      tree_(scene_, obstacles_->soup(), {options_.mesh, options_.smallest_area}),
      radiosity_(tree_, scene_),
      links_(tree_.roots().size()),
      brightest_(largest_emission(scene_.scene())),
      moved_(scene_.scene().objects.size()),
      relit_(scene_.scene().objects.size()) {}

LinkTask LinkedRadiosity::task(LinkScope scope) const {
  LinkTask task;
  task.tree = &tree_;
  task.now = obstacles_.get();
  task.before = before_.get();
  task.moved = moved_;
  task.relit = relit_;
  task.luminance = radiosity_.luminance();
  task.eps1 = options_.eps1 * brightest_;
  task.eps2 = options_.eps2 * brightest_;
  task.B_eps = options_.B_eps * brightest_;
  task.points_per_edge = options_.points_per_edge;
  task.scope = scope;
  task.any_stale = any_stale_;
  return task;
}

void LinkedRadiosity::exchange(LinkUpdate& update) {
  RunClock watch;
  update.exchange = radiosity_.gather(links_, options_.tolerance);
  set_energies(links_, tree_, radiosity_.luminance());
  update.seconds_exchange += watch.lap();
}

LinkUpdate LinkedRadiosity::build(const std::function<bool()>& stop) {
  RunClock whole;
  LinkUpdate update;
  links_ = LinkIndex(tree_.roots().size());
  any_stale_ = false;
  radiosity_.start_over();
  // Each link that is divided becomes four and a ghost.
  const std::uint64_t most = options_.mesh.memory_limit / (4 * kBytesALink);
  std::atomic<std::uint64_t> divided = 0;
  std::atomic<bool> stopped = false;
  LinkTask refinement = task(LinkScope::refinement);
  refinement.stop = [&] {
    if (stopped || (stop && stop())) return stopped = true;
    return ++divided > most;
  };
  while (update.rounds < kMostRounds) {
    RunClock watch;
    const LinkWork work = update_links(refinement, links_);
    update.work += work;
    update.seconds_links += watch.lap();
    if (divided > most) {
      throw LimitError(
          fmt::format("links would take more than the {:.4g} MiB that they may; choose a larger threshold "
                      "or smallest area",
                      static_cast<double>(options_.mesh.memory_limit) / 0x1p20));
    }
    update.stopped = stopped;
    if (stopped || (update.rounds > 0 && work.refined == 0)) break;
    ++update.rounds;
    radiosity_.gather(links_, kWhileBuilding);
    update.seconds_exchange += watch.lap();
  }
  exchange(update);
  update.seconds = whole.seconds();
  update.cpu_seconds = whole.cpu_seconds();
  return update;
}

LinkUpdate LinkedRadiosity::update(std::span<const Edit> edits, LinkMethod method) {
  RunClock whole, watch;
  std::ranges::fill(moved_, 0);
  std::ranges::fill(relit_, 0);
  for (const Edit& edit : edits) {
    const EditedScene::Effect effect = scene_.apply(edit);
    moved_[edit.object] |= static_cast<std::uint8_t>(effect.geometry);
    relit_[edit.object] |= static_cast<std::uint8_t>(effect.materials);
  }
  const auto any = [](const std::vector<std::uint8_t>& of) { return std::ranges::find(of, 1) != of.end(); };
  LinkUpdate update;
  if (any(moved_)) {
    before_ = std::move(obstacles_);
    for (std::uint32_t object = 0; object < moved_.size(); ++object) {
      if (moved_[object] == 0) continue;
      obstacles_ = std::make_unique<Obstacles>(obstacles_ ? *obstacles_ : *before_, scene_, object);
      tree_.change_geometry(scene_, obstacles_->soup(), obstacles_->polygons(), object);
      radiosity_.change_geometry(scene_, object);
    }
  }
  for (std::uint32_t object = 0; object < relit_.size(); ++object) {
    if (relit_[object] != 0) radiosity_.change_materials(scene_, object);
  }
  // What links may bring follows at once: thresholds are asked of it.
  if (any(relit_)) set_energies(links_, tree_, radiosity_.luminance());
  update.seconds_scene = watch.lap();
  if (method == LinkMethod::rebuild) {
    before_.reset();
    std::ranges::fill(moved_, 0);
    const double seconds_scene = update.seconds_scene;
    update = build();
    update.seconds_scene = seconds_scene;
    update.seconds = whole.seconds();
    update.cpu_seconds = whole.cpu_seconds();
    return update;
  }

  NodeRadiosity* const differences = method == LinkMethod::hvt_peu ? &radiosity_ : nullptr;
  if (any(moved_) || any_stale_) {
    const LinkScope scope = method == LinkMethod::direct ? LinkScope::all
                            : method == LinkMethod::hvt  ? LinkScope::hierarchical
                                                         : LinkScope::significant;
    update.work += update_links(task(scope), links_, differences);
    any_stale_ = update.work.skipped > 0;
  }
  before_.reset();
  radiosity_.clear_what_is_gone();
  if (any(relit_)) {
    std::ranges::fill(moved_, 0);
    update.work += update_links(task(LinkScope::materials), links_, differences);
  }
  update.seconds_links = watch.lap();
  if (differences == nullptr) {
    exchange(update);
  } else {
    update.exchange.iterations = radiosity_.shoot(links_, options_.tolerance);
    // What has come had no light before the exchange.
    const bool new_light = any(relit_) || std::ranges::any_of(edits, [](const Edit& edit) {
                             return edit.operation == Operation::add || edit.operation == Operation::reshape;
                           });
    if (new_light) set_energies(links_, tree_, radiosity_.luminance());
    // By that light links may be worth looking at that were not before.
    if (new_light && any_stale_) {
      std::ranges::fill(moved_, 0);
      const LinkWork again = update_links(task(LinkScope::significant), links_, differences);
      any_stale_ = again.skipped > 0;
      update.work += again;
      update.exchange.iterations += radiosity_.shoot(links_, options_.tolerance);
    }
    update.exchange.converged = update.exchange.iterations < kMostExchanges;
    update.seconds_exchange = watch.lap();
  }
  update.seconds = whole.seconds();
  update.cpu_seconds = whole.cpu_seconds();
  return update;
}

std::vector<double> LinkedRadiosity::converged() const {
  LinkIndex links = links_;
  LinkTask all = task(LinkScope::values);
  all.before = nullptr;
  all.moved = {};
  update_links(all, links);
  NodeRadiosity radiosity = radiosity_;
  radiosity.gather(links, kConverged);
  return {radiosity.B().begin(), radiosity.B().end()};
}

std::vector<std::uint8_t> LinkedRadiosity::nodes_in_use() const {
  std::vector<std::uint8_t> used(tree_.nodes().size());
  for (std::uint32_t r = 0; r < tree_.roots().size(); ++r) {
    if (tree_.root(r).present) used[tree_.root(r).node_first] = 1;
    for (const Link& link : links_.of_receiver(r)) used[link.source] = used[link.destination] = 1;
  }
  for (std::size_t n = used.size(); n-- > 0;) {  // children stand behind their parents
    const Node& node = tree_.nodes()[n];
    if (used[n] != 0 && node.parent != kNone) used[node.parent] = 1;
  }
  for (const Node& node : tree_.nodes()) {  // a divided node has four children
    if (!node.has_children()) continue;
    const auto children = std::span(used).subspan(node.first_child, 4);
    if (std::ranges::find(children, 1) != children.end()) std::ranges::fill(children, 1);
  }
  return used;
}

std::vector<std::uint32_t> LinkedRadiosity::elements() const {
  const std::vector<std::uint8_t> used = nodes_in_use();
  std::vector<std::uint32_t> roots(tree_.roots().size()), elements;
  std::iota(roots.begin(), roots.end(), 0);
  // Objects that have come later stand behind all others in the tree.
  std::ranges::stable_sort(roots, {}, [&](std::uint32_t r) {
    return scene_.surfaces_of(tree_.root(r).object).first + tree_.root(r).surface;
  });
  for (const std::uint32_t r : roots) {
    for (std::uint32_t n = tree_.root(r).node_first; n < tree_.root(r).node_first + tree_.root(r).node_count; ++n) {
      const Node& node = tree_.node(n);
      if (used[n] != 0 && !(node.has_children() && used[node.first_child] != 0)) elements.push_back(n);
    }
  }
  return elements;
}

ConvergenceError link_error(const PatchTree& tree, std::span<const std::uint32_t> elements, std::uint32_t bands,
                            std::span<const double> reference, std::span<const double> was,
                            std::span<const double> current) {
  const auto area = [&](std::uint32_t n) { return tree.node(n).area; };
  return convergence_error(elements, area, bands, reference, was, current);
}

}  // namespace exitance
