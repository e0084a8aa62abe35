#include "src/form_factor/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace exitance {
namespace {

/// Edges are in one line whose points are no farther off than this share of their distance; stretches continue each
/// other whose ends are no farther apart, as unit vectors.
constexpr double kInLine = 1e-11, kTouching = 1e-9;

bool in_one_line(const SeenEdge& e, const SeenEdge& g) {
  if (e.id == g.id) return true;
  const Vec3 along = e.b - e.a;
  return std::ranges::all_of(std::array{g.a, g.b}, [&](const Vec3& v) {
    return norm(cross(along, v - e.a)) <= kInLine * norm(along) * (norm(along) + norm(v - e.a));
  });
}

/// Stretches along the line of an edge, counted once where another edge in that line continues them.
std::ptrdiff_t stretches_along(const SeenEdge& line, std::span<const SeenEdge> edges) {
  std::vector<SeenEdge> along;
  std::ranges::copy_if(edges, std::back_inserter(along), [&](const SeenEdge& e) { return in_one_line(line, e); });
  return std::ranges::count_if(along, [&](const SeenEdge& e) {
    return std::ranges::none_of(
        along, [&](const SeenEdge& f) { return norm(f.to - e.from) <= (f.id == e.id ? 0 : kTouching); });
  });
}

}  // namespace

bool same_lines(std::span<const SeenEdge> here, std::span<const SeenEdge> there) {
  for (const auto& edges : {here, there}) {
    for (const SeenEdge& e : edges) {
      if (stretches_along(e, here) != stretches_along(e, there)) return false;
    }
  }
  return !here.empty() && !there.empty();
}

}  // namespace exitance
