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

/// Stretches along the line of an edge, counted once where another edge in that line continues them, and none that have
/// no length. Where edges of other lines end, too, two parts of what is seen only touch: seen from beside there, the
/// stretches are apart or one.
std::ptrdiff_t stretches_along(const SeenEdge& line, std::span<const SeenEdge> edges) {
  std::vector<SeenEdge> along, others;
  for (const SeenEdge& e : edges) (in_one_line(line, e) ? along : others).push_back(e);
  const auto touches = [](const Vec3& p, const Vec3& q) { return norm(p - q) <= kTouching; };
  return std::ranges::count_if(along, [&](const SeenEdge& e) {
    if (e.from == e.to) return false;
    const bool continues =
        std::ranges::any_of(along, [&](const SeenEdge& f) { return f.id != e.id && touches(f.to, e.from); });
    return !continues || std::ranges::any_of(others, [&](const SeenEdge& g) {
      return touches(g.from, e.from) || touches(g.to, e.from);
    });
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
