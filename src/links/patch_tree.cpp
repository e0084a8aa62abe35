#include "src/links/patch_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "geometry/gauss_rule.h"
#include "src/scene/input_error.h"

namespace exitance {
namespace {

constexpr std::size_t kMostNodes = std::size_t{1} << 31;
/// Of a piece's area: what rounding leaves of a fan's flat quadrilateral.
constexpr double kFlat = 0x1p-40;
/// Relative change of a root's area up to which its nodes remain as they are.
constexpr double kSameArea = 1e-6;
constexpr unsigned kMostPointsAnEdge = 20;

double area_of(const Node& node) {
  Vec3 sum;
  for (std::size_t k = 1; k + 1 < node.corners; ++k)
    sum = sum + cross(node.corner[k] - node.corner[0], node.corner[k + 1] - node.corner[0]);
  return 0.5 * norm(sum);
}

Vec3 middle(const Vec3& a, const Vec3& b) {
  return 0.5 * (a + b);
}

/// The corners of child k.
std::array<Vec3, 4> corners_of_child(const Node& parent, unsigned k) {
  const auto& c = parent.corner;
  if (parent.corners == 3) {
    const Vec3 ab = middle(c[0], c[1]), bc = middle(c[1], c[2]), ca = middle(c[2], c[0]);
    switch (k) {
      case 0:
        return {c[0], ab, ca, {}};
      case 1:
        return {ab, c[1], bc, {}};
      case 2:
        return {ca, bc, c[2], {}};
      default:
        return {bc, ca, ab, {}};
    }
  }
  const Vec3 centre = middle(middle(c[0], c[2]), middle(c[1], c[3]));
  std::array<Vec3, 4> of_child;
  for (unsigned i = 0; i < 4; ++i) {  // corner i of child k: beside the parent's corner k, the same way round
    const unsigned away = (i + 4 - k) % 4;
    of_child[i] = away == 0   ? c[k]
                  : away == 1 ? middle(c[k], c[(k + 1) % 4])
                  : away == 2 ? centre
                              : middle(c[(k + 3) % 4], c[k]);
  }
  return of_child;
}

/// PatchTree::open_points of a node as it is covered by these.
void points_left_open(const Node& node, unsigned per_edge, std::span<const Lid> lids, std::vector<NodePoint>& points) {
  if (!node.covered) return node_points(node, per_edge, points);
  points.clear();
  for (unsigned rule = per_edge; points.empty() && node.open_area > 0 && rule <= kMostPointsAnEdge; rule *= 2) {
    node_points(node, rule, points);
    std::erase_if(points, [&](const NodePoint& p) {
      return std::ranges::any_of(lids, [&](const Lid& lid) { return lid.covers(p.at); });
    });
  }
  double sum = 0;
  for (const NodePoint& p : points) sum += p.weight;
  for (NodePoint& p : points) p.weight /= sum;
}

}  // namespace

PatchTree::PatchTree(const EditedScene& scene, const PolygonSoup& soup, const TreeOptions& options)
    : options_(options) {
  if (!(options.smallest_area > 0)) throw std::invalid_argument("the smallest area of a node must be positive");
  options_.mesh.elements_per_edge = 1;
  const std::size_t objects = scene.scene().objects.size();
  root_first_.resize(objects);
  root_count_.resize(objects);
  facet_first_.resize(objects);
  for (std::uint32_t object = 0; object < objects; ++object) {
    std::vector<std::uint32_t> surfaces;
    const std::vector<Node> nodes = root_nodes(scene, soup, scene.surfaces_of(object).first, object, surfaces);
    append(nodes, surfaces, object);
    facet_first_[object] = soup.first_facet(scene.surfaces_of(object).first);
  }
}

/// The roots of an object as it stands, whose polygons in the soup begin with `polygon`, and the surface of each within
/// the object.
std::vector<Node> PatchTree::root_nodes(const EditedScene& scene, const PolygonSoup& soup, std::uint32_t polygon,
                                        std::uint32_t object, std::vector<std::uint32_t>& surfaces) const {
  const EditedScene::Range range = scene.surfaces_of(object);
  const PatchMesh mesh = make_patch_mesh(scene.scene(), soup, options_.mesh, range.first, range.last, polygon);
  std::vector<Node> roots;
  for (const Patch& patch : mesh.patches) {
    for (const PatchPiece& piece : mesh.pieces_of(patch)) {
      std::vector<Vec3> loop(mesh.loop(piece).begin(), mesh.loop(piece).end());
      if (loop.empty()) {
        for (const Corner& c : soup.corners(soup.facets()[piece.facet])) loop.push_back(c.at);
      }
      for (std::size_t k = 1; k + 1 < loop.size(); k += 2) {
        Node node;
        node.corners = k + 2 < loop.size() ? 4 : 3;
        node.corner = {loop[0], loop[k], loop[k + 1], node.corners == 4 ? loop[k + 2] : Vec3{}};
        node.whole = piece.loop_count == 0 && loop.size() == node.corners;
        node.facet = piece.facet;
        node.area = node.open_area = area_of(node);
        if (node.area <= kFlat * piece.area) continue;
        roots.push_back(node);
        surfaces.push_back(patch.surface - range.first);
      }
    }
  }
  return roots;
}

void PatchTree::append(const std::vector<Node>& root_nodes, const std::vector<std::uint32_t>& surfaces,
                       std::uint32_t object) {
  root_first_[object] = static_cast<std::uint32_t>(roots_.size());
  root_count_[object] = static_cast<std::uint32_t>(root_nodes.size());
  for (std::size_t r = 0; r < root_nodes.size(); ++r) {
    Root root;
    root.node_first = static_cast<std::uint32_t>(nodes_.size());
    root.object = object;
    root.surface = surfaces[r];
    root.present = root.placed = true;
    nodes_.push_back(root_nodes[r]);
    nodes_.back().root = static_cast<std::uint32_t>(roots_.size());
    for (std::size_t n = root.node_first; n < nodes_.size(); ++n) {
      if (nodes_[n].area < 4 * options_.smallest_area) continue;
      if ((nodes_.size() + 4) * sizeof(Node) > options_.mesh.memory_limit) {
        throw LimitError(
            fmt::format("sub-patches of {:.3g} m^2 would take more than the {:.4g} MiB that they may; "
                        "choose a larger smallest area",
                        options_.smallest_area, static_cast<double>(options_.mesh.memory_limit) / 0x1p20));
      }
      if (nodes_.size() + 4 > kMostNodes)
        throw LimitError("the smallest area asks for more than 2^31 sub-patches; choose a larger one");
      Node child = nodes_[n];
      nodes_[n].first_child = static_cast<std::uint32_t>(nodes_.size());
      child.parent = static_cast<std::uint32_t>(n);
      child.whole = false;
      ++child.level;
      nodes_.insert(nodes_.end(), 4, child);
      place_children(static_cast<std::uint32_t>(n));
    }
    root.node_count = static_cast<std::uint32_t>(nodes_.size()) - root.node_first;
    roots_.push_back(root);
  }
  lids_.resize(roots_.size());
}

void PatchTree::place_children(std::uint32_t node) {
  for (unsigned k = 0; k < 4; ++k) {
    Node& child = nodes_[nodes_[node].first_child + k];
    child.corner = corners_of_child(nodes_[node], k);
    child.area = child.open_area = area_of(child);
  }
}

/// Brings the numbers of facets from those of the soup before to those of the soup as it is.
void PatchTree::number_facets(const PolygonSoup& soup, std::span<const PolygonSoup::PolygonRange> polygons) {
  for (std::uint32_t object = 0; object < facet_first_.size(); ++object) {
    const std::uint32_t first = soup.first_facet(polygons[object].first);
    const std::uint32_t offset = first - std::exchange(facet_first_[object], first);
    if (offset == 0) continue;
    for (std::uint32_t r = root_first_[object]; r < root_first_[object] + root_count_[object]; ++r) {
      for (std::uint32_t k = 0; k < roots_[r].node_count; ++k) nodes_[roots_[r].node_first + k].facet += offset;
    }
  }
}

void PatchTree::change_geometry(const EditedScene& scene, const PolygonSoup& soup,
                                std::span<const PolygonSoup::PolygonRange> polygons, std::uint32_t object) {
  const auto roots = std::span(roots_).subspan(root_first_[object], root_count_[object]);
  if (!scene.is_present(object)) {
    for (Root& root : roots) root.present = false;
    number_facets(soup, polygons);
    return;
  }
  std::vector<std::uint32_t> surfaces;
  const std::vector<Node> placed = root_nodes(scene, soup, polygons[object].first, object, surfaces);
  bool same = placed.size() == roots.size();
  for (std::size_t r = 0; same && r < placed.size(); ++r) {
    const Node& old = nodes_[roots[r].node_first];
    same = placed[r].corners == old.corners && surfaces[r] == roots[r].surface &&
           std::fabs(placed[r].area - old.area) <= kSameArea * old.area;
  }
  if (!same) {
    for (Root& root : roots) root.present = false;
    append(placed, surfaces, object);
  } else {
    for (std::size_t r = 0; r < placed.size(); ++r) {
      roots[r].present = roots[r].placed = true;
      Node& node = nodes_[roots[r].node_first];
      node.corner = placed[r].corner;
      node.area = node.open_area = placed[r].area;
      for (std::uint32_t k = 0; k < roots[r].node_count; ++k) {
        nodes_[roots[r].node_first + k].facet = placed[r].facet;
        if (nodes_[roots[r].node_first + k].has_children()) place_children(roots[r].node_first + k);
      }
    }
  }
  facet_first_[object] = soup.first_facet(polygons[object].first);
  number_facets(soup, polygons);
}

void PatchTree::cover(const PolygonSoup& soup, const Contacts& contacts) {
  for (std::uint32_t r = 0; r < roots_.size(); ++r) {
    Root& root = roots_[r];
    const auto nodes = std::span(nodes_).subspan(root.node_first, root.node_count);
    if (std::exchange(root.covered_anew, false)) {
      for (Node& node : nodes) node.covered_anew = node.receives_anew = false;
    }
    if (!root.present) continue;
    std::vector<Lid> lids = lids_on(soup, contacts, nodes.front().facet), changed;
    if (root.placed) {
      changed = lids;
      for (Node& node : nodes) {
        node.covered_anew = node.receives_anew = std::exchange(node.covered, false);
        root.covered_anew = root.covered_anew || node.covered_anew;
        node.open_area = node.area;
      }
    } else {
      std::set_symmetric_difference(lids.begin(), lids.end(), lids_[r].begin(), lids_[r].end(),
                                    std::back_inserter(changed));
    }
    root.placed = false;
    const std::vector<Lid> before = std::exchange(lids_[r], std::move(lids));
    if (!changed.empty()) set_open_area(root.node_first, before, lids_[r], changed);
    root.covered_anew = root.covered_anew || nodes.front().covered_anew;
  }
}

/// lids: all that may cover some of the node; before: those that did; changed: those that do or did so and have come or
/// gone. Of a node that has children it is their sum.
void PatchTree::set_open_area(std::uint32_t n, std::span<const Lid> before, std::span<const Lid> lids,
                              std::span<const Lid> changed) {
  Node& node = nodes_[n];
  const auto of_node = [&](std::span<const Lid> all) {
    std::vector<Lid> found;
    std::ranges::copy_if(all, std::back_inserter(found),
                         [&](const Lid& lid) { return overlaps(node.loop(), node.area, lid); });
    return found;
  };
  const std::vector<Lid> changed_here = of_node(changed);
  if (changed_here.empty()) return;
  const std::vector<Lid> lids_here = of_node(lids);
  node.covered_anew = true;
  const bool was_covered = node.covered;
  std::vector<NodePoint> points_before, points;
  points_left_open(node, options_.points_per_edge, before, points_before);
  if (!node.has_children()) {
    node.open_area = open_area(node.loop(), node.area, lids_here);
    node.covered = node.open_area < node.area;
  } else {
    double open = 0;
    node.covered = false;
    for (std::uint32_t child = node.first_child; child < node.first_child + 4; ++child) {
      set_open_area(child, before, lids, changed_here);
      open += nodes_[child].open_area;
      node.covered = node.covered || nodes_[child].covered;
    }
    node.open_area = node.covered ? open : node.area;
  }
  points_left_open(node, options_.points_per_edge, lids, points);
  node.receives_anew =
      node.covered != was_covered || !std::ranges::equal(points, points_before, {}, &NodePoint::at, &NodePoint::at);
}

void PatchTree::open_points(std::uint32_t n, unsigned per_edge, std::vector<NodePoint>& points) const {
  points_left_open(nodes_[n], per_edge, lids_[nodes_[n].root], points);
}

void node_points(const Node& node, unsigned per_edge, std::vector<NodePoint>& points) {
  const GaussRule<double>& rule = gauss_rule<double>(static_cast<int>(per_edge));
  const auto& c = node.corner;
  const Vec3& last = node.corners == 4 ? c[3] : c[2];
  points.clear();
  double sum = 0;
  for (std::size_t i = 0; i < per_edge; ++i) {
    for (std::size_t j = 0; j < per_edge; ++j) {
      const double u = 0.5 * (1 + rule.node[i]), v = 0.5 * (1 + rule.node[j]);
      const Vec3 low = (1 - u) * c[0] + u * c[1], high = (1 - u) * last + u * c[2];
      const Vec3 along = (1 - v) * (c[1] - c[0]) + v * (c[2] - last), across = high - low;
      points.push_back({(1 - v) * low + v * high, rule.weight[i] * rule.weight[j] * norm(cross(along, across))});
      sum += points.back().weight;
    }
  }
  for (NodePoint& p : points) p.weight /= sum;
}

bool face_each_other(const Node& a, const Node& b, const PolygonSoup& soup) {
  const double least = 0x1p-40 * soup.extent();
  const auto some_in_front = [&](const Node& node, const Node& of) {
    const Plane& plane = soup.facets()[of.facet].plane;
    const double length = norm(plane.normal);
    return std::ranges::any_of(node.loop(),
                               [&](const Vec3& v) { return dot(plane.normal, v - plane.origin) > least * length; });
  };
  return some_in_front(a, b) && some_in_front(b, a);
}

Ball ball_around(const Node& node) {
  Ball ball;
  for (const Vec3& v : node.loop()) ball.centre = ball.centre + (1.0 / node.corners) * v;
  double square = 0;
  for (const Vec3& v : node.loop()) square = std::max(square, dot(v - ball.centre, v - ball.centre));
  ball.radius = (1 + 1e-9) * std::sqrt(square);
  return ball;
}

double most_form_factor(const Node& receiver, const Node& source, const PolygonSoup& soup) {
  const Ball to = ball_around(receiver), from = ball_around(source);
  const Vec3 d = from.centre - to.centre;
  const double both = to.radius + from.radius, least = norm(d) - both;
  if (!(least > 0)) return 1;
  const auto cosine = [&](const Node& node, double sign) {
    const Vec3& normal = soup.facets()[node.facet].plane.normal;
    return std::clamp((sign * dot(normal, d) / norm(normal) + both) / least, 0.0, 1.0);
  };
  const double F = source.area * cosine(receiver, 1) * cosine(source, -1) / (std::numbers::pi * least * least);
  return std::min(1.0, (1 + 1e-9) * F);
}

ShaftEnd shaft_end(const Node& node) {
  return {node.facet, node.whole ? std::span<const Vec3>() : node.loop()};
}

Source source_of(const Node& node) {
  return {node.facet, node.whole ? std::span<const Vec3>() : node.loop()};
}

}  // namespace exitance
