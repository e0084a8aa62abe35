#pragma once
// What is drawn: convex faces that tile the elements, their corners merged within each surface.

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/vec3.h"
#include "src/scene/patch_mesh.h"

namespace exitance {

/// Convex, planar faces, counter-clockwise seen from the front. Those of a later surface lie on top where two coincide.
class Faces {
 public:
  /// Corners of one surface closer than merge_distance [m, ≥ 0] along every axis become one point (the first of them).
  explicit Faces(double merge_distance) : merge_distance_(merge_distance) {}

  /// A face with three corners or more, part of an element. Surfaces ascend from call to call.
  void add(std::uint32_t surface, std::uint32_t patch, std::uint32_t element, std::span<const Vec3> loop);

  std::size_t size() const { return element_.size(); }
  std::span<const Vec3> points() const { return points_; }
  std::span<const std::uint32_t> corners(std::size_t face) const {  ///< indices into points()
    return {corner_.data() + first_[face], corner_.data() + first_[face + 1]};
  }
  std::uint32_t surface(std::size_t face) const { return surface_[face]; }
  std::uint32_t patch(std::size_t face) const { return patch_[face]; }
  std::uint32_t element(std::size_t face) const { return element_[face]; }
  double area(std::size_t face) const;  ///< [m²]

 private:
  std::uint32_t merged_point(const Vec3& p);

  double merge_distance_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> first_{0}, corner_, surface_, patch_, element_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> points_of_surface_;  // by grid cell, of the last surface
};

/// The pieces of all elements, in order; corners merge within 1e-9 of the soup's extent.
Faces make_faces(const PatchMesh& mesh, const PolygonSoup& soup);

/// Values at the points: the mean over the faces that meet there, weighted by area, of their elements' values. values:
/// elements × components; hidden: one an element, not 0 where it is to be left out (a point in contact, which sees
/// nothing, would darken its surroundings), or empty. Where all are hidden they count all the same. Result: points ×
/// components.
std::vector<double> point_averages(const Faces& faces, std::span<const double> values, std::uint32_t components,
                                   std::span<const std::uint8_t> hidden = {});

}  // namespace exitance
