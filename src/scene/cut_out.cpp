#include "src/scene/cut_out.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace exitance {
namespace {

using Loop = std::vector<Vec3>;

struct ByCoordinates {
  bool operator()(const Vec3& a, const Vec3& b) const { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }
};

// The loops of the base (as it is) and of the parts (turned round), with vertices that are meant to be one made one.
std::vector<Loop> joined_loops(const Polygon& base, std::span<const Polygon> parts, double tolerance) {
  std::vector<Loop> loops{base.outer};
  for (const Polygon& part : parts) {
    Loop loop(part.outer.rbegin(), part.outer.rend());
    for (Vec3& p : loop) {
      const auto is_near = [&](const Vec3& q) { return norm(q - p) <= tolerance; };
      for (const Loop& earlier : loops) {
        if (const auto found = std::ranges::find_if(earlier, is_near); found != earlier.end()) {
          p = *found;
          break;
        }
      }
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

// Where along a → b the point lies (0 to 1), if it lies on it and is none of the ends.
std::optional<double> position_on(const Vec3& a, const Vec3& b, const Vec3& p, double tolerance) {
  if (p == a || p == b) return std::nullopt;
  const double along = dot(p - a, b - a) / dot(b - a, b - a);
  if (!(along > 0 && along < 1) || norm(a + along * (b - a) - p) > tolerance) return std::nullopt;
  return along;
}

// Directed edges, of which two in opposite directions cancel.
class Boundary {
 public:
  // False where an edge is there twice.
  bool add(const Vec3& from, const Vec3& to) {
    if (from == to) return true;
    const auto [first, last] = edges_.equal_range(to);
    const auto opposite = std::find_if(first, last, [&](const auto& edge) { return edge.second == from; });
    if (opposite != last) {
      edges_.erase(opposite);
      return true;
    }
    const auto [same, end] = edges_.equal_range(from);
    if (std::any_of(same, end, [&](const auto& edge) { return edge.second == to; })) return false;
    edges_.emplace(from, to);
    return true;
  }

  // The edges joined end to end; none where it is not clear which follows which.
  std::optional<std::vector<Loop>> loops() {
    std::vector<Loop> found;
    while (!edges_.empty()) {
      Loop loop;
      const Vec3 start = edges_.begin()->first;
      Vec3 at = start;
      do {
        const auto next = edges_.find(at);
        if (next == edges_.end() || edges_.count(at) > 1) return std::nullopt;
        loop.push_back(at);
        at = next->second;
        edges_.erase(next);
      } while (at != start);
      found.push_back(std::move(loop));
    }
    return found;
  }

 private:
  std::multimap<Vec3, Vec3, ByCoordinates> edges_;  // from, to
};

std::optional<std::vector<Loop>> remaining_loops(const std::vector<Loop>& loops, double tolerance) {
  Boundary boundary;
  for (const Loop& loop : loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
      std::vector<std::pair<double, Vec3>> stops;
      for (const Loop& other : loops) {
        if (&other == &loop) continue;
        for (const Vec3& p : other) {
          if (const auto along = position_on(a, b, p, tolerance)) stops.emplace_back(*along, p);
        }
      }
      std::ranges::stable_sort(stops, {}, &std::pair<double, Vec3>::first);
      Vec3 from = a;
      for (const auto& [along, p] : stops) {
        if (!boundary.add(from, p)) return std::nullopt;
        from = p;
      }
      if (!boundary.add(from, b)) return std::nullopt;
    }
  }
  return boundary.loops();
}

}  // namespace

std::optional<std::vector<Polygon>> cut_out(const Polygon& base, std::span<const Polygon> parts, double tolerance) {
  const auto loops = remaining_loops(joined_loops(base, parts, tolerance), tolerance);
  if (!loops) return std::nullopt;

  std::vector<Polygon> polygons;
  std::vector<Loop> holes;
  const Vec3 front = area_vector(base);
  for (const Loop& loop : *loops) {
    if (dot(area_vector(loop), front) > 0) {
      polygons.push_back({loop, {}});
    } else {
      holes.push_back(loop);
    }
  }
  for (const Loop& hole : holes) {
    const auto around = std::ranges::find_if(polygons, [&](const Polygon& polygon) {
      return find_defect(Polygon{polygon.outer, {hole}}) == PolygonDefect::none;
    });
    if (around == polygons.end()) return std::nullopt;
    around->holes.push_back(hole);
  }
  const bool sound =
      std::ranges::all_of(polygons, [](const Polygon& polygon) { return find_defect(polygon) == PolygonDefect::none; });
  return sound ? std::optional(std::move(polygons)) : std::nullopt;
}

}  // namespace exitance
