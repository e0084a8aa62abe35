#include "src/links/push_pull.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include "src/solve/compensated.h"
#include "src/solve/radiosity_system.h"

namespace exitance {
namespace {

/// Patches with this share of the most unshot energy shoot together.
constexpr double kShootTogether = 0.1;
/// Of the bound: when a sweep adds little enough to w, and more than what rounding does to it, relative.
constexpr double kReflected = 0.1, kSlack = 1e-12;

/// do_for(bands), of which the compiler knows what is most frequent.
template <class Do>
void with_bands(std::size_t bands, const Do& do_for) {
  if (bands == 3) {
    do_for(std::integral_constant<std::size_t, 3>());
  } else {
    do_for(bands);
  }
}

template <class Work>
void for_each_root(const PatchTree& tree, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(tree.roots().size())),
                    [&](const auto& range) {
                      for (std::uint32_t r = range.begin(); r < range.end(); ++r) {
                        if (tree.root(r).present) work(r);
                      }
                    });
}

}  // namespace

double judged_form_factor(const Node& receiver, const Node& source, double form_factor) {
  if (form_factor > 0 || receiver.open_area == 0) return form_factor;
  const auto middle = [](const Node& node) {
    Vec3 sum;
    for (const Vec3& v : node.loop()) sum = sum + v;
    return (1.0 / node.corners) * sum;
  };
  const Vec3 d = middle(source) - middle(receiver);
  return std::min(1.0, source.area / (std::numbers::pi * dot(d, d)));
}

NodeRadiosity::NodeRadiosity(const PatchTree& tree, const EditedScene& scene)
    : tree_(&tree), bands_(scene.scene().bands), weights_(luminance_weights(bands_)) {
  fit_arrays();
  for (std::uint32_t object = 0; object < scene.scene().objects.size(); ++object) set_materials(scene, object);
  start_over();
}

void NodeRadiosity::fit_arrays() {
  const std::size_t nodes = tree_->nodes().size(), roots = tree_->roots().size();
  for (auto* values : {&B_, &next_, &H_, &received_, &unshot_}) values->resize(nodes * bands_);
  for (auto* values : {&Y_, &w_, &next_w_}) values->resize(nodes);
  for (auto* values : {&rho_, &E_}) values->resize(roots * bands_);
  has_received_.resize(roots);
  there_.resize(roots);
  weighs_anew_.resize(roots);
}

void NodeRadiosity::set_materials(const EditedScene& scene, std::uint32_t object) {
  const std::uint32_t first = scene.surfaces_of(object).first;
  for (std::uint32_t r = 0; r < tree_->roots().size(); ++r) {
    const Root& root = tree_->root(r);
    if (root.object != object || !root.present) continue;
    const Material& material = scene.scene().materials[scene.scene().surfaces[first + root.surface].material];
    std::ranges::copy(material.rho, rho_.begin() + std::ptrdiff_t{r} * bands_);
    std::ranges::copy(material.E, E_.begin() + std::ptrdiff_t{r} * bands_);
  }
}

void NodeRadiosity::start(std::uint32_t r) {
  const Root& root = tree_->root(r);
  for (std::size_t n = root.node_first; n < std::size_t{root.node_first} + root.node_count; ++n) {
    for (std::uint32_t b = 0; b < bands_; ++b) {
      B_[n * bands_ + b] = root.present ? E_[std::size_t{r} * bands_ + b] : 0;
      H_[n * bands_ + b] = received_[n * bands_ + b] = unshot_[n * bands_ + b] = 0;
    }
  }
  find_luminance(r);
}

void NodeRadiosity::start_over() {
  for (std::uint32_t r = 0; r < tree_->roots().size(); ++r) {
    there_[r] = tree_->root(r).present;
    start(r);
  }
}

void NodeRadiosity::change_geometry(const EditedScene& scene, std::uint32_t object) {
  fit_arrays();
  set_materials(scene, object);
  for (std::uint32_t r = 0; r < tree_->roots().size(); ++r) {
    if (tree_->root(r).present == (there_[r] != 0)) continue;
    there_[r] = tree_->root(r).present;
    if (tree_->root(r).present) start(r);
  }
}

void NodeRadiosity::clear_what_is_gone() {
  for (std::uint32_t r = 0; r < tree_->roots().size(); ++r) {
    if (!tree_->root(r).present) start(r);
  }
}

void NodeRadiosity::change_materials(const EditedScene& scene, std::uint32_t object) {
  set_materials(scene, object);
  for (std::uint32_t r = 0; r < tree_->roots().size(); ++r) {
    const Root& root = tree_->root(r);
    if (root.object != object || !root.present) continue;
    renew(r);
  }
}

void NodeRadiosity::change_covering() {
  for (std::uint32_t r = 0; r < tree_->roots().size(); ++r) {
    if (!tree_->root(r).present || !tree_->root(r).covered_anew) continue;
    renew(r);
    weighs_anew_[r] = 1;
  }
}

/// B by E, ρ, H and what is covered; what that changes is unshot.
void NodeRadiosity::renew(std::uint32_t r) {
  const Root& root = tree_->root(r);
  for (std::uint32_t n = root.node_first; n < root.node_first + root.node_count; ++n) {
    if (tree_->node(n).has_children()) continue;
    for (std::uint32_t b = 0; b < bands_; ++b) {
      const std::size_t i = std::size_t{n} * bands_ + b;
      const double B = B_of_leaf(n, b);
      unshot_[i] += B - B_[i];
      B_[i] = B;
    }
  }
  pull_changes(r);
  find_luminance(r);
}

double NodeRadiosity::B_of_leaf(std::uint32_t n, std::uint32_t band) const {
  const Node& node = tree_->node(n);
  const std::size_t of_root = std::size_t{node.root} * bands_ + band;
  return node.open_area > 0 ? E_[of_root] + rho_[of_root] * H_[std::size_t{n} * bands_ + band] : E_[of_root];
}

double NodeRadiosity::whole_B(std::uint32_t n, std::uint32_t band) const {
  const Node& node = tree_->node(n);
  const double B = B_[std::size_t{n} * bands_ + band];
  if (!node.covered) return B;
  const double E = E_[std::size_t{node.root} * bands_ + band];
  return E + node.open_area / node.area * (B - E);
}

/// Means over children, from the leaves up.
void NodeRadiosity::pull(std::uint32_t r, std::vector<double>& values, std::size_t bands) {
  pull(r, values, bands, [](std::size_t, double) {});
}

/// The same of B; by how much that changes it is unshot.
void NodeRadiosity::pull_changes(std::uint32_t r) {
  pull(r, B_, bands_, [&](std::size_t i, double change) { unshot_[i] += change; });
}

template <class Changed>
void NodeRadiosity::pull(std::uint32_t r, std::vector<double>& values, std::size_t bands, const Changed& changed) {
  const Root& root = tree_->root(r);
  for (std::size_t n = std::size_t{root.node_first} + root.node_count; n-- > root.node_first;) {
    const Node& node = tree_->nodes()[n];
    if (!node.has_children()) continue;
    const double Node::*const weight = node.open_area > 0 ? &Node::open_area : &Node::area;
    double area = 0;
    for (std::uint32_t k = 0; k < 4; ++k) area += tree_->node(node.first_child + k).*weight;
    for (std::size_t b = 0; b < bands; ++b) {
      double sum = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t child = node.first_child + k;
        sum += tree_->nodes()[child].*weight * values[child * bands + b];
      }
      const std::size_t i = n * bands + b;
      const double mean = sum / area;
      changed(i, mean - values[i]);
      values[i] = mean;
    }
  }
}

void NodeRadiosity::find_luminance(std::uint32_t r) {
  const Root& root = tree_->root(r);
  for (std::size_t n = root.node_first; n < std::size_t{root.node_first} + root.node_count; ++n) {
    Y_[n] = 0;
    for (std::uint32_t b = 0; b < bands_; ++b) Y_[n] += weights_[b] * B_[n * bands_ + b];
  }
}

LinkExchange NodeRadiosity::gather(const LinkIndex& links, const ClusterLinks& clusters, double tolerance,
                                   const Abandon& abandon, std::uint64_t most) {
  struct OfRoot {
    std::vector<double> change, size;  ///< largest of each band
    double reflected = 0, w = 0;       ///< largest of what a sweep adds to w, and of w
  };
  std::vector<OfRoot> of_root(tree_->roots().size(), {std::vector<double>(bands_), std::vector<double>(bands_), 0, 0});
  std::ranges::fill(next_, 0);
  std::ranges::fill(next_w_, 0);
  for (const Root& root : tree_->roots())
    std::fill_n(w_.begin() + root.node_first, root.node_count, root.present ? 1.0 : 0.0);
  bool bounding = true;  // whether w is still sought
  // By root: what clusters bring of B and of w.
  std::vector<double> of_clusters, w_of_clusters;

  const auto sweep = [&](std::uint32_t r) {
    const Root& root = tree_->root(r);
    const std::size_t first = root.node_first, count = root.node_count, width = bands_ + 1;
    const auto rho = std::span(rho_).subspan(std::size_t{r} * bands_, bands_);
    const double largest_rho = *std::ranges::max_element(rho);
    thread_local std::vector<CompensatedSum> sums;  // of each band, and of w
    sums.assign(count * width, {});
    with_bands(bands_, [&](auto bands) {
      for (const Link& link : links.of_receiver(r)) {
        if (link.ghost) continue;
        const double F = link.transfer();
        if (F == 0) continue;
        CompensatedSum* sum = sums.data() + (link.destination - first) * (bands + 1);
        const double* B = B_.data() + std::size_t{link.source} * bands;
        for (std::size_t b = 0; b < bands; ++b) sum[b].add(F * B[b]);
        if (bounding) sum[bands].add(F * w_[link.source]);
      }
    });
    if (!clusters.empty()) {
      for (std::uint32_t b = 0; b < bands_; ++b) sums[b].add(of_clusters[std::size_t{r} * bands_ + b]);
      if (bounding) sums[bands_].add(w_of_clusters[r]);
    }
    OfRoot& found = of_root[r];
    std::ranges::fill(found.change, 0);
    std::ranges::fill(found.size, 0);
    if (bounding) found.reflected = found.w = 0;
    for (std::size_t n = first; n < first + count; ++n) {
      const Node& node = tree_->nodes()[n];
      const CompensatedSum* sum = sums.data() + (n - first) * width;
      for (std::size_t k = 0; node.has_children() && k < 4; ++k) {
        for (std::size_t b = 0; b < width; ++b) sums[(node.first_child + k - first) * width + b].add(sum[b]);
      }
      if (bounding && !node.has_children()) {
        next_w_[n] = node.open_area > 0 ? 1 + largest_rho * sum[bands_].value() : 1;
        found.reflected = std::max(found.reflected, next_w_[n] - w_[n]);
        found.w = std::max(found.w, w_[n]);
      }
      for (std::size_t b = 0; b < bands_; ++b) {
        const std::size_t i = n * bands_ + b;
        H_[i] = sum[b].value();
        if (node.has_children()) continue;
        next_[i] = B_of_leaf(static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(b));
        found.change[b] = std::max(found.change[b], std::fabs(next_[i] - B_[i]));
        found.size[b] = std::max(found.size[b], std::fabs(next_[i]));
      }
    }
    pull(r, next_, bands_);
    if (bounding) pull(r, next_w_, 1);
  };

  LinkExchange result;
  result.factor = std::numeric_limits<double>::infinity();
  double best = result.factor;
  while (result.iterations < most) {
    go_on(abandon);
    if (!clusters.empty()) {
      clusters.gather(B_, bands_, of_clusters);
      if (bounding) clusters.gather(w_, 1, w_of_clusters);
    }
    for_each_root(*tree_, sweep);
    ++result.iterations;
    std::swap(B_, next_);
    double reflected = 0, w = 0;
    for (std::uint32_t r = 0; r < of_root.size(); ++r) {
      if (!tree_->root(r).present) continue;
      reflected = std::max(reflected, of_root[r].reflected);
      w = std::max(w, of_root[r].w);
    }
    reflected += kSlack * w;
    if (bounding && reflected < 1) result.factor = w * (1 + kSlack) / (1 - reflected);
    bounding = bounding && reflected > kReflected;
    if (bounding) std::swap(w_, next_w_);
    result.residual = result.error_bound = 0;
    for (std::uint32_t b = 0; b < bands_; ++b) {
      double change = 0, size = 0;
      for (std::uint32_t r = 0; r < of_root.size(); ++r) {
        if (!tree_->root(r).present) continue;
        change = std::max(change, of_root[r].change[b]);
        size = std::max(size, of_root[r].size[b]);
      }
      if (size == 0) continue;
      result.residual = std::max(result.residual, change / size);
      result.error_bound = std::max(result.error_bound, (change / size + 8 * kRoundoff) * result.factor);
    }
    result.converged = result.error_bound <= tolerance;
    if (result.converged || (result.residual <= 16 * kRoundoff && result.residual >= best)) break;
    best = std::min(best, result.residual);
  }
  for_each_root(*tree_, [&](std::uint32_t r) { find_luminance(r); });
  std::ranges::fill(unshot_, 0);
  std::ranges::fill(received_, 0);
  std::ranges::fill(has_received_, 0);
  std::ranges::fill(weighs_anew_, 0);
  return result;
}

void NodeRadiosity::receive(std::uint32_t node, double transfer, std::uint32_t source) {
  has_received_[tree_->node(node).root] = 1;
  for (std::uint32_t b = 0; b < bands_; ++b) {
    // What is unshot will come by the link as it is now.
    const std::size_t of_source = std::size_t{source} * bands_ + b;
    received_[std::size_t{node} * bands_ + b] += transfer * (B_[of_source] - unshot_[of_source]);
  }
}

std::uint64_t NodeRadiosity::shoot(const LinkIndex& links, double share, const Abandon& abandon, std::uint64_t most) {
  const std::size_t roots = tree_->roots().size();
  std::vector<double> energy(roots), unshot(roots);
  std::vector<std::uint8_t> shoots(roots);
  const auto measure = [&](std::uint32_t r) {
    const std::uint32_t first = tree_->root(r).node_first;
    energy[r] = tree_->node(first).open_area * Y_[first];
    double sum = 0;  // of magnitudes: what leaves receive may cancel in the mean
    for (std::size_t n = first, last = n + tree_->root(r).node_count; n < last; ++n) {
      const Node& node = tree_->nodes()[n];
      if (weighs_anew_[r] == 0 && node.has_children()) continue;
      // What is covered just now is to be taken back where rounding still lets it be seen.
      const double area = node.open_area > 0 ? node.open_area : node.area;
      for (std::uint32_t b = 0; b < bands_; ++b) sum += area * weights_[b] * std::fabs(unshot_[n * bands_ + b]);
    }
    unshot[r] = sum;
  };
  const auto absorb = [&](std::uint32_t r) {
    if (has_received_[r] == 0) return;
    has_received_[r] = 0;
    const Root& root = tree_->root(r);
    for (std::size_t n = root.node_first, last = n + root.node_count; n < last; ++n) {
      const Node& node = tree_->nodes()[n];
      for (std::uint32_t b = 0; b < bands_; ++b) {
        const std::size_t i = n * bands_ + b;
        const double dH = std::exchange(received_[i], 0);
        H_[i] += dH;
        if (node.has_children()) {
          for (std::size_t k = 0; k < 4; ++k) received_[(node.first_child + k) * bands_ + b] += dH;
        } else if (node.open_area > 0) {
          const double dB = rho_[std::size_t{r} * bands_ + b] * dH;
          B_[i] += dB;
          unshot_[i] += dB;
        }
      }
    }
    pull_changes(r);
    find_luminance(r);
    measure(r);
  };

  std::ranges::fill(energy, 0);
  for_each_root(*tree_, [&](std::uint32_t r) {
    measure(r);
    absorb(r);
  });
  double brightest = 0;  // the most energy that there was: of a light that went out little stays
  for (std::uint64_t round = 0; round < most; ++round) {
    go_on(abandon);
    double all = 0, left = 0, largest = 0;
    for (std::uint32_t r = 0; r < roots; ++r) {
      if (!tree_->root(r).present) continue;
      all += energy[r];
      left += unshot[r];
      largest = std::max(largest, unshot[r]);
    }
    brightest = std::max(brightest, all);
    if (left <= share * brightest) return round;
    for (std::uint32_t r = 0; r < roots; ++r)
      shoots[r] = tree_->root(r).present && unshot[r] > 0 && unshot[r] >= kShootTogether * largest;
    for_each_root(*tree_, [&](std::uint32_t r) {
      links.for_each_source(r, [&](std::uint32_t source, std::span<const Link> of_source) {
        if (shoots[source] == 0) return;
        has_received_[r] = 1;
        with_bands(bands_, [&](auto bands) {
          for (const Link& link : of_source) {
            const double F = link.ghost ? 0 : link.transfer();
            const double* from = unshot_.data() + std::size_t{link.source} * bands;
            double* to = received_.data() + std::size_t{link.destination} * bands;
            for (std::size_t b = 0; b < bands; ++b) to[b] += F * from[b];
          }
        });
      });
    });
    for_each_root(*tree_, [&](std::uint32_t r) {
      if (shoots[r] != 0) {
        const Root& root = tree_->root(r);
        std::fill_n(unshot_.begin() + std::ptrdiff_t{root.node_first} * bands_, std::size_t{root.node_count} * bands_,
                    0.0);
        unshot[r] = 0;
        weighs_anew_[r] = 0;
      }
      absorb(r);
    });
  }
  return most;
}

std::vector<double> row_sums(const LinkIndex& links, const ClusterLinks& clusters, const PatchTree& tree) {
  std::vector<double> of_clusters, sums(tree.nodes().size());
  if (!clusters.empty()) clusters.gather(std::vector<double>(sums.size(), 1), 1, of_clusters);
  for_each_root(tree, [&](std::uint32_t r) {
    const Root& root = tree.root(r);
    std::vector<CompensatedSum> of_node(root.node_count);
    if (!clusters.empty()) of_node.front().add(of_clusters[r]);
    for (const Link& link : links.of_receiver(r)) {
      if (!link.ghost) of_node[link.destination - root.node_first].add(link.transfer());
    }
    for (std::uint32_t k = 0; k < root.node_count; ++k) {
      const Node& node = tree.node(root.node_first + k);
      for (std::uint32_t c = 0; node.has_children() && c < 4; ++c)
        of_node[node.first_child + c - root.node_first].add(of_node[k]);
      sums[root.node_first + k] = of_node[k].value();
    }
  });
  return sums;
}

void set_energies(std::span<Link> links, const PatchTree& tree, std::span<const double> luminance) {
  for (std::size_t i = links.size(); i-- > 0;) {
    Link& link = links[i];
    if (!link.ghost) {
      link.energy = std::max(0.0, luminance[link.source]) *
                    judged_form_factor(tree.node(link.destination), tree.node(link.source), link.form_factor);
      continue;
    }
    link.energy = 0;
    for (std::size_t k = i + 1; k < i + link.next; k += links[k].next)
      link.energy = std::max(link.energy, links[k].energy);
  }
}

void set_energies(LinkIndex& links, const PatchTree& tree, std::span<const double> luminance) {
  for_each_root(tree, [&](std::uint32_t r) { set_energies(links.energies_of(r), tree, luminance); });
}

void set_energies(LinkIndex& links, const PatchTree& tree, std::span<const double> luminance,
                  std::span<const std::uint32_t> sources) {
  for_each_root(tree, [&](std::uint32_t r) {
    for (const std::uint32_t s : sources) set_energies(links.energies_of(r, s), tree, luminance);
  });
}

}  // namespace exitance
