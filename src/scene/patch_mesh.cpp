#include "src/scene/patch_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "geometry/radiator.h"
#include "src/scene/input_error.h"
#include "src/scene/sample_site.h"

namespace exitance {
namespace {

/// A point this near to a cutting line, relative to the size of what is cut, counts as on it: where a grid line meets a
/// vertex up to rounding, no sliver arises. The point itself stays where it is, so that pieces always tile exactly.
constexpr double kOnLine = 1e-9;

/// A facet narrower than this share of its coordinates is a needle: points on it cannot be told from points on a line.
constexpr double kNeedle = 0x1p-40;

/// Room that growing arrays take, at most, for what they hold.
constexpr double kGrowth = 3;

/// The point k parts of n along the edge from a to b: the same bits as n − k parts from b to a.
Vec3 along_edge(const Vec3& a, const Vec3& b, std::uint32_t k, std::uint32_t n) {
  if (k == 0) return a;
  if (k == n) return b;
  if (lexicographically_less(b, a)) return along_edge(b, a, n - k, n);
  return a + (static_cast<double>(k) / n) * (b - a);
}

/// Where the edge from a to b crosses a line from which they are sa and sb away, on opposite sides; symmetric likewise.
Vec3 crossing(const Vec3& a, double sa, const Vec3& b, double sb) {
  if (lexicographically_less(b, a)) return crossing(b, sb, a, sa);
  return a + (sa / (sa - sb)) * (b - a);
}

/// Of a convex loop; needles that are collinear up to rounding have one, too.
double area(std::span<const Vec3> loop) {
  double sum = 0;
  for (std::size_t i = 2; i < loop.size(); ++i) sum += doubled_area(loop[0], loop[i - 1], loop[i]);
  return sum / 2;
}

/// Of a needle, whose corners are collinear up to rounding, the rounded normal has no digit left.
Vec3 unit_normal(const Plane& plane) {
  const bool is_needle = plane.normal_error > 0x1p-40 * plane.normal_size;
  const auto& [a, b, c] = plane.points;
  return normalized(is_needle ? exact_cross(*a, *b, *c) : plane.normal);
}

Loop without_repetitions(const Loop& loop) {
  Loop distinct;
  for (const Vec3& p : loop)
    if (distinct.empty() || !(p == distinct.back())) distinct.push_back(p);
  while (distinct.size() > 1 && distinct.front() == distinct.back()) distinct.pop_back();
  return distinct;
}

double length(const Vec3& a, const Vec3& b) {
  return norm(b - a);
}

bool is_needle(const Loop& facet) {
  double longest = 0, reach = 0;
  for (const Vec3& p : facet) {
    longest = std::max(longest, length(facet[0], p));
    reach = std::max({reach, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  }
  return area(facet) < kNeedle * reach * longest;
}

/// Cuts a convex loop along a line; side(p) is p's distance from it. Either part may come out empty. The points where
/// the loop crosses the line are the same in both.
template <class Side>
void split(const Loop& loop, const Side& side, double tolerance, Loop& positive, Loop& negative) {
  positive.clear();
  negative.clear();
  const auto distance = [&](const Vec3& p) {
    const double s = side(p);
    return std::fabs(s) <= tolerance ? 0 : s;
  };
  bool any_positive = false, any_negative = false;
  double s = distance(loop.front());
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& p = loop[i];
    const Vec3& next = loop[(i + 1) % loop.size()];
    const double s_next = distance(next);
    if (s >= 0) positive.push_back(p);
    if (s <= 0) negative.push_back(p);
    any_positive |= s > 0;
    any_negative |= s < 0;
    if ((s < 0 && s_next > 0) || (s > 0 && s_next < 0)) {
      const Vec3 on_line = crossing(p, s, next, s_next);
      positive.push_back(on_line);
      negative.push_back(on_line);
    }
    s = s_next;
  }
  if (!any_positive) positive.clear();
  if (!any_negative) negative.clear();
}

/// A convex quadrilateral, on one facet or on two that meet in one of its diagonals, and the grid of points that cuts
/// it.
class QuadGrid {
 public:
  QuadGrid(const std::array<Vec3, 4>& corners, std::span<const Loop> facets)
      : corners_(corners), bent_(facets.size() > 1) {
    if (!bent_) return;
    const auto holds = [&](const Vec3& p) {
      return std::find(facets[0].begin(), facets[0].end(), p) != facets[0].end();
    };
    const std::size_t from = holds(corners[0]) && holds(corners[2]) ? 0 : 1;
    diagonal_ = {corners[from], corners[from + 2]};
    normal_ = cross(corners[2] - corners[0], corners[3] - corners[1]);
    const Vec3 across = cross(normal_, diagonal_[1] - diagonal_[0]);
    left_ = (1 / norm(across)) * across;
    tolerance_ = kOnLine * length(diagonal_[0], diagonal_[1]);
    for (std::size_t f = 0; f < 2; ++f) {
      facet_normal_[f] = cross(facets[f][1] - facets[f][0], facets[f][2] - facets[f][0]);
      facet_origin_[f] = facets[f][0];
    }
    facet_left_ = side(centroid(facets[0])) > 0 ? 0 : 1;
  }

  void subdivide(std::uint32_t m, std::uint32_t n) {
    m_ = m;
    points_.clear();
    points_.reserve((m + std::size_t{1}) * (n + std::size_t{1}));
    for (std::uint32_t j = 0; j <= n; ++j) {
      const Vec3 left = along_edge(corners_[0], corners_[3], j, n), right = along_edge(corners_[1], corners_[2], j, n);
      for (std::uint32_t i = 0; i <= m; ++i) {
        const Vec3 p = along_edge(left, right, i, m);
        const bool interior = 0 < i && i < m && 0 < j && j < n;
        points_.push_back(bent_ && interior ? on_facets(p) : p);
      }
    }
  }

  /// The corners of the cell that spans count × count grid cells from (i, j).
  void cell(std::uint32_t i, std::uint32_t j, std::uint32_t count, Loop& corners) const {
    corners = {point(i, j), point(i + count, j), point(i + count, j + count), point(i, j + count)};
  }

  bool bent() const { return bent_; }

  /// Cuts a cell along the diagonal: parts[f] is what lies on facet f, maybe nothing.
  void split_along_diagonal(const Loop& cell, std::array<Loop, 2>& parts) const {
    split(
        cell, [&](const Vec3& p) { return side(p); }, tolerance_, parts[facet_left_], parts[1 - facet_left_]);
    for (Loop& part : parts)
      for (Vec3& p : part)
        if (std::find(cell.begin(), cell.end(), p) == cell.end()) p = on_diagonal(p);
  }

 private:
  const Vec3& point(std::uint32_t i, std::uint32_t j) const { return points_[j * (m_ + std::size_t{1}) + i]; }
  double side(const Vec3& p) const { return dot(left_, p - diagonal_[0]); }

  Vec3 on_diagonal(const Vec3& p) const {
    const Vec3 d = diagonal_[1] - diagonal_[0];
    return diagonal_[0] + (dot(p - diagonal_[0], d) / dot(d, d)) * d;
  }

  /// Moves a point of the bilinear surface onto the facets, along the mean normal.
  Vec3 on_facets(const Vec3& p) const {
    const double s = side(p);
    if (std::fabs(s) <= tolerance_) return on_diagonal(p);
    const std::size_t f = s > 0 ? facet_left_ : 1 - facet_left_;
    return p + (dot(facet_normal_[f], facet_origin_[f] - p) / dot(facet_normal_[f], normal_)) * normal_;
  }

  std::array<Vec3, 4> corners_;
  bool bent_;
  std::array<Vec3, 2> diagonal_, facet_normal_, facet_origin_;
  Vec3 normal_, left_;  ///< the mean normal; the unit vector across the diagonal, to its left seen from the front
  std::size_t facet_left_ = 0;
  double tolerance_ = 0;
  std::uint32_t m_ = 0;
  std::vector<Vec3> points_;
};

/// A square grid in the plane of a polygon, along its longest edge.
class SquareGrid {
 public:
  explicit SquareGrid(const Polygon& polygon) {
    const Loop& outer = polygon.outer;
    origin_ = outer[0];
    Vec3 longest;
    for (std::size_t i = 0; i < outer.size(); ++i) {
      const Vec3 edge = outer[(i + 1) % outer.size()] - outer[i];
      if (dot(edge, edge) > dot(longest, longest)) longest = edge;
    }
    const Vec3 normal = normalized(area_vector(polygon));
    axis_[0] = normalized(longest - dot(longest, normal) * normal);
    axis_[1] = cross(normal, axis_[0]);
    for (std::size_t a = 0; a < 2; ++a) {
      double upper = 0;
      for (const Vec3& p : outer) {
        lower_[a] = std::min(lower_[a], dot(axis_[a], p - origin_));
        upper = std::max(upper, dot(axis_[a], p - origin_));
      }
      extent_[a] = upper - lower_[a];
    }
  }

  double extent(std::size_t axis) const { return extent_[axis]; }

  /// Which of n parts along an axis a point lies in.
  std::uint32_t part_of(const Vec3& p, std::size_t axis, std::uint32_t n) const {
    const double share = (dot(axis_[axis], p - origin_) - lower_[axis]) / extent_[axis];
    return static_cast<std::uint32_t>(std::clamp(std::floor(share * n), 0.0, n - 1.0));
  }

  /// Cuts a convex loop by lines first + 1 … last − 1 of n across an axis; emit(k, part) gets what lies between k and k
  /// + 1.
  template <class Emit>
  void cut(Loop loop, std::size_t axis, std::uint32_t first, std::uint32_t last, std::uint32_t n,
           const Emit& emit) const {
    Loop beyond, before;
    for (std::uint32_t k = first + 1; k < last && !loop.empty(); ++k) {
      const double line = lower_[axis] + extent_[axis] * (static_cast<double>(k) / n);
      split(
          loop, [&](const Vec3& p) { return dot(axis_[axis], p - origin_) - line; },
          kOnLine * std::max(extent_[0], extent_[1]), beyond, before);
      if (!before.empty()) emit(k - 1, before);
      loop.swap(beyond);
    }
    if (!loop.empty()) emit(last - 1, loop);
  }

 private:
  Vec3 origin_;
  std::array<Vec3, 2> axis_;
  std::array<double, 2> lower_{0, 0}, extent_{0, 0};
};

class Mesher {
 public:
  /// polygon_offset: what to add (modulo 2^32) to the number of a surface for that of its polygon.
  Mesher(const Scene& scene, const PolygonSoup& soup, const MeshOptions& options, std::uint32_t polygon_offset = 0)
      : scene_(scene),
        soup_(soup),
        polygon_offset_(polygon_offset),
        samples_(soup),
        size_(options.patch_size),
        small_(options.small_patch),
        elements_per_edge_(options.elements_per_edge),
        per_edge_(options.elements_per_edge) {
    if (!(size_ >= 0) || std::isinf(size_)) throw std::invalid_argument("the patch size must be a finite number ≥ 0");
    if (!(small_ >= 0)) throw std::invalid_argument("the area of small patches must be a number ≥ 0");
    if (per_edge_ == 0) throw std::invalid_argument("elements per edge must be at least 1");
  }

  PatchMesh take() { return std::move(mesh_); }

  /// About how many patches, elements and points a mesh has, at most.
  struct Size {
    double patches = 0, elements = 0, points = 0;
  };

  void add_size_of(std::uint32_t surface, Size& size) {
    const auto add = [&](double patches, double elements, double points_each) {
      size.patches += patches;
      size.elements += elements;
      size.points += points_each * (per_edge_ > 1 ? patches + elements : elements);
    };
    const Polygon& polygon = scene_.surfaces[surface].polygon;
    const double e = per_edge_;
    switch (begin(surface)) {
      case Shape::none:
        break;
      case Shape::needle:
        add(1, 1, static_cast<double>(polygon.outer.size()));
        break;
      case Shape::triangle: {
        const double n = parts(longest_edge(facets_[0]));
        add(n * n, n * n * e * e, 3);
        break;
      }
      case Shape::quad: {
        const double cells = parts(width(outer_)) * parts(height(outer_));
        add(cells, cells * e * e, 4);
        break;
      }
      case Shape::other: {
        const SquareGrid grid(polygon);
        const double m = parts(grid.extent(0)), n = parts(grid.extent(1));
        // Besides the cells, what edges cut off.
        const double edges = static_cast<double>(facets_.size()) * (m + n);
        add(m * n, m * n * e * e + edges * e, 5);
      }
    }
  }

  void refuse_if_too_large(const Size& size, std::uint64_t memory_limit) const {
    // Where bent quadrilaterals are cut along their diagonal there are more.
    constexpr double kMostPoints = std::numeric_limits<std::uint32_t>::max() / 2.0;
    const double bytes = kGrowth * (size.points * sizeof(Vec3) + size.patches * sizeof(Patch) +
                                    size.elements * (sizeof(PatchPiece) + sizeof(Element)));
    const bool too_many = !(size.points < kMostPoints);
    if (!too_many && bytes <= static_cast<double>(memory_limit)) return;
    throw LimitError(fmt::format(
        "the mesh would have about {:.2g} patches and {:.2g} elements and take {:.3g} GiB of memory, {}; ask for "
        "larger "
        "patches or fewer elements",
        size.patches, size.elements, bytes * 0x1p-30,
        too_many ? "with more points than can be counted"
                 : fmt::format("of which {:.3g} GiB may be used", static_cast<double>(memory_limit) * 0x1p-30)));
  }

  void cut(std::uint32_t surface) {
    switch (begin(surface)) {
      case Shape::none:
        break;
      case Shape::needle:
        keep_whole(scene_.surfaces[surface].polygon);
        break;
      case Shape::triangle:
        cut_triangle(facets_[0]);
        break;
      case Shape::quad:
        cut_quad({outer_[0], outer_[1], outer_[2], outer_[3]});
        break;
      case Shape::other:
        cut_polygon(scene_.surfaces[surface].polygon);
    }
  }

 private:
  /// How a surface is cut.
  enum class Shape : std::uint8_t { none, needle, triangle, quad, other };

  Shape begin(std::uint32_t surface) {
    facets_.clear();
    const std::uint32_t polygon = surface + polygon_offset_;
    first_facet_ = soup_.first_facet(polygon);
    for (std::uint32_t f = first_facet_; f < soup_.first_facet(polygon + 1); ++f) {
      Loop& loop = facets_.emplace_back();
      for (const Corner& c : soup_.corners(soup_.facets()[f])) loop.push_back(soup_.vertices()[c.vertex]);
    }
    surface_ = surface;
    per_edge_ = elements_per_edge_;
    if (facets_.empty()) return Shape::none;
    const Polygon& outline = scene_.surfaces[surface].polygon;
    const Shape shape = shape_of(outline);
    if (small_ > 0 && (shape == Shape::needle || area_of_patch(shape, outline) <= small_)) per_edge_ = 1;
    return shape;
  }

  Shape shape_of(const Polygon& polygon) {
    outer_ = without_repetitions(polygon.outer);
    const auto needles = std::ranges::count_if(facets_, is_needle);
    if (needles == std::ssize(facets_)) return Shape::needle;
    if (facets_.size() == 1 && facets_[0].size() == 3) return Shape::triangle;
    const bool is_quad = needles == 0 && polygon.holes.empty() && outer_.size() == 4 && facets_.size() <= 2 &&
                         is_strictly_convex(outer_);
    return is_quad ? Shape::quad : Shape::other;
  }

  /// About, of a patch of the current surface.
  double area_of_patch(Shape shape, const Polygon& polygon) const {
    if (shape == Shape::triangle) {
      const double n = parts(longest_edge(facets_[0]));
      return area(facets_[0]) / (n * n);
    }
    const auto part = [&](double total) { return total / parts(total); };
    if (shape == Shape::quad) return part(width(outer_)) * part(height(outer_));
    const SquareGrid grid(polygon);
    return part(grid.extent(0)) * part(grid.extent(1));
  }

  static double width(const Loop& q) { return std::max(length(q[0], q[1]), length(q[3], q[2])); }
  static double height(const Loop& q) { return std::max(length(q[0], q[3]), length(q[1], q[2])); }
  static double longest_edge(const Loop& t) {
    return std::max({length(t[0], t[1]), length(t[1], t[2]), length(t[2], t[0])});
  }

  /// Into how many parts something of this length is cut; a whole number.
  double parts(double total) const {
    // 3 / 0.3 is ten parts, rounded or not.
    return size_ > 0 ? std::max(1.0, std::ceil(total / size_ * (1 - 1e-12))) : 1;
  }
  std::uint32_t whole_parts(double total) const { return static_cast<std::uint32_t>(parts(total)); }

  static bool is_strictly_convex(const Loop& quad) {
    const Vec3 normal = cross(quad[2] - quad[0], quad[3] - quad[1]);
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 turn = cross(quad[(i + 1) % 4] - quad[i], quad[(i + 2) % 4] - quad[(i + 1) % 4]);
      if (!(dot(turn, normal) > kOnLine * dot(normal, normal))) return false;
    }
    return true;
  }

  std::uint32_t add_loop(const Loop& loop) {
    const auto first = static_cast<std::uint32_t>(mesh_.points.size());
    mesh_.points.append(loop.begin(), loop.end());
    return first;
  }

  void add_piece(std::uint32_t facet, const Loop& loop) {
    mesh_.pieces.push_back({facet, add_loop(loop), static_cast<std::uint32_t>(loop.size()), area(loop)});
  }

  /// Adds the pieces of a new patch through `add`; what is one patch as a whole has its facets for pieces.
  template <class Add>
  void begin_patch(bool whole, const Add& add) {
    Patch patch;
    patch.surface = surface_;
    patch.piece_first = static_cast<std::uint32_t>(mesh_.pieces.size());
    patch.element_first = static_cast<std::uint32_t>(mesh_.elements.size());
    if (whole)
      for (std::uint32_t f = 0; f < facets_.size(); ++f)
        mesh_.pieces.push_back({first_facet_ + f, 0, 0, area(facets_[f])});
    else
      add();
    patch.piece_count = static_cast<std::uint32_t>(mesh_.pieces.size()) - patch.piece_first;
    mesh_.patches.push_back(patch);
  }

  /// Adds the element of the current patch that the pieces from piece_first on tile.
  void add_element(std::uint32_t piece_first, std::uint32_t piece_end, std::uint32_t loop_first,
                   std::uint32_t loop_count) {
    Element element;
    element.patch = static_cast<std::uint32_t>(mesh_.patches.size()) - 1;
    element.piece_first = piece_first;
    element.piece_count = piece_end - piece_first;
    element.loop_first = loop_first;
    element.loop_count = loop_count;
    for (const PatchPiece& piece : mesh_.pieces_of(element)) element.area += piece.area;
    element.facet = std::ranges::max_element(mesh_.pieces_of(element), {}, &PatchPiece::area)->facet;
    element.sample = samples_.choose(mesh_, element);
    element.normal = unit_normal(soup_.facets()[element.facet].plane);
    mesh_.elements.push_back(element);
  }

  /// The patch is its one element.
  void element_is_patch(const Loop& outline) {
    const Patch& patch = mesh_.patches.back();
    const PatchPiece& piece = mesh_.pieces[patch.piece_first];
    const std::uint32_t end = patch.piece_first + patch.piece_count;
    const bool shares = patch.piece_count == 1 && piece.loop_count > 0;
    add_element(patch.piece_first, end, shares ? piece.loop_first : add_loop(outline),
                shares ? piece.loop_count : static_cast<std::uint32_t>(outline.size()));
  }

  void end_patch() {
    Patch& patch = mesh_.patches.back();
    patch.element_count = static_cast<std::uint32_t>(mesh_.elements.size()) - patch.element_first;
    for (std::uint32_t e = 0; e < patch.element_count; ++e) patch.area += mesh_.elements[patch.element_first + e].area;
  }

  void keep_whole(const Polygon& polygon) {
    begin_patch(true, [] {});
    element_is_patch(polygon.outer);
    end_patch();
  }

  void cut_quad(const std::array<Vec3, 4>& q) {
    const std::uint32_t m = whole_parts(width({q.begin(), q.end()})), n = whole_parts(height({q.begin(), q.end()}));
    const std::uint32_t e = per_edge_;
    QuadGrid grid(q, facets_);
    grid.subdivide(m * e, n * e);
    Loop cell;
    std::array<Loop, 2> halves;
    const auto add_cell = [&] {
      if (!grid.bent()) return add_piece(first_facet_, cell);
      grid.split_along_diagonal(cell, halves);
      for (std::uint32_t f = 0; f < 2; ++f)
        if (!halves[f].empty()) add_piece(first_facet_ + f, halves[f]);
    };
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < m; ++i) {
        grid.cell(i * e, j * e, e, cell);
        begin_patch(m == 1 && n == 1, add_cell);
        if (e == 1) element_is_patch(cell);
        for (std::uint32_t y = 0; e > 1 && y < e; ++y)
          for (std::uint32_t x = 0; x < e; ++x) {
            grid.cell(i * e + x, j * e + y, 1, cell);
            const auto first = static_cast<std::uint32_t>(mesh_.pieces.size());
            add_cell();
            add_element_with_outline(first, cell);
          }
        end_patch();
      }
  }

  /// An element whose pieces were just added, from `first` on.
  void add_element_with_outline(std::uint32_t first, const Loop& outline) {
    const auto end = static_cast<std::uint32_t>(mesh_.pieces.size());
    const PatchPiece piece = mesh_.pieces[first];
    if (end - first == 1)
      add_element(first, end, piece.loop_first, piece.loop_count);
    else
      add_element(first, end, add_loop(outline), static_cast<std::uint32_t>(outline.size()));
  }

  void cut_triangle(const Loop& t) {
    const std::uint32_t n = whole_parts(longest_edge(t));
    const std::uint32_t e = per_edge_;
    const std::uint32_t fine = n * e;
    const auto point = [&](std::uint32_t i, std::uint32_t j) {
      const Vec3 left = along_edge(t[0], t[2], j, fine), right = along_edge(t[1], t[2], j, fine);
      return j == fine ? t[2] : along_edge(left, right, i, fine - j);
    };
    Loop triangle(3);
    // Of the patch in column i of row j, upright or turned by half a turn, the corner at (x, y) of its e parts.
    const auto cut_one = [&](std::uint32_t i, std::uint32_t j, bool turned) {
      const auto corner = [&](std::uint32_t x, std::uint32_t y) {
        return turned ? point((i + 1) * e - x, (j + 1) * e - y) : point(i * e + x, j * e + y);
      };
      const auto add = [&] { add_piece(first_facet_, triangle); };
      triangle = {corner(0, 0), corner(e, 0), corner(0, e)};
      begin_patch(n == 1, add);
      if (e == 1) element_is_patch(triangle);
      const auto add_part = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        triangle = {a, b, c};
        const auto first = static_cast<std::uint32_t>(mesh_.pieces.size());
        add();
        add_element_with_outline(first, triangle);
      };
      for (std::uint32_t y = 0; e > 1 && y < e; ++y)
        for (std::uint32_t x = 0; x + y < e; ++x) {
          add_part(corner(x, y), corner(x + 1, y), corner(x, y + 1));
          if (x + y + 1 < e) add_part(corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1));
        }
      end_patch();
    };
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i + j < n; ++i) {
        cut_one(i, j, false);
        if (i + j + 1 < n) cut_one(i, j, true);
      }
  }

  void cut_polygon(const Polygon& polygon) {
    const SquareGrid grid(polygon);
    const std::uint32_t m = whole_parts(grid.extent(0)), n = whole_parts(grid.extent(1)), e = per_edge_;
    struct Part {
      std::uint64_t cell;
      std::uint32_t facet;
      Loop loop;
    };
    const bool whole = m == 1 && n == 1;
    std::vector<Part> in_cells;
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
      const auto add = [&](std::uint32_t i, std::uint32_t j, const Loop& part) {
        in_cells.push_back({std::uint64_t{j} * m + i, f, part});
      };
      if (is_needle(facets_[f])) {
        const Vec3 middle = centroid(facets_[f]);
        add(grid.part_of(middle, 0, m), grid.part_of(middle, 1, n), facets_[f]);
        continue;
      }
      grid.cut(facets_[f], 0, 0, m, m, [&](std::uint32_t i, const Loop& strip) {
        grid.cut(strip, 1, 0, n, n, [&](std::uint32_t j, const Loop& part) { add(i, j, part); });
      });
    }
    std::stable_sort(in_cells.begin(), in_cells.end(), [](const Part& a, const Part& b) { return a.cell < b.cell; });
    for (auto first = in_cells.begin(); first != in_cells.end();) {
      const auto last = std::find_if(first, in_cells.end(), [&](const Part& p) { return p.cell != first->cell; });
      begin_patch(whole, [&] {
        for (auto p = first; p != last; ++p) add_piece(first_facet_ + p->facet, p->loop);
      });
      const std::uint32_t pieces = mesh_.patches.back().piece_first;
      if (whole && e == 1)
        element_is_patch(polygon.outer);
      else if (e == 1)
        for (std::uint32_t k = pieces; k < pieces + mesh_.patches.back().piece_count; ++k)
          add_element(k, k + 1, mesh_.pieces[k].loop_first, mesh_.pieces[k].loop_count);
      else
        for (auto p = first; p != last; ++p) cut_into_elements(grid, m, n, p->cell, first_facet_ + p->facet, p->loop);
      end_patch();
      first = last;
    }
  }

  /// Cuts a patch's part of a facet, in one of m × n cells, along the lines that halve, third … the cell.
  void cut_into_elements(const SquareGrid& grid, std::uint32_t m, std::uint32_t n, std::uint64_t cell,
                         std::uint32_t facet, const Loop& loop) {
    const std::uint32_t e = per_edge_;
    const auto i = static_cast<std::uint32_t>(cell % m), j = static_cast<std::uint32_t>(cell / m);
    const auto add = [&](std::uint32_t, const Loop& part) {
      const auto first = static_cast<std::uint32_t>(mesh_.pieces.size());
      add_piece(facet, part);
      add_element_with_outline(first, part);
    };
    if (is_needle(facets_[facet - first_facet_])) return add(0, loop);
    grid.cut(loop, 0, i * e, (i + 1) * e, m * e,
             [&](std::uint32_t, const Loop& strip) { grid.cut(strip, 1, j * e, (j + 1) * e, n * e, add); });
  }

  const Scene& scene_;
  const PolygonSoup& soup_;
  std::uint32_t polygon_offset_;
  SampleSite samples_;
  double size_, small_;
  std::uint32_t elements_per_edge_;
  std::uint32_t per_edge_;  ///< of the current surface
  PatchMesh mesh_;
  std::uint32_t surface_ = 0, first_facet_ = 0;
  std::vector<Loop> facets_;  ///< of the current surface
  Loop outer_;                ///< its outer corners, each once
};

void refuse_if_too_large(const Scene& scene, Mesher& mesher, const MeshOptions& options, std::uint32_t first,
                         std::uint32_t last) {
  Mesher::Size size;
  for (std::uint32_t k = first; k < last; ++k)
    if (!scene.surfaces[k].obstruction_only) mesher.add_size_of(k, size);
  mesher.refuse_if_too_large(size, options.memory_limit);
}

}  // namespace

PolygonSoup make_soup(const Scene& scene) {
  std::vector<Polygon> polygons;
  std::vector<Role> roles;
  polygons.reserve(scene.surfaces.size());
  roles.reserve(scene.surfaces.size());
  for (const Surface& surface : scene.surfaces) {
    polygons.push_back(surface.polygon);
    roles.push_back(surface.obstruction_only ? Role::sheet : Role::patch);
  }
  return PolygonSoup(polygons, roles, {}, 0, Planes::rounded);
}

PatchMesh make_patch_mesh(const Scene& scene, const PolygonSoup& soup, const MeshOptions& options) {
  return make_patch_mesh(scene, soup, options, 0, static_cast<std::uint32_t>(scene.surfaces.size()), 0);
}

PatchMesh make_patch_mesh(const Scene& scene, const PolygonSoup& soup, const MeshOptions& options, std::uint32_t first,
                          std::uint32_t last, std::uint32_t polygon) {
  Mesher mesher(scene, soup, options, polygon - first);
  refuse_if_too_large(scene, mesher, options, first, last);
  for (std::uint32_t k = first; k < last; ++k)
    if (!scene.surfaces[k].obstruction_only) mesher.cut(k);
  return mesher.take();
}

void refuse_too_large_a_mesh(const Scene& scene, const PolygonSoup& soup, const MeshOptions& options) {
  Mesher mesher(scene, soup, options);
  refuse_if_too_large(scene, mesher, options, 0, static_cast<std::uint32_t>(scene.surfaces.size()));
}

}  // namespace exitance
