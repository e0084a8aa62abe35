#include "src/links/hierarchical_solution.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "src/scene/input_error.h"
#include "src/scene/scene_check.h"
#include "src/solve/error_bound.h"
#include "src/visibility/exact_visibility.h"

namespace exitance {
namespace {

/// Elements at which closure is measured, and pairs of patches whose reciprocity is.
constexpr std::size_t kMeasured = 256, kPairs = 64, kDraws = 1024;

/// What the plain formula of an open link may lose by rounding.
constexpr double kOpenError = 0x1p-46;

/// Max ρ Σ F_error B times the factor of the error bound, relative to max B, worst band.
double error_of_form_factors(const LinkedRadiosity& links, double factor) {
  const NodeRadiosity& radiosity = links.radiosity();
  const std::uint32_t bands = radiosity.bands();
  double worst = 0;
  for (std::uint32_t b = 0; b < bands; ++b) {
    double largest = 0, size = 0;
    for (std::uint32_t r = 0; r < links.tree().roots().size(); ++r) {
      double error = 0;  // of all that the root receives: no leaf receives more
      for (const Link& link : links.links().of_receiver(r)) {
        if (link.ghost || link.blocked) continue;
        const double B = std::fabs(radiosity.B()[std::size_t{link.source} * bands + b]);
        error += (link.open ? kOpenError : kPointTolerance) * B;
        size = std::max(size, B);
      }
      largest = std::max(largest, radiosity.rho()[std::size_t{r} * bands + b] * error);
    }
    if (largest > 0) worst = std::max(worst, largest / size * factor);
  }
  return worst;
}

}  // namespace

PatchMesh mesh_of(const LinkedRadiosity& links) {
  const PatchTree& tree = links.tree();
  PatchMesh mesh;
  const auto add_piece = [&](const Node& node) {
    PatchPiece piece{node.facet, static_cast<std::uint32_t>(mesh.points.size()), node.corners, node.area};
    mesh.points.append(node.loop().begin(), node.loop().end());
    mesh.pieces.push_back(piece);
    return static_cast<std::uint32_t>(mesh.pieces.size() - 1);
  };
  for (const std::uint32_t n : links.elements()) {
    const Node& node = tree.node(n);
    const Root& root = tree.root(node.root);
    if (mesh.patches.empty() || mesh.patches.back().piece_first != node.root) {
      Patch patch;
      patch.surface = links.scene().surfaces_of(root.object).first + root.surface;
      patch.piece_first = node.root;  // until all pieces are known
      patch.element_first = static_cast<std::uint32_t>(mesh.elements.size());
      mesh.patches.push_back(patch);
    }
    Patch& patch = mesh.patches.back();
    Element element;
    element.patch = static_cast<std::uint32_t>(mesh.patches.size() - 1);
    element.facet = node.facet;
    std::vector<NodePoint> centre;
    node_points(node, 1, centre);
    element.sample = centre.front().at;
    element.normal = normalized(links.obstacles().soup().facets()[node.facet].plane.normal);
    element.area = node.area;
    element.piece_first = add_piece(node);
    element.piece_count = 1;
    element.loop_first = mesh.pieces[element.piece_first].loop_first;
    element.loop_count = node.corners;
    mesh.elements.push_back(element);
    ++patch.element_count;
    patch.area += node.area;
  }
  for (Patch& patch : mesh.patches) {
    const Node& node = tree.node(tree.root(patch.piece_first).node_first);
    patch.piece_first = add_piece(node);
    patch.piece_count = 1;
    if (!node.whole) continue;
    PatchPiece whole = mesh.pieces[patch.piece_first];
    whole.loop_count = 0;
    mesh.pieces.set(patch.piece_first, whole);
  }
  return mesh;
}

HierarchicalSolution solve_by_links(const Scene& scene, const HierarchicalOptions& options,
                                    std::span<const std::uint8_t> moves) {
  if (std::ranges::none_of(scene.surfaces,
                           [](const Surface& s) { return !s.obstruction_only && norm(area_vector(s.polygon)) > 0; })) {
    throw InputError(scene.name, 0, "no surface has an area; there is nothing to solve");
  }
  LinkedRadiosity links(scene, options.links);
  HierarchicalSolution result{
      SceneSolution(make_soup(scene)), links.build({options.stop, LinkOrder::any, {}}), {}, 0, 0, 0, links.options()};
  result.links = links.links().count(links.tree(), moves);
  result.clusters = links.cluster_links().clusters().clusters().size();
  result.cluster_links = links.cluster_links().links().size();
  result.links.bytes += links.cluster_links().bytes();
  const std::vector<std::uint8_t> used = links.nodes_in_use();
  result.sub_patches = static_cast<std::uint64_t>(std::ranges::count(used, 1));

  SceneSolution& s = result.solution;
  s.mesh = mesh_of(links);
  s.discretisation = discretise(scene, s.mesh);
  s.closed = is_closed(scene);
  const std::uint32_t bands = scene.bands;
  const std::vector<std::uint32_t> elements = links.elements();
  s.patches.B.resize(s.mesh.patches.size() * bands);
  s.patches.H.resize(s.patches.B.size());
  const std::vector<double> row_sum = row_sums(links.links(), links.cluster_links(), links.tree());
  std::vector<double> open_area, open_row_sum, rho, E, B, H;  // by element, of what is open
  // A leaf below an element receives what the element does, as far as it is open.
  for (std::size_t e = 0; e < elements.size(); ++e) {
    std::uint32_t leaf = elements[e];
    while (links.tree().node(leaf).has_children()) leaf = links.tree().node(leaf).first_child;
    const Node& node = links.tree().node(elements[e]);
    const double open = node.open_area / node.area;
    const std::uint32_t p = s.mesh.elements[e].patch;
    const double share = s.mesh.elements[e].area / s.mesh.patches[p].area;
    for (std::uint32_t b = 0; b < bands; ++b) {
      s.element_H.push_back(open * links.radiosity().leaf_H(leaf)[b]);
      s.element_B.push_back(links.radiosity().whole_B(elements[e], b));
      s.patches.H[std::size_t{p} * bands + b] += share * s.element_H.back();
      s.patches.B[std::size_t{p} * bands + b] += share * s.element_B.back();
      rho.push_back(links.radiosity().rho()[std::size_t{node.root} * bands + b]);
      E.push_back(links.radiosity().E()[std::size_t{node.root} * bands + b]);
      B.push_back(links.radiosity().B()[std::size_t{elements[e]} * bands + b]);
      H.push_back(links.radiosity().leaf_H(leaf)[b]);
    }
    s.element_row_sum.push_back(open * row_sum[leaf]);
    open_area.push_back(node.open_area);
    open_row_sum.push_back(row_sum[leaf]);
  }
  s.patches.iterations = result.update.exchange.iterations;
  s.patches.residual = result.update.exchange.residual;
  s.patches.error_bound = result.update.exchange.error_bound;
  s.patches.converged = result.update.exchange.converged;
  s.stopped = result.update.stopped;
  s.form_factor_error = error_of_form_factors(links, result.update.exchange.factor);
  s.seconds_form_factors = result.update.seconds_links;
  s.seconds_solve = result.update.seconds_exchange;

  const ExactVisibility visibility(s.mesh, s.soup);
  std::vector<std::size_t> sample;
  const std::size_t n = elements.size(), count = std::min(n, kMeasured);
  for (std::size_t k = 0; k < count; ++k) sample.push_back(n * (2 * k + 1) / (2 * count));
  s.statistics = point_row_statistics(visibility, sample);
  s.measured_points = count;
  s.energy_balance_defect = energy_balance(open_area, open_row_sum, rho, E, B, H, bands).worst_defect;
  std::mt19937_64 random(options.seed);
  std::size_t pairs = 0;
  for (std::size_t draw = 0; draw < kDraws && pairs < kPairs; ++draw) {
    const std::size_t i = random() % s.mesh.patches.size(), j = random() % s.mesh.patches.size();
    if (i == j) continue;
    const double A_i = s.mesh.patches[i].area, A_j = s.mesh.patches[j].area;
    const double F_ij = patch_form_factor(visibility, i, j).F, F_ji = patch_form_factor(visibility, j, i).F;
    if (F_ij == 0 && F_ji == 0) continue;
    ++pairs;
    const double defect = std::fabs(A_i * F_ij - A_j * F_ji) / std::min(A_i, A_j);
    s.reciprocity_max_defect = std::max(s.reciprocity_max_defect.value_or(0), defect);
  }
  return result;
}

}  // namespace exitance
