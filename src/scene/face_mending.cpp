#include "src/scene/face_mending.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace exitance {
namespace {

using Loop = std::vector<Vec3>;

// Counts faces of one kind and remembers where the first one stands.
struct Tally {
  std::size_t count = 0;
  std::string first;

  void add(const Scene& scene, const Surface& surface) {
    if (count++ > 0) return;
    const std::string& file = scene.objects[surface.object].file;
    first = surface.line > 0 ? fmt::format("{}:{}", file, surface.line) : file;
  }
};

// The loops between repeated visits of a point, those of fewer than three vertices left out.
std::vector<Loop> cut_at_repeats(const Loop& loop) {
  std::vector<Loop> loops;
  Loop open;
  const auto close = [&](Loop::iterator from) {
    if (open.end() - from >= 3) loops.emplace_back(from, open.end());
  };
  for (const Vec3& p : loop) {
    const auto visited = std::ranges::find(open, p);
    if (visited != open.end()) {
      close(visited);
      open.erase(visited, open.end());
    }
    open.push_back(p);
  }
  close(open.begin());
  return loops;
}

// Polygons made of the loops; none where they do not add up to polygons.
std::optional<std::vector<Polygon>> assemble(std::vector<Loop> loops, const Vec3& area) {
  std::vector<Polygon> polygons;
  std::vector<Loop> holes;
  for (Loop& loop : loops) {
    if (dot(area_vector(loop), area) < 0) {
      holes.push_back(std::move(loop));
    } else {
      polygons.push_back({std::move(loop), {}});
    }
  }
  if (polygons.empty() || (!holes.empty() && polygons.size() > 1)) return std::nullopt;
  polygons.front().holes = std::move(holes);
  std::erase_if(polygons,
                [](const Polygon& p) { return p.holes.empty() && find_defect(p) == PolygonDefect::zero_area; });
  const bool sound =
      std::ranges::all_of(polygons, [](const Polygon& p) { return find_defect(p) == PolygonDefect::none; });
  return sound ? std::optional(std::move(polygons)) : std::nullopt;
}

std::vector<Polygon> fan(const Loop& loop) {
  std::vector<Polygon> triangles;
  for (std::size_t i = 2; i < loop.size(); ++i) {
    Polygon triangle{{loop[0], loop[i - 1], loop[i]}, {}};
    if (find_defect(triangle) == PolygonDefect::none) triangles.push_back(std::move(triangle));
  }
  return triangles;
}

std::vector<Polygon> mend(const Loop& loop) {
  if (auto polygons = assemble(cut_at_repeats(loop), area_vector(loop))) return std::move(*polygons);
  return fan(loop);
}

}  // namespace

void mend_faces(Scene& scene) {
  Tally mended, flat;
  std::vector<Surface> surfaces;
  surfaces.reserve(scene.surfaces.size());
  for (Surface& surface : scene.surfaces) {
    const PolygonDefect defect = find_defect(surface.polygon);
    if (defect == PolygonDefect::zero_area) flat.add(scene, surface);
    if (defect != PolygonDefect::self_intersecting) {
      surfaces.push_back(std::move(surface));
      continue;
    }
    mended.add(scene, surface);
    for (Polygon& piece : mend(surface.polygon.outer)) {
      Surface part = surface;
      part.polygon = std::move(piece);
      surfaces.push_back(std::move(part));
    }
  }
  scene.surfaces = std::move(surfaces);
  if (mended.count > 0) {
    scene.warnings.push_back(
        fmt::format("{}: {} faces whose boundary crosses or touches itself were cut into simple ones "
                    "(this is the first)",
                    mended.first, mended.count));
  }
  if (flat.count > 0) {
    scene.warnings.push_back(
        fmt::format("{}: {} faces have no area and count for nothing (this is the first)", flat.first, flat.count));
  }
}

}  // namespace exitance
