#include "src/output/faces.h"

#include <array>
#include <cmath>
#include <limits>

namespace exitance {
namespace {

// Number of a grid cell's coordinates; different cells may share one.
std::uint64_t cell_number(const std::array<double, 3>& cell) {
  std::uint64_t number = 0;
  for (const double c : cell) {
    number = (number ^ std::hash<double>{}(c)) * 0x9e3779b97f4a7c15u;
    number ^= number >> 29;
  }
  return number;
}

}  // namespace

void Faces::add(std::uint32_t surface, std::uint32_t patch, std::uint32_t element, std::span<const Vec3> loop) {
  if (!surface_.empty() && surface_.back() != surface) points_of_surface_.clear();
  for (const Vec3& p : loop) corner_.push_back(merged_point(p));
  first_.push_back(static_cast<std::uint32_t>(corner_.size()));
  surface_.push_back(surface);
  patch_.push_back(patch);
  element_.push_back(element);
}

std::uint32_t Faces::merged_point(const Vec3& p) {
  // Cells are far larger than the merging distance, so that hardly any point has to look into a second one.
  const double cell_size = merge_distance_ > 0 ? 64 * merge_distance_ : 1;
  std::array<std::array<double, 2>, 3> near{};  // cells that reach within the merging distance, along each axis
  for (int axis = 0; axis < 3; ++axis) {
    near[static_cast<std::size_t>(axis)] = {std::floor((p[axis] - merge_distance_) / cell_size) + 0.0,
                                            std::floor((p[axis] + merge_distance_) / cell_size) + 0.0};
  }
  for (unsigned choice = 0; choice < 8; ++choice) {
    std::array<double, 3> cell{};
    bool repeated = false;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const bool upper = (choice >> axis) & 1u;
      repeated = repeated || (upper && near[axis][0] == near[axis][1]);
      cell[axis] = near[axis][upper ? 1 : 0];
    }
    if (repeated) continue;
    const auto [begin, end] = points_of_surface_.equal_range(cell_number(cell));
    for (auto it = begin; it != end; ++it) {
      const Vec3 d = points_[it->second] - p;
      if (std::abs(d.x) <= merge_distance_ && std::abs(d.y) <= merge_distance_ && std::abs(d.z) <= merge_distance_) {
        return it->second;
      }
    }
  }
  const auto index = static_cast<std::uint32_t>(points_.size());
  points_.push_back(p);
  points_of_surface_.emplace(cell_number({std::floor(p.x / cell_size) + 0.0, std::floor(p.y / cell_size) + 0.0,
                                          std::floor(p.z / cell_size) + 0.0}),
                             index);
  return index;
}

double Faces::area(std::size_t face) const {
  const auto corner = corners(face);
  Vec3 sum;
  for (std::size_t k = 2; k < corner.size(); ++k) {
    const Vec3& origin = points_[corner[0]];
    sum = sum + cross(points_[corner[k - 1]] - origin, points_[corner[k]] - origin);
  }
  return norm(sum) / 2;
}

Faces make_faces(const PatchMesh& mesh, const PolygonSoup& soup) {
  Faces faces(1e-9 * soup.extent());
  std::vector<Vec3> whole_facet;
  for (std::uint32_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    for (const PatchPiece& piece : mesh.pieces_of(element)) {
      std::span<const Vec3> loop = mesh.loop(piece);
      if (loop.empty()) {
        whole_facet.clear();
        for (const Corner& c : soup.corners(soup.facets()[piece.facet])) {
          whole_facet.push_back(soup.vertices()[c.vertex]);
        }
        loop = whole_facet;
      }
      faces.add(mesh.patches[element.patch].surface, element.patch, e, loop);
    }
  }
  return faces;
}

std::vector<double> point_averages(const Faces& faces, std::span<const double> values, std::uint32_t components,
                                   std::span<const std::uint8_t> hidden) {
  // Hidden elements weigh so little that they show only where there is nothing else.
  constexpr double kNextToNothing = 1e-30;
  std::vector<double> mean(faces.points().size() * components), weight(faces.points().size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::size_t e = faces.element(f);
    const double w = (faces.area(f) + std::numeric_limits<double>::min()) *
                     (!hidden.empty() && hidden[e] != 0 ? kNextToNothing : 1.0);
    for (const std::uint32_t p : faces.corners(f)) {
      weight[p] += w;
      for (std::uint32_t c = 0; c < components; ++c) mean[p * components + c] += w * values[e * components + c];
    }
  }
  for (std::size_t p = 0; p < weight.size(); ++p) {
    for (std::uint32_t c = 0; c < components; ++c) mean[p * components + c] /= weight[p];
  }
  return mean;
}

}  // namespace exitance
