#include "src/stress/property.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/facets.h"
#include "src/stress/stage.h"

namespace exitance {
namespace {

using Forms = std::vector<PointQuestion>;

template <class Change>
void change_loops(Polygon& polygon, const Change& change) {
  change(polygon.outer);
  for (Loop& hole : polygon.holes) change(hole);
}

template <class Change>
void change_points(PointQuestion& question, const Change& change) {
  const auto change_all = [&](Loop& loop) { std::ranges::for_each(loop, change); };
  change(question.point);
  change_loops(question.source, change_all);
  for (Obstacle& obstacle : question.occluders) {
    for (Polygon& face : obstacle.faces) change_loops(face, change_all);
  }
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

// --- Forms --------------------------------------------------------------------------------------------------------

Forms permuted(const PointQuestion& question, Random& random) {
  if (question.occluders.size() < 2) return {};
  PointQuestion form = question;
  shuffle(form.occluders, random);
  for (Obstacle& obstacle : form.occluders) shuffle(obstacle.faces, random);
  return {form};
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

/// One sheet cut in two, from the middle of an edge where that is a point of doubles.
Forms split(const PointQuestion& question, Random& random) {
  PointQuestion form = question;
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

Forms duplicated(const PointQuestion& question, Random& random) {
  if (question.occluders.empty()) return {};
  PointQuestion form = question;
  form.occluders.push_back(question.occluders[pick(question.occluders.size(), random)]);
  return {form};
}

Forms turned_over(const PointQuestion& question, Random&) {
  PointQuestion form = question;
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

Forms triangulated(const PointQuestion& question, Random&) {
  PointQuestion form = question;
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

/// A solid differs from its faces only where one of them lies in the source's plane.
Forms as_sheets(const PointQuestion& question, Random&) {
  PointQuestion form = question;
  bool any = false;
  const auto source = cut_into_facets(question.source);
  for (Obstacle& obstacle : form.occluders) {
    if (!obstacle.solid) continue;
    for (const Polygon& face : obstacle.faces) {
      for (const Loop& facet : cut_into_facets(face)) {
        for (const Loop& of_source : source) {
          if (lies_in_plane_of(of_source, facet)) return {};
        }
      }
    }
    obstacle.solid = false;
    any = true;
  }
  return any ? Forms{form} : Forms{};
}

Forms scaled(const PointQuestion& question, Random& random) {
  PointQuestion form = question;
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

Forms translated(const PointQuestion& question, Random& random) {
  double extent = 0;
  PointQuestion form = question;
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

Forms renumbered(const PointQuestion& question, Random& random) {
  PointQuestion form = question;
  const auto rotate = [&](Polygon& polygon) {
    if (!is_cut_alike(polygon)) return;
    change_loops(polygon, [&](Loop& loop) {
      std::ranges::rotate(loop, loop.begin() + static_cast<std::ptrdiff_t>(pick(loop.size(), random)));
    });
  };
  rotate(form.source);
  for (Obstacle& obstacle : form.occluders) std::ranges::for_each(obstacle.faces, rotate);
  return {form};
}

/// One more triangle, with corners half way from the point to corners of the others, or at them.
Forms added(const PointQuestion& question, Random& random) {
  std::vector<Vec3> corners = question.source.outer;
  for (const Obstacle& obstacle : question.occluders) {
    for (const Polygon& face : obstacle.faces) corners.insert(corners.end(), face.outer.begin(), face.outer.end());
  }
  Loop triangle;
  for (int k = 0; k < 3; ++k) {
    const Vec3& v = corners[pick(corners.size(), random)];
    triangle.push_back(random.whole(0, 1) == 0 ? v : v - 0.5 * (v - question.point));
  }
  PointQuestion form = question;
  form.occluders.push_back({{{triangle, {}}}, false});
  return {form};
}

Forms pieces(const PointQuestion& question, Random&) {
  const auto triangles = triangles_of(question.source);
  if (triangles.size() < 2) return {};
  Forms forms;
  for (const Polygon& triangle : triangles) {
    forms.push_back(question);
    forms.back().source = triangle;
  }
  return forms;
}

// --- Judgement ----------------------------------------------------------------------------------------------------

PropertyTrial same(const Opinion& opinion, std::span<const Opinion> of_forms) {
  return {std::fabs(opinion.F - of_forms[0].F), opinion.margin + of_forms[0].margin};
}

PropertyTrial same_bits(const Opinion& opinion, std::span<const Opinion> of_forms) {
  return {std::fabs(opinion.F - of_forms[0].F) + std::fabs(opinion.margin - of_forms[0].margin), 0};
}

PropertyTrial not_more(const Opinion& opinion, std::span<const Opinion> of_forms) {
  return {std::fmax(0, of_forms[0].F - opinion.F), opinion.margin + of_forms[0].margin};
}

PropertyTrial sum(const Opinion& opinion, std::span<const Opinion> of_forms) {
  double total = 0, margins = opinion.margin;
  for (const Opinion& part : of_forms) {
    total += part.F;
    margins += part.margin + kRoundoff * total;
  }
  return {std::fabs(opinion.F - total), margins};
}

}  // namespace

std::span<const Property> properties() {
  static const std::array kProperties{Property{"permuted", "occluders in another order", permuted, same},
                                      Property{"split", "a sheet cut in two", split, same},
                                      Property{"duplicated", "an occluder twice", duplicated, same},
                                      Property{"reversed", "all sheets turned over", turned_over, same},
                                      Property{"triangulated", "all occluders as triangles", triangulated, same},
                                      Property{"as_sheets", "the faces of solids by themselves", as_sheets, same},
                                      Property{"scaled", "scaled by a power of two: the same bits", scaled, same_bits},
                                      Property{"translated", "moved without rounding", translated, same},
                                      Property{"renumbered", "polygons from another vertex on", renumbered, same},
                                      Property{"added", "one more occluder never raises F", added, not_more},
                                      Property{"pieces", "triangles of the source sum to the whole", pieces, sum}};
  return kProperties;
}

std::optional<PropertyTrial> try_property(const Property& property, const PointQuestion& question,
                                          const Opinion& opinion, const AskPoint& ask, Random& random) {
  const Forms forms = property.forms(question, random);
  if (forms.empty()) return std::nullopt;
  std::vector<Opinion> opinions;
  for (const PointQuestion& form : forms) opinions.push_back(ask(form));
  return property.judge(opinion, opinions);
}

PropertyTrial try_closure(const PointQuestion& question) {
  PointQuestion scene = scaled_near_one(question).question;
  Vec3 low = scene.point, high = low;
  change_points(scene, [&](const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::fmin(low[axis], v[axis]);
      high[axis] = std::fmax(high[axis], v[axis]);
    }
  });
  const double room = 0.125 * std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] -= room;
    high[axis] += room;
  }
  QuestionScene patches;
  for (Polygon wall : box(low, high).faces) {
    std::ranges::reverse(wall.outer);
    patches.add(wall, Role::patch, "room");
  }
  patches.add(scene.source, Role::patch, "source");
  for (const Obstacle& obstacle : scene.occluders) {
    for (const Polygon& face : obstacle.faces) patches.add(face, Role::patch, "occluder");
  }
  const PolygonSoup soup(patches.polygons, patches.roles);
  Viewpoint view(soup);
  view.look_from({scene.point, scene.normal});
  double sum = 0;
  PropertyTrial trial;
  for (std::uint32_t f = 0; f < soup.facets().size(); ++f) {
    const PointFormFactor part = view.form_factor({f, {}});
    sum += part.F;
    trial.allowed += part.error + kRoundoff * sum;
  }
  trial.defect = std::fabs(sum - 1);
  return trial;
}

}  // namespace exitance
