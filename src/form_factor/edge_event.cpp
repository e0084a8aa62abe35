#include "src/form_factor/edge_event.h"

#include <algorithm>
#include <cmath>

#include "geometry/point_hash.h"

namespace exitance {
namespace {

/// Unit vectors that differ by no more are one direction.
constexpr double kTouching = 1e-9;
/// So far behind a hidden event, as a share of the side that it crosses, its effect is looked for.
constexpr double kBeyond = 1e-4;

double determinant(const Vec3& a, const Vec3& b, const Vec3& c) {
  return dot(a, cross(b, c));
}

/// f(u) = c + b u + a u² along a segment, by its values at 0, 1/2 and 1.
struct Parabola {
  double a = 0, b = 0, c = 0;

  Parabola(double f0, double f1, double f2) : a(2 * (f0 - 2 * f1 + f2)), b(-3 * f0 + 4 * f1 - f2), c(f0) {}
  Parabola(const EdgeEvent& event, const Vec3& p, const Vec3& q)
      : Parabola(event.at(p), event.at(p + 0.5 * (q - p)), event.at(q)) {}
  /// Real roots, at most two; ascending.
  std::vector<double> roots() const {
    const double root = b * b - 4 * a * c;
    if (!(root >= 0)) return {};
    const double q = -0.5 * (b + std::copysign(std::sqrt(root), b));
    std::vector<double> found;
    if (a != 0) found.push_back(q / a);
    if (q != 0) found.push_back(c / q);
    std::ranges::sort(found);
    return found;
  }
};

/// A point of a cell's boundary: at corner `side`, or on the side behind it.
struct Crossing {
  std::size_t side = 0;
  bool at_corner = false;
  Vec3 point;
};

/// Direction in which the event's curve runs through a point, in the plane of the unit vectors s and t.
Vec3 tangent_of(const EdgeEvent& event, const Vec3& x, const Vec3& s, const Vec3& t, double step) {
  const auto slope = [&](const Vec3& along) { return event.at(x + step * along) - event.at(x - step * along); };
  const double by_s = slope(s), by_t = slope(t), size = std::hypot(by_s, by_t);
  return size > 0 ? (by_t / size) * s - (by_s / size) * t : Vec3{};
}

/// The event's arc from P to Q, in a plane.
std::optional<Bend> bend_between(const EdgeEvent& event, const Vec3& P, const Vec3& Q, const Vec3& normal) {
  const Vec3 chord = Q - P, unit = normalized(normal), s = normalized(chord), t = cross(unit, s);
  const double length = norm(chord), step = 0.1 * length;
  const Vec3 at_P = tangent_of(event, P, s, t, step), at_Q = tangent_of(event, Q, s, t, step);
  if (at_P == Vec3{} || at_Q == Vec3{}) return {};
  // Sines of the angles between tangents and chord, and of that between both.
  const double slope = std::max(std::fabs(dot(at_P, t)), std::fabs(dot(at_Q, t)));
  if (slope < 1e-9) return Bend{};
  const double turn = dot(cross(at_P, at_Q), unit);
  if (std::fabs(turn) < 0.1 * slope) return {};  // both turn the same way: no arc of one branch
  const Vec3 control = P + (dot(cross(chord, at_Q), unit) / turn) * at_P, middle = P + 0.5 * chord;
  const double along = dot(control - P, s) / length;
  if (!(along > 0.05 && along < 0.95)) return {};
  if (slope < 1e-5) return Bend{control, 1};
  // At u = w / (1 + w) on the way from the middle to the control point.
  for (const double u : Parabola(event, middle, control).roots()) {
    if (u > 0.2 && u < 0.75) return Bend{control, u / (1 - u)};
  }
  return {};
}

/// Cuts a bent cell along an event that runs beside its bent side, from one of the other sides to the other.
std::vector<AreaCell> cut_beside(const AreaCell& cell, const EdgeEvent& event) {
  const Vec3 &a = cell.corner[0], &b = cell.corner[1], &c = cell.corner[2],
             &d = cell.corners == 3 ? cell.corner[2] : cell.corner[3];
  const Vec3 normal = cross(b - a, c - a) + cross(c - a, d - a);
  const auto crossing = [&](const Vec3& from, const Vec3& to) -> std::optional<Vec3> {
    std::optional<Vec3> found;
    for (const double u : Parabola(event, from, to).roots()) {
      if (u < -1e-9 || u > 1 + 1e-9) continue;
      if (found) return {};
      found = from + std::clamp(u, 0.0, 1.0) * (to - from);
    }
    return found;
  };
  const std::optional<Vec3> P = crossing(a, d), Q = crossing(b, c);
  if (!P || !Q) return {};
  constexpr int kSteps = 8;
  for (const auto& side : {first_side, opposite_side}) {
    double sign = 0;
    for (int i = 1; i < kSteps; ++i) {
      const double value = event.at(side(cell, static_cast<double>(i) / kSteps).at);
      if (value * sign < 0) return {};
      sign = value;
    }
  }
  const std::optional<Bend> bend = bend_between(event, *P, *Q, normal);
  if (!bend) return {};
  std::vector<AreaCell> cells;
  const auto add = [&](const AreaCell& part) {
    if (part.corners == 4 && part.corner[0] == part.corner[3] && part.corner[1] == part.corner[2]) return true;
    if (!is_regular(part, normal)) return false;
    cells.push_back(part);
    return true;
  };
  const AreaCell far =
      cell.corners == 3 ? AreaCell{{*P, *Q, c, *P}, 3, *bend} : AreaCell{{*P, *Q, c, d}, 4, *bend, cell.opposite};
  if (!add({{a, b, *Q, *P}, 4, cell.bend, *bend}) || !add(far)) return {};
  return cells.size() == 2 ? cells : std::vector<AreaCell>{};
}

}  // namespace

EdgeEvent::EdgeEvent(std::span<const SeenEdge, 3> edges) {
  for (std::size_t k = 0; k < 3; ++k) {
    line_[k] = {edges[k].a, edges[k].b};
    id_ += (hash_of(edges[k].a) | 1) * (hash_of(edges[k].b) | 1);  // odd, so that products tell
  }
  for (std::size_t k = 0; k < 3 && !plane_; ++k) {
    const auto &one = line_[k], &other = line_[(k + 1) % 3], &third = line_[(k + 2) % 3];
    for (const Vec3& v : one) {
      if (v != other[0] && v != other[1]) continue;
      const Vec3 n = cross(third[0] - v, third[1] - v);
      if (n != Vec3{}) plane_ = CutPlane{n, v};
    }
  }
}

double EdgeEvent::at(const Vec3& x) const {
  const auto normal = [&](std::size_t k) { return cross(line_[k][0] - x, line_[k][1] - x); };
  return determinant(normal(0), normal(1), normal(2));
}

std::vector<EdgeEvent> events_between(std::span<const SeenEdge> here, std::span<const SeenEdge> there) {
  // Where did it happen? At the shortest stretch of those whose number differs, or at the narrowest gap between two.
  const auto count = [](std::span<const SeenEdge> edges, std::uint64_t id) {
    return std::ranges::count(edges, id, &SeenEdge::id);
  };
  double smallest = 2;
  Vec3 direction;
  const auto take = [&](const Vec3& p, const Vec3& q) {
    const double apart = norm(q - p);
    if (apart < smallest) {
      smallest = apart;
      direction = 0.5 * (p + q);
    }
  };
  for (const auto& [edges, others] : {std::pair(here, there), std::pair(there, here)}) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (count(edges, edges[i].id) <= count(others, edges[i].id)) continue;
      take(edges[i].from, edges[i].to);
      for (std::size_t j = 0; j < edges.size(); ++j) {
        if (j == i || edges[j].id != edges[i].id) continue;
        take(edges[i].from, edges[j].to);
        take(edges[i].to, edges[j].from);
      }
    }
  }
  if (smallest > 1e-3) return {};
  struct Near {
    double distance;
    const SeenEdge* edge;
  };
  std::vector<Near> near;
  for (const auto& edges : {here, there}) {
    for (const SeenEdge& e : edges) {
      const double distance = std::min(norm(e.from - direction), norm(e.to - direction));
      if (distance > 4 * smallest + 1e-6) continue;
      const auto same = std::ranges::find_if(near, [&](const Near& n) { return n.edge->id == e.id; });
      if (same == near.end()) {
        near.push_back({distance, &e});
      } else {
        same->distance = std::min(same->distance, distance);
      }
    }
  }
  std::ranges::sort(near, [](const Near& a, const Near& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.edge->id < b.edge->id;
  });
  constexpr std::size_t kMost = 6;
  if (near.size() > kMost) near.resize(kMost);
  std::vector<EdgeEvent> events;
  for (std::size_t k = 2; k < near.size(); ++k) {
    for (std::size_t j = 1; j < k; ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        events.emplace_back(std::array{*near[i].edge, *near[j].edge, *near[k].edge});
      }
    }
  }
  return events;
}

std::vector<HiddenEvent> hidden_events(std::span<const SeenEdge> outline, std::span<const SeenEdge> edges,
                                       const Vec3& x, const AreaCell& cell, const std::function<bool()>& stop) {
  const auto n = static_cast<std::size_t>(cell.corners);
  const auto on_side = [&](std::size_t side, double u) {
    if (side == 0) return first_side(cell, u).at;
    if (side == 2 && n == 4) return opposite_side(cell, 1 - u).at;
    return cell.corner[side] + u * (cell.corner[(side + 1) % n] - cell.corner[side]);
  };
  // Corners, after each the middle of its side; at last x.
  std::array<Vec3, 9> places;
  Vec3 middle;
  for (std::size_t k = 0; k < n; ++k) {
    places[2 * k] = cell.corner[k];
    places[2 * k + 1] = on_side(k, 0.5);
    middle = middle + (1.0 / static_cast<double>(n)) * places[2 * k + 1];
  }
  places.back() = x;
  using Vectors = std::array<Vec3, 9>;  // at each place
  const auto normals_of = [&](const SeenEdge& e) {
    Vectors normals;
    for (std::size_t i = 0; i < places.size(); ++i) normals[i] = cross(e.a - places[i], e.b - places[i]);
    return normals;
  };
  const auto meet = [](const SeenEdge& e, const SeenEdge& g) {
    return e.a == g.a || e.a == g.b || e.b == g.a || e.b == g.b;
  };
  std::vector<Vectors> of_edges;
  of_edges.reserve(edges.size());
  for (const SeenEdge& k : edges) of_edges.push_back(normals_of(k));
  std::vector<HiddenEvent> events;
  // Where two edges of the outline cross: an end of both, as unit vector. Edges of occluders may run either way.
  const auto crossing_of = [](const SeenEdge& e, const SeenEdge& g) -> std::optional<Vec3> {
    for (const Vec3& end : {e.from, e.to}) {
      if (std::min(norm(end - g.from), norm(end - g.to)) <= kTouching) return end;
    }
    return {};
  };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const SeenEdge& e = outline[i];
    const Vectors of_e = normals_of(e);
    for (std::size_t j = i + 1; j < outline.size(); ++j) {
      const SeenEdge& g = outline[j];
      if (e.id == g.id || meet(e, g)) continue;
      const std::optional<Vec3> end = crossing_of(e, g);
      if (!end) continue;
      if (stop && stop()) return events;
      const Vectors of_g = normals_of(g);
      Vectors crossing;
      for (std::size_t p = 0; p < places.size(); ++p) crossing[p] = cross(of_e[p], of_g[p]);
      for (std::size_t k = 0; k < edges.size(); ++k) {
        if (meet(edges[k], e) || meet(edges[k], g)) continue;
        const auto value = [&](std::size_t p) { return dot(crossing[p], of_edges[k][p]); };
        const double here = value(8);
        for (std::size_t side = 0; side < n; ++side) {
          const double f0 = here * value(2 * side), f1 = here * value(2 * side + 1),
                       f2 = here * value((2 * side + 2) % (2 * n));
          if (f0 > 0 && f2 > 0 && 4 * f1 >= f0 + f2) continue;
          // Does the edge reach to where both cross, as seen from there?
          const auto reaches = [&](const Vec3& at) {
            const Vec3 d = cross(cross(e.a - at, e.b - at), cross(g.a - at, g.b - at)), to_a = edges[k].a - at,
                       to_b = edges[k].b - at, normal = cross(to_a, to_b);
            const double sign = dot(d, *end) < 0 ? -1 : 1;
            return sign * dot(cross(to_a, d), normal) >= 0 && sign * dot(cross(d, to_b), normal) >= 0;
          };
          const auto add = [&](const Vec3& beyond) {
            events.push_back({EdgeEvent(std::array{e, g, edges[k]}), beyond + 0.1 * kBeyond * (middle - beyond)});
          };
          bool crossed = false;
          for (const double u : Parabola(f0, f1, f2).roots()) {
            if (!(u > kBeyond && u < 1 - kBeyond)) continue;
            crossed = true;
            if (!reaches(on_side(side, u))) continue;
            const double slope = -3 * f0 + 4 * f1 - f2 + 4 * u * (f0 - 2 * f1 + f2);
            add(on_side(side, std::clamp(u - std::copysign(kBeyond, slope), 0.0, 1.0)));
            break;
          }
          // It may run beside the side from one corner to the other.
          if (crossed || !(f1 < -kTouching * here * here)) continue;
          const Vec3 to = places[2 * side + 1], way = to - x, half = x + 0.5 * way;
          const double at_half = here * determinant(cross(e.a - half, e.b - half), cross(g.a - half, g.b - half),
                                                    cross(edges[k].a - half, edges[k].b - half));
          for (const double u : Parabola(here * here, at_half, f1).roots()) {
            if (!(u > 0 && u < 1) || !reaches(x + u * way)) continue;
            add(to);
            break;
          }
        }
      }
    }
  }
  return events;
}

std::vector<AreaCell> cut(const AreaCell& cell, const EdgeEvent& event) {
  if (!cell.is_straight()) return cut_beside(cell, event);
  const auto loop = cell.loop();
  const std::size_t n = loop.size();
  const Vec3 normal = cross(loop[1] - loop[0], loop[2] - loop[0]);
  constexpr double kCorner = 1e-9;
  std::vector<Crossing> crossings;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 &p = loop[k], &q = loop[(k + 1) % n];
    bool at_corner = false;
    const auto roots = Parabola(event, p, q).roots();
    for (const double u : roots) at_corner = at_corner || std::fabs(u) <= kCorner;
    if (!at_corner) {
      const Vec3& before = loop[(k + n - 1) % n];
      for (const double u : Parabola(event, before, p).roots()) at_corner = at_corner || std::fabs(u - 1) <= kCorner;
    }
    if (at_corner) crossings.push_back({k, true, p});
    for (const double u : roots) {
      if (u > kCorner && u < 1 - kCorner) crossings.push_back({k, false, p + u * (q - p)});
    }
  }
  if (crossings.size() != 2) return {};
  const Crossing &one = crossings[0], &other = crossings[1];
  // Both on one side, its ends included?
  const auto on_side = [&](const Crossing& c, std::size_t k) {
    return c.side == k || (c.at_corner && c.side == (k + 1) % n);
  };
  for (std::size_t k = 0; k < n; ++k) {
    if (on_side(one, k) && on_side(other, k)) return {};
  }

  const std::optional<Bend> bend = bend_between(event, one.point, other.point, normal);
  if (!bend) return {};

  // From one crossing round the loop to the other, and back.
  std::vector<AreaCell> cells;
  for (const bool forth : {true, false}) {
    const Crossing &from = forth ? one : other, &to = forth ? other : one;
    std::vector<Vec3> between;
    for (std::size_t k = (from.side + 1) % n;; k = (k + 1) % n) {
      if (to.at_corner && k == to.side) break;
      between.push_back(loop[k]);
      if (k == to.side) break;
    }
    // Counter-clockwise: to → from along the curve, then what lies between.
    const std::size_t m = between.size();
    if (m == 0) return {};
    const Vec3 &a = to.point, &b = from.point;
    const auto curved = [&](AreaCell c) {
      c.bend = *bend;
      if (!is_regular(c, normal)) return false;
      cells.push_back(c);
      return true;
    };
    if (m == 2) {
      if (!curved({{a, b, between[0], between[1]}, 4})) return {};
      continue;
    }
    const Vec3& apex = between[m / 2];
    if (!curved({{a, b, apex, apex}, 3})) return {};
    for (std::size_t k = 0; k < m / 2; ++k) {
      cells.push_back({{k == 0 ? b : between[k - 1], between[k], apex, apex}, 3});
    }
    for (std::size_t k = m / 2 + 1; k < m; ++k) {
      cells.push_back({{between[k], k + 1 < m ? between[k + 1] : a, apex, apex}, 3});
    }
  }
  return cells;
}

}  // namespace exitance
