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

/// About what a link takes in the index.
constexpr std::uint64_t kBytesALink = sizeof(Link) + 16;
/// To what rounds before the last converge when links are built.
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

bool any(std::span<const std::uint8_t> of) {
  return std::ranges::find(of, 1) != of.end();
}

LinkOptions checked(LinkOptions options, const Scene& scene) {
  const bool in_range = options.eps1 >= 0 && options.eps1 <= options.eps2 && std::isfinite(options.eps2) &&
                        options.B_eps >= 0 && options.smallest_area >= 0 && options.tolerance > 0 &&
                        options.points_per_edge >= 1 && options.points_per_edge <= 20;
  if (!in_range) throw std::invalid_argument("links: 0 ≤ eps1 ≤ eps2, B_eps ≥ 0, smallest_area ≥ 0, tolerance > 0");
  if (options.smallest_area == 0) options.smallest_area = default_smallest_area(scene);
  if (!(options.smallest_area > 0)) throw std::invalid_argument("no surface has an area; there is nothing to link");
  return options;
}

/// By so much more light links of a node may be worth looking at that were not.
constexpr double kBrighter = 4;

}  // namespace

double default_smallest_area(const Scene& scene) {
  return kShareOfArea * total_area(scene);
}

LinkedRadiosity::LinkedRadiosity(Scene scene, const LinkOptions& options)
    : options_(checked(options, scene)),
      scene_(std::move(scene)),
      obstacles_(std::make_shared<const Obstacles>(scene_)),
      tree_(scene_, obstacles_->soup(), {options_.mesh, options_.smallest_area, options_.points_per_edge}),
      radiosity_(tree_, scene_),
      links_(tree_.roots().size()),
      brightest_(largest_emission(scene_.scene())) {
  tree_.cover(obstacles_->soup(), obstacles_->contacts());
}

LinkTask LinkedRadiosity::task(LinkScope scope) const {
  LinkTask task;
  task.tree = &tree_;
  task.now = obstacles_.get();
  task.luminance = radiosity_.luminance();
  task.eps1 = options_.eps1 * brightest_;
  task.eps2 = options_.eps2 * brightest_;
  task.B_eps = options_.B_eps * brightest_;
  task.scope = scope;
  task.any_stale = any_stale_;
  task.most_links = bytes_left() / kBytesALink;
  return task;
}

/// Of the memory, beside the links that there are.
std::uint64_t LinkedRadiosity::bytes_left() const {
  std::uint64_t taken = clusters_.links().size_bytes();
  for (std::uint32_t r = 0; r < links_.roots(); ++r) taken += links_.of_receiver(r).size() * kBytesALink;
  return options_.mesh.memory_limit - std::min(options_.mesh.memory_limit, taken);
}

void LinkedRadiosity::gather(LinkUpdate& update, const Abandon& abandon) {
  RunClock watch;
  update.exchange = radiosity_.gather(links_, clusters_, options_.tolerance, abandon);
  update.seconds_exchange += watch.lap();
}

/// Only what differs from before.
void LinkedRadiosity::shoot(LinkUpdate& update, const Abandon& abandon) {
  RunClock watch;
  const std::uint64_t rounds = radiosity_.shoot(links_, options_.tolerance, abandon);
  update.exchange.iterations += rounds;
  update.exchange.converged = rounds < kMostExchanges;
  update.seconds_exchange += watch.lap();
}

LinkUpdate LinkedRadiosity::build(const LinkInterruption& interruption) {
  const std::function<bool()>& stop = interruption.stop;
  RunClock whole;
  LinkUpdate update;
  links_ = LinkIndex(tree_.roots().size());
  clusters_ = options_.clusters ? ClusterLinks(tree_, *obstacles_) : ClusterLinks();
  any_stale_ = false;
  pending_.reset();
  radiosity_.start_over();
  std::atomic<bool> stopped = false;
  while (true) {
    RunClock watch;
    const auto ends = [&] {
      if (!stopped && stop && stop()) stopped = true;
      return stopped.load();
    };
    ClusterLinks::Refinement of_clusters;
    if (options_.clusters) {
      of_clusters = clusters_.refine(radiosity_.luminance(), options_.eps2 * brightest_, ends,
                                     bytes_left() + clusters_.links().size_bytes());
    }
    LinkTask refinement = task(LinkScope::refinement);
    refinement.stop = ends;
    refinement.abandon = interruption.abandon;
    if (options_.clusters) {
      refinement.new_pairs = &of_clusters.pairs;
      refinement.most_links -=
          std::min<std::uint64_t>(refinement.most_links, of_clusters.pairs.size() * sizeof(PatchPair) / kBytesALink);
    }
    const LinkWork work = update_links(refinement, links_);
    update.work += work;
    update.seconds_links += watch.lap();
    update.stopped = stopped;
    if (stopped || (update.rounds > 0 && work.refined + of_clusters.divided == 0)) break;
    if (update.rounds == options_.most_rounds) {
      update.stopped = true;
      break;
    }
    ++update.rounds;
    radiosity_.gather(links_, clusters_, kWhileBuilding, interruption.abandon);
    update.seconds_exchange += watch.lap();
  }
  gather(update, interruption.abandon);
  judge_all();
  update.seconds = whole.seconds();
  update.cpu_seconds = whole.cpu_seconds();
  return update;
}

void LinkedRadiosity::judge_all() {
  const std::span<const double> Y = radiosity_.luminance();
  set_energies(links_, tree_, Y);
  judged_.assign(Y.begin(), Y.end());  // none is negative
}

/// Sets the energies of links from patches of which some node is much brighter than when they were found, one that was
/// dark, too, and bright enough for B_eps. Returns these patches, ascending.
std::vector<std::uint32_t> LinkedRadiosity::judge_what_is_brighter() {
  const std::span<const double> Y = radiosity_.luminance();
  const double least = options_.B_eps * brightest_;
  judged_.resize(Y.size());
  std::vector<std::uint32_t> brighter;
  for (std::uint32_t r = 0; r < tree_.roots().size(); ++r) {
    const Root& root = tree_.root(r);
    bool found = false;
    for (std::size_t n = root.node_first, last = n + root.node_count; n < last; ++n) {
      found = found || (Y[n] > kBrighter * judged_[n] && Y[n] > least);
      judged_[n] = std::clamp(Y[n], 0.0, judged_[n]);
    }
    if (!found) continue;
    brighter.push_back(r);
    for (std::size_t n = root.node_first, last = n + root.node_count; n < last; ++n) judged_[n] = std::max(0.0, Y[n]);
  }
  set_energies(links_, tree_, Y, brighter);
  return brighter;
}

/// work(update): what throws leaves everything as it was.
template <class Work>
LinkUpdate LinkedRadiosity::all_or_nothing(const Work& work) {
  EditedScene scene = scene_;
  PatchTree tree = tree_;
  NodeRadiosity radiosity = radiosity_;
  std::optional<Pending> pending = pending_;
  const std::shared_ptr<const Obstacles> obstacles = obstacles_;
  const bool any_stale = any_stale_;
  std::vector<double> judged = judged_;
  LinkUpdate update;
  links_.keep_changes();
  try {
    work(update);
  } catch (...) {
    links_.roll_back();
    scene_ = std::move(scene);
    tree_ = std::move(tree);
    radiosity_ = std::move(radiosity);
    pending_ = std::move(pending);
    obstacles_ = obstacles;
    any_stale_ = any_stale;
    judged_ = std::move(judged);
    throw;
  }
  links_.commit();
  return update;
}

LinkUpdate LinkedRadiosity::update(std::span<const Edit> edits, LinkMethod method,
                                   const LinkInterruption& interruption) {
  if (options_.clusters && method != LinkMethod::rebuild)
    throw std::invalid_argument("links between clusters are rebuilt after an edit, not updated");
  RunClock whole;
  LinkUpdate update = all_or_nothing([&](LinkUpdate& made) { change(edits, method, interruption, made); });
  RunClock watch;
  if (method == LinkMethod::direct || method == LinkMethod::hvt) judge_all();
  update.seconds_exchange += watch.lap();
  update.seconds = whole.seconds();
  update.cpu_seconds = whole.cpu_seconds();
  return update;
}

LinkUpdate LinkedRadiosity::work_off(const LinkInterruption& interruption) {
  if (!pending_) return {};
  RunClock whole;
  const LinkMethod method = pending_->method;
  LinkUpdate update = all_or_nothing([&](LinkUpdate& made) { follow(*pending_, interruption, made); });
  RunClock watch;
  if (method != LinkMethod::hvt_peu) judge_all();
  update.seconds_exchange += watch.lap();
  update.seconds = whole.seconds();
  update.cpu_seconds = whole.cpu_seconds();
  return update;
}

/// Goes on from the stage where it stands, exchanges energy, and keeps what is left.
void LinkedRadiosity::follow(Pending pending, const LinkInterruption& interruption, LinkUpdate& update) {
  const bool shoots = pending.method == LinkMethod::hvt_peu;
  const LinkScope scope = shoots                                 ? LinkScope::significant
                          : pending.method == LinkMethod::direct ? LinkScope::all
                                                                 : LinkScope::hierarchical;
  RunClock watch;
  if (pending.stage == Stage::sight && look_at_pairs(pending, scope, interruption, update)) {
    pending.stage = Stage::materials;
    pending.before.reset();
    pending.moved.clear();
  }
  radiosity_.clear_what_is_gone();
  if (pending.stage == Stage::materials && look_at_pairs(pending, LinkScope::materials, interruption, update))
    pending.stage = Stage::new_light;
  update.seconds_links += watch.lap();
  bool done = pending.stage == Stage::new_light;
  if (shoots) {
    shoot(update, interruption.abandon);
  } else {
    if (done && pending.radiosity) {  // as if it had been one update
      radiosity_ = *pending.radiosity;
      radiosity_.clear_what_is_gone();
    }
    gather(update, interruption.abandon);
  }
  // What has come, or was covered, had no light before the exchange. By that which it has now links may be worth
  // looking at that were not before.
  while (done && shoots) {
    std::vector<std::uint32_t> brighter;
    if (pending.pairs.empty()) {
      brighter = judge_what_is_brighter();
      if (brighter.empty() || !any_stale_) break;
      pending.radiosity.reset();
    }
    watch.lap();
    done = look_at_pairs(pending, LinkScope::significant, interruption, update, &brighter);
    update.seconds_links += watch.lap();
    shoot(update, interruption.abandon);
  }
  update.pairs_left = pending.pairs.size();
  if (done) {
    pending_.reset();
  } else {
    pending_ = std::move(pending);
  }
}

/// Works on the pairs of a stage, all that it concerns where there are none yet, or those of them that come from
/// `sources`. Whether none is left.
bool LinkedRadiosity::look_at_pairs(Pending& pending, LinkScope scope, const LinkInterruption& interruption,
                                    LinkUpdate& update, const std::vector<std::uint32_t>* sources) {
  const bool refines = scope == LinkScope::materials;
  if (!(refines ? any(pending.relit) : any(pending.moved) || any_stale_)) return true;
  LinkTask how = task(scope);
  how.before = pending.before.get();
  how.moved = pending.moved;
  how.relit = pending.relit;
  how.stop = interruption.stop;
  how.abandon = interruption.abandon;
  how.order = interruption.order;
  how.sources = sources;
  const bool begins = pending.pairs.empty();
  if (pending.radiosity) how.luminance = pending.radiosity->luminance();
  if (!begins) how.any_stale = pending.any_stale;
  const LinkWork work = update_links(how, links_, pending.method == LinkMethod::hvt_peu ? &radiosity_ : nullptr,
                                     begins && !interruption.stop ? nullptr : &pending.pairs);
  update.work += work;
  const bool done = pending.pairs.empty();
  pending.skipped = pending.skipped || work.skipped > 0;
  // What is left may be stale itself, and so may what is not refined.
  any_stale_ = pending.skipped || (any_stale_ && (refines || sources != nullptr || !done));
  if (done) {
    pending.skipped = false;
  } else {
    if (!pending.radiosity) pending.radiosity = std::make_shared<const NodeRadiosity>(radiosity_);
    pending.any_stale = how.any_stale;
  }
  return done;
}

/// Marks as stale what an interrupted update left, but for what was only to be refined: it tells how much it may bring
/// in the scene as it is. Pairs that were to get links get one that brings nothing.
void LinkedRadiosity::mark_pending(LinkIndex& links) const {
  if (pending_->stage == Stage::materials) return;
  std::vector<PendingPair> pairs = pending_->pairs;
  std::ranges::sort(pairs, {}, &PendingPair::pair);
  for (std::size_t k = 0; k < pairs.size();) {
    const std::uint32_t receiver = pairs[k].pair.receiver;
    std::vector<LinkIndex::Replacement> marked;
    for (; k < pairs.size() && pairs[k].pair.receiver == receiver; ++k) {
      const std::span<const Link> old = std::as_const(links).between(receiver, pairs[k].pair.source);
      marked.push_back({pairs[k].pair.source, {old.begin(), old.end()}});
      if (old.empty()) {
        Link link;
        link.source = tree_.root(pairs[k].pair.source).node_first;
        link.destination = tree_.root(receiver).node_first;
        marked.back().links.push_back(link);
      }
      marked.back().links.front().stale = true;
      for (Link& link : marked.back().links) {
        const Node &to = tree_.node(link.destination), &from = tree_.node(link.source);
        if (!link.ghost && tree_.root(to.root).present && tree_.root(from.root).present)
          link.raise(most_form_factor(to, from, obstacles_->soup()));
      }
      set_energies(std::span(marked.back().links), tree_, radiosity_.luminance());
    }
    links.replace(receiver, marked);
  }
}

void LinkedRadiosity::change(std::span<const Edit> edits, LinkMethod method, const LinkInterruption& interruption,
                             LinkUpdate& update) {
  RunClock watch;
  const std::size_t objects = scene_.scene().objects.size();
  std::vector<std::uint8_t> moved(objects), relit(objects), relit_before(objects);
  if (pending_) {
    mark_pending(links_);
    any_stale_ = any_stale_ || pending_->stage != Stage::materials;
    if (pending_->stage != Stage::new_light) relit_before = pending_->relit;
    pending_.reset();
  }
  for (const Edit& edit : edits) {
    const EditedScene::Effect effect = scene_.apply(edit);
    moved[edit.object] |= static_cast<std::uint8_t>(effect.geometry);
    relit[edit.object] |= static_cast<std::uint8_t>(effect.materials);
  }
  std::shared_ptr<const Obstacles> before;
  if (any(moved)) {
    before = obstacles_;
    for (std::uint32_t object = 0; object < objects; ++object) {
      if (moved[object] == 0) continue;
      obstacles_ = std::make_shared<const Obstacles>(*obstacles_, scene_, object);
      tree_.change_geometry(scene_, obstacles_->soup(), obstacles_->polygons(), object);
      radiosity_.change_geometry(scene_, object);
    }
    tree_.cover(obstacles_->soup(), obstacles_->contacts());
    radiosity_.change_covering();
  }
  for (std::uint32_t object = 0; object < objects; ++object) {
    if (relit[object] != 0) radiosity_.change_materials(scene_, object);
  }
  if (method == LinkMethod::rebuild) {
    const double seconds_scene = watch.lap();
    LinkIndex links = std::move(links_);
    ClusterLinks clusters = std::move(clusters_);
    try {
      update = build(interruption);
    } catch (...) {
      links_ = std::move(links);
      clusters_ = std::move(clusters);
      throw;
    }
    update.seconds_scene = seconds_scene;
    return;
  }
  // What links may bring follows at once: thresholds are asked of it.
  if (method == LinkMethod::hvt_peu) {
    links_.grow(tree_.roots().size());
    judge_what_is_brighter();
  }
  update.seconds_scene = watch.lap();

  for (std::size_t object = 0; object < objects; ++object) relit[object] |= relit_before[object];
  Pending all;
  all.method = method;
  all.before = before;
  all.moved = moved;
  all.relit = relit;
  follow(std::move(all), interruption, update);
}

std::vector<double> LinkedRadiosity::left_as_it_was() const {
  if (!any_stale_ && !pending_) return {};
  std::vector<double> left(tree_.nodes().size());
  LinkIndex marked;
  if (pending_) mark_pending(marked = links_);
  const LinkIndex& all = pending_ ? marked : links_;
  const std::uint32_t bands = radiosity_.bands();
  for (std::uint32_t r = 0; r < tree_.roots().size(); ++r) {
    const Root& root = tree_.root(r);
    if (!root.present) continue;
    const std::span<const Link> links = all.of_receiver(r);
    for (std::size_t k = 0, stale_until = 0; k < links.size(); ++k) {
      if (links[k].stale) stale_until = std::max<std::size_t>(stale_until, k + links[k].next);
      if (k < stale_until && !links[k].ghost) left[links[k].destination] += links[k].energy;
    }
    const auto rho = radiosity_.rho().subspan(std::size_t{r} * bands, bands);
    const double largest = *std::ranges::max_element(rho);
    for (std::uint32_t n = root.node_first; n < root.node_first + root.node_count; ++n) {
      const Node& node = tree_.node(n);
      for (std::uint32_t c = 0; node.has_children() && c < 4; ++c) left[node.first_child + c] += left[n];
    }
    for (std::uint32_t n = root.node_first; n < root.node_first + root.node_count; ++n) left[n] *= largest;
  }
  return left;
}

std::vector<double> LinkedRadiosity::converged(const Abandon& abandon) const {
  LinkIndex links = links_;
  if (pending_) mark_pending(links);
  LinkTask all = task(LinkScope::values);
  all.any_stale = true;
  all.abandon = abandon;
  update_links(all, links);
  NodeRadiosity radiosity = radiosity_;
  radiosity.gather(links, clusters_, kConverged, abandon);
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
  const auto area = [&](std::uint32_t n) { return tree.node(n).open_area; };
  return convergence_error(elements, area, bands, reference, was, current);
}

}  // namespace exitance
