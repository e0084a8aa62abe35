#include "geometry/facets.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

#include "geometry/projection.h"

namespace exitance {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// A face knows how often the way to it from outside crosses the boundary: −1 not yet visited, odd inside.
struct FaceDepth {
  int depth = -1;
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<const Vec3*, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<FaceDepth, Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                               CGAL::No_constraint_intersection_tag>;

void mark_depth(Triangulation& triangulation) {
  std::vector<Triangulation::Face_handle> pending{triangulation.infinite_face()};
  pending.front()->info().depth = 0;
  std::vector<Triangulation::Face_handle> beyond;
  while (!pending.empty()) {
    while (!pending.empty()) {
      const auto face = pending.back();
      pending.pop_back();
      for (int i = 0; i < 3; ++i) {
        const auto neighbour = face->neighbor(i);
        if (neighbour->info().depth >= 0) continue;
        if (face->is_constrained(i)) {
          beyond.push_back(face);
          continue;
        }
        neighbour->info().depth = face->info().depth;
        pending.push_back(neighbour);
      }
    }
    // Everything of this depth is known now; what still lies unvisited across its boundary is one deeper.
    for (const auto& face : std::exchange(beyond, {})) {
      for (int i = 0; i < 3; ++i) {
        const auto neighbour = face->neighbor(i);
        if (neighbour->info().depth >= 0) continue;
        neighbour->info().depth = face->info().depth + 1;
        pending.push_back(neighbour);
      }
    }
  }
}

/// Whether a simple loop runs clockwise in its projection.
bool is_reversed(Projection projection, const Loop& loop) {
  const auto smallest = std::min_element(loop.begin(), loop.end(), [&](const Vec3& a, const Vec3& b) {
    return std::pair{projection.u(a), projection.v(a)} < std::pair{projection.u(b), projection.v(b)};
  });
  // The loop turns at its smallest point: both neighbours lie beyond it, and on one line they would overlap.
  const auto i = static_cast<std::size_t>(smallest - loop.begin());
  return turn(projection, loop[(i + loop.size() - 1) % loop.size()], loop[i], loop[(i + 1) % loop.size()]) < 0;
}

std::vector<Loop> triangulate(Projection projection, std::span<const Loop> loops) {
  Triangulation triangulation;
  for (const Loop& loop : loops) {
    std::vector<Triangulation::Vertex_handle> handles;
    handles.reserve(loop.size());
    for (const Vec3& p : loop) {
      handles.push_back(triangulation.insert({projection.u(p), projection.v(p)}));
      handles.back()->info() = &p;
    }
    for (std::size_t i = 0; i < handles.size(); ++i) {
      triangulation.insert_constraint(handles[i], handles[(i + 1) % handles.size()]);
    }
  }
  mark_depth(triangulation);

  const bool reversed = is_reversed(projection, loops.front());
  std::vector<Loop> facets;
  for (const auto& face : triangulation.finite_face_handles()) {
    if (face->info().depth % 2 == 0) continue;
    Loop facet{*face->vertex(0)->info(), *face->vertex(1)->info(), *face->vertex(2)->info()};
    if (reversed) std::swap(facet[1], facet[2]);
    facets.push_back(std::move(facet));
  }
  return facets;
}

bool is_exactly_planar(std::span<const Loop> loops) {
  const auto point = [](const Vec3& p) { return Kernel::Point_3(p.x, p.y, p.z); };
  const auto a = point(loops[0][0]), b = point(loops[0][1]);
  auto third = loops[0].begin() + 2;
  while (third != loops[0].end() && CGAL::collinear(a, b, point(*third))) ++third;
  if (third == loops[0].end()) return true;
  const auto c = point(*third);
  return std::all_of(loops.begin(), loops.end(), [&](const Loop& loop) {
    return std::all_of(loop.begin(), loop.end(),
                       [&](const Vec3& p) { return CGAL::orientation(a, b, c, point(p)) == CGAL::COPLANAR; });
  });
}

/// Numbers of left and of right turns of a loop.
std::pair<std::size_t, std::size_t> count_turns(Projection projection, const Loop& loop) {
  std::size_t left = 0, right = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const int side = turn(projection, loop[i], loop[(i + 1) % loop.size()], loop[(i + 2) % loop.size()]);
    if (side > 0) ++left;
    if (side < 0) ++right;
  }
  return {left, right};
}

std::vector<Loop> cut_along_shorter_diagonal(const Loop& q) {
  const auto point = [](const Vec3& p) { return Kernel::Point_3(p.x, p.y, p.z); };
  const auto order = [](const Vec3& p) { return std::tuple{p.x, p.y, p.z}; };
  auto comparison = Kernel().compare_distance_3_object()(point(q[0]), point(q[2]), point(q[1]), point(q[3]));
  if (comparison == CGAL::EQUAL) {
    const bool even = std::min(order(q[0]), order(q[2])) < std::min(order(q[1]), order(q[3]));
    comparison = even ? CGAL::SMALLER : CGAL::LARGER;
  }
  if (comparison == CGAL::SMALLER) return {{q[0], q[1], q[2]}, {q[0], q[2], q[3]}};
  return {{q[1], q[2], q[3]}, {q[1], q[3], q[0]}};
}

}  // namespace

std::vector<Loop> cut_into_facets(const Polygon& polygon) {
  std::vector<Loop> loops{without_repeats(polygon.outer)};
  for (const Loop& hole : polygon.holes) loops.push_back(without_repeats(hole));
  const auto projection = largest_projection(loops[0]);
  if (!projection) return {};
  if (loops.size() == 1) {
    if (loops[0].size() == 3) return loops;
    const auto [left, right] = count_turns(*projection, loops[0]);
    if ((left == 0 || right == 0) && is_exactly_planar(loops)) return loops;
    if (loops[0].size() == 4 && (left == 4 || right == 4)) return cut_along_shorter_diagonal(loops[0]);
  }
  return triangulate(*projection, loops);
}

}  // namespace exitance
