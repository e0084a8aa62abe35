#include "src/stress/plain_visibility.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/facets.h"

namespace exitance {
namespace {

struct Stretch {
  double lo = 0, hi = 1;
};

/// normal · v ≥ offset.
struct PlainPlane {
  Vec3 normal;
  double offset = 0;

  double value(const Vec3& v) const { return dot(normal, v) - offset; }
};

PlainPlane plane_of(const Loop& facet) {
  const Vec3 normal = area_vector(facet);
  return {normal, dot(normal, facet[0])};
}

Loop clipped(const Loop& loop, const PlainPlane& plane) {
  Loop kept;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 &p = loop[k], &q = loop[(k + 1) % loop.size()];
    const double a = plane.value(p), b = plane.value(q);
    if (a >= 0) kept.push_back(p);
    if ((a > 0 && b < 0) || (a < 0 && b > 0)) kept.push_back(p + (a / (a - b)) * (q - p));
  }
  return kept;
}

/// A convex polygon as seen from the origin, so oriented that det(p, q, v) > 0 for v inside of an edge pq.
class PlainCone {
 public:
  PlainCone(Loop loop, bool turn) : loop_(std::move(loop)) {
    if (turn) std::reverse(loop_.begin(), loop_.end());
  }
  std::size_t size() const { return loop_.size(); }
  const Vec3& from(std::size_t k) const { return loop_[k]; }
  const Vec3& to(std::size_t k) const { return loop_[(k + 1) % loop_.size()]; }
  Vec3 side(std::size_t k) const { return cross(from(k), to(k)); }
  /// Whether a corner is one of the edge's, for whose sign no arithmetic is needed.
  bool holds(std::size_t k, const Vec3& corner) const { return corner == from(k) || corner == to(k); }

 private:
  Loop loop_;
};

/// What an edge that lies on a side of a cone counts as, by whether the cone lies on its inner side, too.
enum class OnSide { within, without, within_if_alike, without_if_alike };

/// The stretch of the edge pq that lies within a cone; false: none.
bool within(const PlainCone& cone, const Vec3& p, const Vec3& q, OnSide on_side, Stretch& stretch) {
  for (std::size_t k = 0; k < cone.size(); ++k) {
    const Vec3 m = cone.side(k);
    const double a = cone.holds(k, p) ? 0 : dot(m, p), b = cone.holds(k, q) ? 0 : dot(m, q);
    if (a == 0 && b == 0) {
      const bool alike = dot(m, cross(p, q)) > 0;
      const bool is_within = on_side == OnSide::within || (on_side == OnSide::within_if_alike && alike) ||
                             (on_side == OnSide::without_if_alike && !alike);
      if (!is_within) return false;
      continue;
    }
    if (a <= 0 && b <= 0) return false;
    if (a < 0) stretch.lo = std::max(stretch.lo, a / (a - b));
    if (b < 0) stretch.hi = std::min(stretch.hi, a / (a - b));
  }
  return stretch.lo < stretch.hi;
}

/// Lambert's terms of what is left of a stretch of pq without others.
double open_sum(const Vec3& p, const Vec3& q, Stretch rest, std::vector<Stretch>& covered, const Vec3& unit_normal) {
  std::ranges::sort(covered, {}, &Stretch::lo);
  const Vec3 m = cross(p, q);
  const double length = norm(m);
  double angle = 0;
  const auto add = [&](double lo, double hi) {
    if (!(lo < hi)) return;
    const Vec3 a = p + lo * (q - p), b = p + hi * (q - p);
    angle += std::atan2(norm(cross(a, b)), dot(a, b));
  };
  for (const Stretch& c : covered) {
    add(rest.lo, std::min(c.lo, rest.hi));
    rest.lo = std::max(rest.lo, c.hi);
  }
  add(rest.lo, rest.hi);
  return length > 0 ? angle * dot(unit_normal, m) / length : 0;
}

/// The cones of what lies between the origin and the source.
std::vector<PlainCone> occluding_cones(const PointQuestion& question, const Loop& source, const PlainPlane& horizon) {
  std::vector<PlainCone> cones;
  PlainPlane near = plane_of(source);  // positive on the origin's side
  for (const Obstacle& obstacle : question.occluders) {
    for (const Polygon& face : obstacle.faces) {
      for (Loop loop : cut_into_facets(face)) {
        for (Vec3& v : loop) v = v - question.point;
        const PlainPlane plane = plane_of(loop);
        const double facing = plane.value({});
        if (facing == 0) continue;
        const bool coplanar = std::ranges::all_of(loop, [&](const Vec3& v) { return near.value(v) == 0; });
        if (coplanar && obstacle.solid && dot(plane.normal, near.normal) > 0) continue;
        if (!coplanar) loop = clipped(loop, near);
        loop = clipped(loop, horizon);
        if (loop.size() > 2) cones.emplace_back(std::move(loop), facing > 0);
      }
    }
  }
  return cones;
}

double facet_form_factor(const PointQuestion& question, Loop source) {
  const Vec3 unit_normal = normalized(question.normal);
  const PlainPlane horizon{question.normal, 0};
  for (Vec3& v : source) v = v - question.point;
  if (plane_of(source).value({}) <= 0) return 0;
  const Loop above = clipped(source, horizon);
  if (above.size() < 3) return 0;
  const PlainCone seen(above, true);
  const std::vector<PlainCone> cones = occluding_cones(question, source, horizon);
  double sum = 0;
  std::vector<Stretch> covered;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    covered.clear();
    for (const PlainCone& cone : cones) {
      Stretch stretch;
      if (within(cone, seen.from(k), seen.to(k), OnSide::within_if_alike, stretch)) covered.push_back(stretch);
    }
    sum += open_sum(seen.from(k), seen.to(k), {}, covered, unit_normal);
  }
  for (std::size_t i = 0; i < cones.size(); ++i) {
    for (std::size_t k = 0; k < cones[i].size(); ++k) {
      const Vec3 &p = cones[i].from(k), &q = cones[i].to(k);
      Stretch rest;
      if (!within(seen, p, q, OnSide::without, rest)) continue;
      covered.clear();
      for (std::size_t j = 0; j < cones.size(); ++j) {
        Stretch stretch;
        // Of edges with the occluder on the same side the first stands for all.
        const OnSide tie = j < i ? OnSide::within : OnSide::without_if_alike;
        if (j != i && within(cones[j], p, q, tie, stretch)) covered.push_back(stretch);
      }
      sum -= open_sum(p, q, rest, covered, unit_normal);
    }
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace

double plain_form_factor(const PointQuestion& question) {
  double sum = 0;
  for (const Loop& facet : cut_into_facets(question.source)) sum += facet_form_factor(question, facet);
  return sum;
}

}  // namespace exitance
