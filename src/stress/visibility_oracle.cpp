#include "src/stress/visibility_oracle.h"

#include <CGAL/Polygon_set_2.h>

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <sstream>
#include <string>

#include "geometry/facets.h"
#include "src/stress/exact_polygon.h"

namespace exitance {
namespace {

using Kernel = ExactKernel;
using Rational = Kernel::FT;
using Vector = Kernel::Vector_3;
using FlatPolygon = CGAL::Polygon_2<Kernel>;
using Region = CGAL::Polygon_set_2<Kernel>;
using Real = boost::multiprecision::cpp_bin_float_100;

/// The half-spaces whose intersection is the cone from the apex over a convex loop.
std::vector<ExactSide> cone_over(const ExactLoop& loop, const ExactPoint& apex) {
  std::vector<ExactSide> sides;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const ExactPoint &p = loop[i], &q = loop[(i + 1) % loop.size()];
    if (p == q) continue;
    Vector normal = CGAL::cross_product(p - apex, q - apex);
    const bool flip =
        std::any_of(loop.begin(), loop.end(), [&](const ExactPoint& r) { return normal * (r - apex) < 0; });
    sides.push_back({apex, flip ? -normal : normal});
  }
  return sides;
}

/// Coordinates in a plane: the points of space without their coordinate `axis`.
struct Chart {
  ExactSide plane;
  int axis;

  explicit Chart(const ExactSide& p) : plane(p), axis(p.normal.x() != 0 ? 0 : p.normal.y() != 0 ? 1 : 2) {}

  Kernel::Point_2 flat(const ExactPoint& p) const { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

  ExactPoint lift(const Kernel::Point_2& p) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    Rational coordinates[3];
    coordinates[u] = p.x();
    coordinates[v] = p.y();
    coordinates[axis] = plane.origin[axis] -
                        (plane.normal[u] * (p.x() - plane.origin[u]) + plane.normal[v] * (p.y() - plane.origin[v])) /
                            plane.normal[axis];
    return {coordinates[0], coordinates[1], coordinates[2]};
  }

  /// A convex loop, counter-clockwise in the chart, without its collinear vertices; empty if it has no area.
  FlatPolygon flat(const ExactLoop& loop) const {
    std::vector<Kernel::Point_2> points;
    for (const ExactPoint& p : loop) points.push_back(flat(p));
    const auto is_corner = [](const auto& a, const auto& b, const auto& c) { return !CGAL::collinear(a, b, c); };
    for (bool changed = true; changed && points.size() > 2;) {
      changed = false;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t n = points.size();
        if (is_corner(points[(i + n - 1) % n], points[i], points[(i + 1) % n])) continue;
        points.erase(points.begin() + static_cast<std::ptrdiff_t>(i));
        changed = true;
        break;
      }
    }
    FlatPolygon polygon;
    if (points.size() < 3) return polygon;
    for (const auto& p : points) polygon.push_back(p);
    if (polygon.is_clockwise_oriented()) polygon.reverse_orientation();
    return polygon;
  }
};

Real real(const Rational& number) {
  std::ostringstream stream;
  stream << number.exact();
  const std::string text = stream.str();
  const auto slash = text.find('/');
  if (slash == std::string::npos) return Real(text);
  return Real(text.substr(0, slash)) / Real(text.substr(slash + 1));
}

struct RealVector {
  Real x, y, z;
};

RealVector real(const Vector& v) {
  return {real(v.x()), real(v.y()), real(v.z())};
}
Real dot(const RealVector& a, const RealVector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
RealVector cross(const RealVector& a, const RealVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Lambert's sum around a loop: Σ θ (n · m), m the unit normal of the plane through the point and an edge.
Real contour_sum(const FlatPolygon& loop, const Chart& chart, const ExactPoint& x, const RealVector& unit_normal) {
  std::vector<RealVector> rays;
  for (const auto& p : loop.container()) rays.push_back(real(chart.lift(p) - x));
  Real sum = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const RealVector &a = rays[i], &b = rays[(i + 1) % rays.size()];
    const RealVector across = cross(a, b);
    const Real length = sqrt(dot(across, across));
    if (length != 0) sum += atan2(length, dot(a, b)) * dot(unit_normal, across) / length;
  }
  return sum;
}

/// An occluder facet's shadow on the source, as a convex loop in the source's plane.
ExactLoop shadow(const ExactLoop& facet, const ExactSide& source_plane, const std::vector<ExactSide>& cone,
                 const ExactPoint& x) {
  if (exact_plane(facet).value(x) == 0) return {};
  ExactLoop between = clipped(facet, source_plane);
  for (const ExactSide& side : cone) between = clipped(between, side);
  // Within the cone every point is nearer to the source's plane than x, so it projects to a finite one.
  const Rational height = source_plane.value(x);
  for (ExactPoint& p : between) p = x + (height / (height - source_plane.value(p))) * (p - x);
  return between;
}

bool covers(const ExactLoop& facet, bool solid, const ExactSide& source_plane) {
  return !solid || exact_plane(facet).normal * source_plane.normal < 0;
}

/// What the occluders hide of the source's plane within the cone over the source.
Region hidden_part(const ExactLoop& source, const Chart& chart, const ExactPoint& x,
                   const std::vector<Obstacle>& occluders) {
  const ExactSide& plane = chart.plane;
  const auto cone = cone_over(source, x);
  std::vector<FlatPolygon> shadows;
  for (const Obstacle& occluder : occluders) {
    for (const Polygon& face : occluder.faces) {
      for (const Loop& loop : cut_into_facets(face)) {
        const ExactLoop facet = exact_loop(loop);
        const bool coplanar =
            std::all_of(facet.begin(), facet.end(), [&](const ExactPoint& p) { return plane.value(p) == 0; });
        if (coplanar && !covers(facet, occluder.solid, plane)) continue;
        const FlatPolygon flat = chart.flat(coplanar ? facet : shadow(facet, plane, cone, x));
        if (!flat.is_empty()) shadows.push_back(flat);
      }
    }
  }
  Region hidden;
  hidden.join(shadows.begin(), shadows.end());
  return hidden;
}

/// Of a region of a facet's plane, seen from x.
struct Measure {
  Real contour = 0;        ///< 2 π F
  Real area = 0;           ///< [m²]
  Rational flat_area = 0;  ///< in the chart
};

Measure measure(const Region& region, const Chart& chart, const ExactPoint& x, const RealVector& unit_normal) {
  // Counter-clockwise in the chart is so from the front, too, if the normal points up the chart's axis; seen from there
  // the rotation is against the one Lambert's sum counts as positive.
  const int side = chart.plane.normal[chart.axis] > 0 ? -1 : 1;
  const RealVector facet_normal = real(chart.plane.normal);
  const Real stretch = sqrt(dot(facet_normal, facet_normal)) / abs(real(chart.plane.normal[chart.axis]));
  Measure sum;
  std::vector<CGAL::Polygon_with_holes_2<Kernel>> parts;
  region.polygons_with_holes(std::back_inserter(parts));
  const auto add = [&](const FlatPolygon& loop) {  // holes are clockwise
    sum.contour += side * contour_sum(loop, chart, x, unit_normal);
    sum.flat_area += loop.area();
  };
  for (const auto& part : parts) {
    add(part.outer_boundary());
    for (const FlatPolygon& hole : part.holes()) add(hole);
  }
  sum.area = stretch * real(sum.flat_area);
  return sum;
}

}  // namespace

OracleAnswer oracle_form_factor(const PointQuestion& given) {
  // CGAL's intervals overflow from 1e100 on. Powers of two round nothing.
  const auto [question, exponent] = scaled_near_one(given);
  const ExactPoint x = exact_point(question.point);
  const Vector normal = exact_point(question.normal) - CGAL::ORIGIN;
  RealVector unit_normal = real(normal);
  const Real length = sqrt(dot(unit_normal, unit_normal));
  unit_normal = {unit_normal.x / length, unit_normal.y / length, unit_normal.z / length};

  Real contour = 0, area = 0, open_contour = 0;
  bool is_all_seen = true;
  for (const Loop& loop : cut_into_facets(question.source)) {
    const ExactLoop facet = exact_loop(loop);
    const Chart chart(exact_plane(facet));
    if (chart.plane.value(x) <= 0) continue;
    const ExactLoop above = clipped(facet, {x, normal});
    const FlatPolygon source = chart.flat(above);
    if (source.is_empty()) continue;
    Region visible(source);
    const Measure open = measure(visible, chart, x, unit_normal);
    visible.difference(hidden_part(above, chart, x, question.occluders));
    const Measure seen = measure(visible, chart, x, unit_normal);
    is_all_seen = is_all_seen && seen.flat_area == open.flat_area;
    open_contour += open.contour;
    contour += seen.contour;
    area += seen.area;
  }
  const Real turn = 2 * boost::math::constants::pi<Real>();
  return {Real(contour / turn).convert_to<long double>(), std::ldexp(area.convert_to<long double>(), 2 * exponent),
          Real(open_contour / turn).convert_to<long double>(), is_all_seen};
}

}  // namespace exitance
