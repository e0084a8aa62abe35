#include "src/reference/refined_mesh.h"

#include <algorithm>
#include <stdexcept>

#include "geometry/shaft.h"
#include "src/form_factor/visual_events.h"

namespace exitance {
namespace {

/// Lines divide a patch into so many at a time.
constexpr std::size_t kParts = 4;
/// A line is cut along where the farthest corner on its one side is at least this share as far as that on the other.
constexpr double kEvenness = 0.1;

/// min / max of the distances of the farthest corners on both sides of the plane.
double evenness(const AreaCell& cell, const CutPlane& plane) {
  double below = 0, above = 0;
  for (const Vec3& v : cell.loop()) {
    const double d = plane.at(v);
    below = std::max(below, -d);
    above = std::max(above, d);
  }
  return std::min(below, above) / std::max(below, above);
}

/// Lines on the cell at which some emitter begins, or ceases, to be hidden by something else or by more of it.
std::vector<VisualEvent> shadow_boundaries(const PolygonSoup& soup, const Source& cell,
                                           std::span<const std::uint32_t> emitters) {
  std::vector<VisualEvent> all;
  std::vector<std::uint32_t> between;
  Shaft shaft(soup);
  for (const std::uint32_t emitter : emitters) {
    shaft.reset({cell.facet, cell.loop}, {emitter, {}});
    if (!shaft.face_each_other()) continue;
    if (shaft.find_occluders(between) == Shaft::Overlap::blocking) continue;
    const std::vector<VisualEvent> events = visual_events(soup, cell, {emitter, {}}, between);
    all.insert(all.end(), events.begin(), events.end());
  }
  return all;
}

/// The parts of a cell along the line that divides it most evenly; empty where none does.
std::vector<AreaCell> cut_along_lines(const AreaCell& cell, std::span<const VisualEvent> lines) {
  const VisualEvent* along = nullptr;
  double best = kEvenness;
  for (const VisualEvent& line : lines) {
    if (!line.concerns(cell.loop())) continue;
    if (const double even = evenness(cell, line.plane); even > best) {
      best = even;
      along = &line;
    }
  }
  return along == nullptr ? std::vector<AreaCell>{} : cut(cell, along->plane);
}

std::vector<AreaCell> quarters(const AreaCell& cell) {
  std::vector<AreaCell> parts;
  const auto [one, other] = bisect(cell);
  for (const AreaCell& half : {one, other}) {
    const auto [first, second] = bisect(half);
    parts.push_back(first);
    parts.push_back(second);
  }
  return parts;
}

/// The grid of a quadrilateral divides opposite edges evenly; a triangle's has rows along its first edge, where every
/// other triangle is turned round.
std::vector<AreaCell> grid_of(const AreaCell& cell, std::uint32_t n) {
  const auto& c = cell.corner;
  std::vector<AreaCell> grid;
  const auto part = [n](std::uint32_t k) { return static_cast<double>(k) / n; };
  if (cell.corners == 4) {
    const auto at = [&](std::uint32_t i, std::uint32_t j) {
      const Vec3 low = c[0] + part(i) * (c[1] - c[0]), high = c[3] + part(i) * (c[2] - c[3]);
      return low + part(j) * (high - low);
    };
    for (std::uint32_t j = 0; j < n; ++j) {
      for (std::uint32_t i = 0; i < n; ++i) {
        grid.push_back({{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, 4});
      }
    }
    return grid;
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return c[0] + part(i) * (c[1] - c[0]) + part(j) * (c[2] - c[0]);
  };
  const auto add = [&](const Vec3& p, const Vec3& q, const Vec3& r) { grid.push_back({{p, q, r, p}, 3}); };
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i + j < n; ++i) {
      add(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i + j + 1 < n) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return grid;
}

Vec3 centroid(const AreaCell& cell) {
  Vec3 sum;
  double area = 0;
  for (int k = 1; k + 1 < cell.corners; ++k) {
    const auto second = static_cast<std::size_t>(k);
    const Vec3 &a = cell.corner[0], &b = cell.corner[second], &c = cell.corner[second + 1];
    const double part = norm(cross(b - a, c - a));
    sum = sum + (part / 3) * ((b - a) + (c - a));
    area += part;
  }
  return cell.corner[0] + (1 / area) * sum;
}

}  // namespace

RefinedMesh::RefinedMesh(const Scene& scene, const PolygonSoup& soup, const MeshOptions& options)
    : soup_(&soup), n_(options.elements_per_edge) {
  if (n_ < 1) throw std::invalid_argument("RefinedMesh: a patch needs an element");
  refuse_too_large_a_mesh(scene, soup, options);
  const PatchMesh start = make_patch_mesh(scene, soup, {.patch_size = options.patch_size});
  for (const Patch& patch : start.patches) {
    for (const PatchPiece& piece : start.pieces_of(patch)) {
      const std::vector<Vec3> loop = corners_of(soup, {piece.facet, start.loop(piece)});
      for (const AreaCell& shape : cells_of(loop)) cells_.push_back({patch.surface, piece.facet, shape});
    }
  }
  for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
    const Surface& surface = scene.surfaces[s];
    const std::vector<double>& E = scene.materials[surface.material].E;
    if (surface.obstruction_only || std::ranges::all_of(E, [](double e) { return e == 0; })) continue;
    for (std::uint32_t f = soup.first_facet(s); f < soup.first_facet(s + 1); ++f) emitters_.push_back(f);
  }
  make_mesh();
}

std::vector<AreaCell> RefinedMesh::parts_of(const Cell& cell) const {
  const std::vector<VisualEvent> lines = shadow_boundaries(*soup_, {cell.facet, cell.shape.loop()}, emitters_);
  std::vector<AreaCell> parts{cell.shape};
  for (std::size_t k = 0; k < parts.size() && parts.size() < kParts;) {
    const std::vector<AreaCell> some = cut_along_lines(parts[k], lines);
    if (some.size() < 2) {
      ++k;
      continue;
    }
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(k));
    parts.insert(parts.end(), some.begin(), some.end());
  }
  return parts.size() > 1 ? parts : quarters(cell.shape);
}

std::vector<RefinedMesh::Origin> RefinedMesh::split(std::span<const std::uint32_t> patches) {
  std::vector<Cell> cells;
  std::vector<Origin> origins;
  for (const std::uint32_t p : patches) {
    const Cell& cell = cells_.at(p);
    for (const AreaCell& shape : parts_of(cell)) {
      cells.push_back({cell.surface, cell.facet, shape});
      origins.push_back({p, false});
    }
  }
  for (std::uint32_t p = 0; p < cells_.size(); ++p) {
    if (std::ranges::binary_search(patches, p)) continue;
    cells.push_back(cells_[p]);
    origins.push_back({p, true});
  }
  cells_ = std::move(cells);
  make_mesh();
  return origins;
}

void RefinedMesh::make_mesh() {
  mesh_ = {};
  for (const Cell& cell : cells_) add_elements(cell);
}

void RefinedMesh::add_elements(const Cell& cell) {
  const auto add_piece = [&](const AreaCell& shape) {
    const auto first = static_cast<std::uint32_t>(mesh_.points.size());
    const auto loop = shape.loop();
    mesh_.points.append(loop.begin(), loop.end());
    mesh_.pieces.push_back({cell.facet, first, static_cast<std::uint32_t>(loop.size()), shape.area()});
    return static_cast<std::uint32_t>(mesh_.pieces.size() - 1);
  };
  const Vec3 normal = normalized(soup_->facets()[cell.facet].plane.normal);
  Patch patch{.surface = cell.surface,
              .piece_first = add_piece(cell.shape),
              .piece_count = 1,
              .element_first = static_cast<std::uint32_t>(mesh_.elements.size())};
  for (const AreaCell& shape : grid_of(cell.shape, n_)) {
    const std::uint32_t piece = add_piece(shape);
    const PatchPiece& of = mesh_.pieces[piece];
    mesh_.elements.push_back({.patch = static_cast<std::uint32_t>(mesh_.patches.size()),
                              .facet = cell.facet,
                              .sample = centroid(shape),
                              .normal = normal,
                              .area = of.area,
                              .piece_first = piece,
                              .piece_count = 1,
                              .loop_first = of.loop_first,
                              .loop_count = of.loop_count});
    patch.area += of.area;
    ++patch.element_count;
  }
  mesh_.patches.push_back(patch);
}

}  // namespace exitance
