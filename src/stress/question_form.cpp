#include "src/stress/question_form.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace exitance {
namespace {

template <class Change>
void change_loops(Polygon& polygon, const Change& change) {
  change(polygon.outer);
  for (Loop& hole : polygon.holes) change(hole);
}

/// Exactly: in all three projections along an axis.
bool are_collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 p = a, q = b, r = c;
    p[axis] = q[axis] = r[axis] = 0;
    Vec3 above = p;
    above[axis] = 1;
    if (orientation_exact(p, q, r, above) != 0) return false;
  }
  return true;
}

bool lies_in_plane_of(const Loop& facet, const Loop& loop) {
  const Vec3 &a = facet[0], &b = facet[1];
  const auto c = std::ranges::find_if(facet, [&](const Vec3& v) { return !are_collinear(a, b, v); });
  return std::ranges::all_of(loop, [&](const Vec3& v) { return orientation_exact(a, b, *c, v) == 0; });
}

/// None of a receiver that there is not.
std::vector<Loop> facets_of(const Polygon& polygon) {
  return polygon.outer.empty() ? std::vector<Loop>{} : cut_into_facets(polygon);
}

/// Whether a polygon is cut the same way whatever vertex comes first and whichever side is front (facets.h).
bool is_cut_alike(const Polygon& face) {
  if (face.outer.size() <= 4 && face.holes.empty()) return true;
  const auto facets = cut_into_facets(face);
  return facets.empty() || lies_in_plane_of(facets[0], face.outer);
}

Loop fan_triangle(const Loop& loop, std::size_t k) {
  return {loop[0], loop[k - 1], loop[k]};
}

std::vector<Polygon> triangles_of(const Polygon& polygon) {
  std::vector<Polygon> triangles;
  for (const Loop& facet : cut_into_facets(polygon)) {
    for (std::size_t k = 2; k < facet.size(); ++k) triangles.push_back({fan_triangle(facet, k), {}});
  }
  return triangles;
}

template <class T>
void shuffle(std::vector<T>& items, Random& random) {
  for (std::size_t k = items.size(); k > 1; --k) {
    std::swap(items[k - 1], items[static_cast<std::size_t>(random.whole(0, static_cast<int>(k) - 1))]);
  }
}

std::size_t pick(std::size_t count, Random& random) {
  return static_cast<std::size_t>(random.whole(0, static_cast<int>(count) - 1));
}

/// a + b where that needs no rounding.
std::optional<double> exact_sum(double a, double b) {
  const double sum = a + b, of_b = sum - a;
  if (!std::isfinite(sum) || (a - (sum - of_b)) + (b - of_b) != 0) return std::nullopt;
  return sum;
}

std::optional<Vec3> exact_middle(const Vec3& a, const Vec3& b) {
  Vec3 middle;
  for (int axis = 0; axis < 3; ++axis) {
    const auto sum = exact_sum(a[axis], b[axis]);
    if (!sum || 2 * (*sum / 2) != *sum) return std::nullopt;
    middle[axis] = *sum / 2;
  }
  return middle;
}

}  // namespace

Forms permuted(const Question& question, Random& random) {
  if (question.occluders.size() < 2) return {};
  Question form = question;
  shuffle(form.occluders, random);
  for (Obstacle& obstacle : form.occluders) shuffle(obstacle.faces, random);
  return {form};
}

Forms split(const Question& question, Random& random) {
  Question form = question;
  std::vector<std::size_t> order(form.occluders.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  shuffle(order, random);
  for (const std::size_t o : order) {
    if (form.occluders[o].solid) continue;
    for (Polygon& face : form.occluders[o].faces) {
      const auto facets = cut_into_facets(face);
      if (facets.size() != 1) continue;
      Loop loop = facets[0];
      const std::size_t n = loop.size(), first = pick(n, random);
      for (std::size_t k = 0; k < n; ++k) {
        std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(k == 0 ? first : 1), loop.end());
        const auto middle = exact_middle(loop[0], loop[1]);
        if (!middle) continue;
        const auto opposite = static_cast<std::ptrdiff_t>(n == 3 ? 2 : 2 + pick(n - 2, random));
        Loop one{*middle}, other{*middle};
        one.insert(one.end(), loop.begin() + 1, loop.begin() + opposite + 1);
        other.insert(other.end(), loop.begin() + opposite, loop.end());
        other.push_back(loop[0]);
        face = {std::move(one), {}};
        form.occluders.push_back({{{std::move(other), {}}}, false});
        return {form};
      }
    }
  }
  return {};
}

Forms duplicated(const Question& question, Random& random) {
  if (question.occluders.empty()) return {};
  Question form = question;
  form.occluders.push_back(question.occluders[pick(question.occluders.size(), random)]);
  return {form};
}

Forms reversed_sheets(const Question& question, Random&) {
  Question form = question;
  bool any = false;
  for (Obstacle& obstacle : form.occluders) {
    if (obstacle.solid) continue;
    for (Polygon& face : obstacle.faces) {
      if (!is_cut_alike(face)) continue;
      std::ranges::reverse(face.outer);
      any = true;
    }
  }
  return any ? Forms{form} : Forms{};
}

Forms triangulated(const Question& question, Random&) {
  Question form = question;
  std::size_t before = 0, after = 0;
  for (Obstacle& obstacle : form.occluders) {
    std::vector<Polygon> triangles;
    for (const Polygon& face : obstacle.faces) {
      const auto of_face = triangles_of(face);
      triangles.insert(triangles.end(), of_face.begin(), of_face.end());
    }
    before += obstacle.faces.size();
    after += triangles.size();
    obstacle.faces = std::move(triangles);
  }
  return before != after ? Forms{form} : Forms{};
}

Forms as_sheets(const Question& question, Random&) {
  Question form = question;
  bool any = false;
  auto ends = facets_of(question.source);
  const auto receiver = facets_of(question.receiver);
  ends.insert(ends.end(), receiver.begin(), receiver.end());
  for (Obstacle& obstacle : form.occluders) {
    if (!obstacle.solid) continue;
    for (const Polygon& face : obstacle.faces) {
      for (const Loop& facet : cut_into_facets(face)) {
        for (const Loop& end : ends) {
          if (lies_in_plane_of(end, facet)) return {};
        }
      }
    }
    obstacle.solid = false;
    any = true;
  }
  return any ? Forms{form} : Forms{};
}

Forms scaled(const Question& question, Random& random) {
  Question form = question;
  const int exponent = random.whole(-300, 300), of_normal = random.whole(-300, 300);
  bool is_exact = true;
  const auto scale = [&](Vec3& v, int by) {
    const Vec3 before = v;
    v = ExactScale::scaled(v, -by);
    is_exact = is_exact && is_finite(v) && ExactScale::scaled(v, by) == before;
  };
  change_points(form, [&](Vec3& v) { scale(v, exponent); });
  scale(form.normal, of_normal);
  return is_exact ? Forms{form} : Forms{};
}

Forms translated(const Question& question, Random& random) {
  double extent = 0;
  Question form = question;
  change_points(form, [&](Vec3& v) { extent = std::max({extent, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); });
  const int exponent = extent > 0 ? std::ilogb(extent) : 0;
  for (const int bits : {20, 8, 4, 2}) {
    Vec3 by;
    for (int axis = 0; axis < 3; ++axis) by[axis] = std::ldexp(random.whole(-1000, 1000), exponent - bits);
    form = question;
    bool is_exact = true;
    change_points(form, [&](Vec3& v) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto sum = exact_sum(v[axis], by[axis]);
        is_exact = is_exact && sum;
        v[axis] = sum.value_or(0);
      }
    });
    if (is_exact) return {form};
  }
  return {};
}

Forms renumbered(const Question& question, Random& random) {
  Question form = question;
  const auto rotate = [&](Polygon& polygon) {
    if (!is_cut_alike(polygon)) return;
    change_loops(polygon, [&](Loop& loop) {
      const auto first = static_cast<std::ptrdiff_t>(pick(loop.size(), random));
      std::rotate(loop.begin(), loop.begin() + first, loop.end());
    });
  };
  rotate(form.source);
  if (!form.receiver.outer.empty()) rotate(form.receiver);
  for (Obstacle& obstacle : form.occluders) std::ranges::for_each(obstacle.faces, rotate);
  return {form};
}

Forms added(const Question& question, Random& random) {
  std::vector<Vec3> corners = question.source.outer;
  for (const Obstacle& obstacle : question.occluders) {
    for (const Polygon& face : obstacle.faces) corners.insert(corners.end(), face.outer.begin(), face.outer.end());
  }
  Loop triangle;
  for (int k = 0; k < 3; ++k) {
    const Vec3& v = corners[pick(corners.size(), random)];
    triangle.push_back(random.whole(0, 1) == 0 ? v : v - 0.5 * (v - question.point));
  }
  Question form = question;
  form.occluders.push_back({{{triangle, {}}}, false});
  return {form};
}

Forms pieces(const Question& question, Random&) {
  const auto triangles = triangles_of(question.source);
  const auto facets = cut_into_facets(question.source);
  if (triangles.size() < 2) return {};
  if (!question.receiver.outer.empty() && !lies_in_plane_of(facets[0], question.source.outer)) return {};
  Forms forms;
  for (const Polygon& triangle : triangles) {
    forms.push_back(question);
    forms.back().source = triangle;
  }
  return forms;
}

Forms swapped(const Question& question, Random&) {
  Question form = question;
  std::swap(form.receiver, form.source);
  return {form};
}

}  // namespace exitance
