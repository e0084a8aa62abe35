#include "geometry/viewpoint.h"

#include <algorithm>
#include <boost/multiprecision/mpfr.hpp>
#include <optional>
#include <stdexcept>

#include "geometry/lambert.h"
#include "geometry/visible_region.h"

namespace exitance {
namespace {

/// 80 decimal digits, 266 bits.
using Extended = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<80, boost::multiprecision::allocate_stack>, boost::multiprecision::et_off>;

/// Whether a point, by identity in the facet's plane, lies in the facet's interior: exact in the projection along the largest
/// component of the normal.
bool holds(const PolygonSoup& soup, const Facet& f, const Vec3& x, StageCounts& counts) {
  const Vec3 n = f.plane.normal;
  const int axis = std::fabs(n.x) >= std::fabs(n.y) && std::fabs(n.x) >= std::fabs(n.z) ? 0
                   : std::fabs(n.y) >= std::fabs(n.z)                                   ? 1
                                                                                        : 2;
  const auto loop = soup.corners(f);
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3& a = soup.vertices()[loop[k].vertex];
    const Vec3& b = soup.vertices()[loop[(k + 1) % loop.size()].vertex];
    Vec3 p = a, q = b, v = x, above = a;  // three points in the projection plane and one on the normal's side of it
    p[axis] = q[axis] = v[axis] = 0;
    above[axis] = n[axis] > 0 ? 1 : -1;
    if (orientation(p, q, v, above, counts) <= 0) return false;
  }
  return true;
}

}  // namespace

struct Viewpoint::State {
  struct FacetView {
    std::uint32_t epoch = 0;
    std::int8_t facing = 0;  // side of the facet that is seen; 0: edge-on, or it can hide nothing from here
  };
  struct VertexView {
    std::uint32_t epoch = 0;
    std::int8_t horizon = 0;
  };
  /// What stands between the point and a facet, kept while pieces of the same facet are asked about.
  struct Candidates {
    std::uint32_t facet = kNone;
    bool blocked = false;
    std::vector<std::uint32_t> occluders;
  };

  explicit State(const PolygonSoup& s)
      : soup(s), facet_view(s.facets().size()), vertex_view(s.vertices().size()), region(s, counts), fine(s, counts) {}

  bool excluded(std::uint32_t facet) const;
  int facing(std::uint32_t facet);
  int horizon(std::uint32_t vertex);
  template <class Real>
  VisibleRegion<Real>& region_of();
  template <class Real>
  bool set_source(std::uint32_t facet, int source_facing);
  template <class Real>
  typename VisibleRegion<Real>::Effect add_occluder(std::uint32_t source_facet, std::uint32_t facet);
  bool find_candidates(std::uint32_t facet);
  bool prepare(const Source& source, int& source_facing);
  bool put_occluders(const Source& source, int source_facing);
  template <class Real>
  bool add_candidates(std::uint32_t facet);
  template <class Real>
  PointFormFactor sum(PointFormFactor result);

  const PolygonSoup& soup;
  Receiver receiver;
  StageCounts counts;
  std::uint64_t extended = 0;
  std::uint32_t epoch = 0;
  std::vector<FacetView> facet_view;
  std::vector<VertexView> vertex_view;
  VisibleRegion<double> region;
  VisibleRegion<Extended> fine;
  Candidates candidates;
  std::vector<const Vec3*> corners;
  std::vector<int> horizons;
  std::vector<HalfSpace> half_spaces;
  std::vector<std::uint32_t> found;
  bool is_covered = false;
};

bool Viewpoint::State::excluded(std::uint32_t facet) const {
  if (receiver.facet == kNone) return false;
  if (facet == receiver.facet) return true;  // facets of the same polygon that is bent see each other
  const auto coplanar = soup.coplanar(receiver.facet);
  return std::binary_search(coplanar.begin(), coplanar.end(), facet);
}

/// The side from which an occluding facet is seen. Back faces of a shell hide nothing from a point outside its box
/// that its front faces do not hide: they count as edge-on. (The box is grown, because a point that lies in a contact by
/// identity may be rounded out of it.)
int Viewpoint::State::facing(std::uint32_t facet) {
  FacetView& view = facet_view[facet];
  if (view.epoch != epoch) {
    view.epoch = epoch;
    const Facet& f = soup.facets()[facet];
    view.facing = 0;
    if (!excluded(facet)) {
      view.facing = static_cast<std::int8_t>(side_of(f.plane, receiver.point, counts));
      if (view.facing < 0 && f.shell != kNone && !soup.shells()[f.shell].contains(receiver.point, 0x1p-40 * soup.extent())) view.facing = 0;
    }
  }
  return view.facing;
}

int Viewpoint::State::horizon(std::uint32_t vertex) {
  VertexView& view = vertex_view[vertex];
  if (view.epoch != epoch) {
    view.epoch = epoch;
    view.horizon =
        static_cast<std::int8_t>(horizon_side(receiver.point, receiver.normal, soup.vertices()[vertex], counts));
  }
  return view.horizon;
}

template <>
VisibleRegion<double>& Viewpoint::State::region_of() {
  return region;
}
template <>
VisibleRegion<Extended>& Viewpoint::State::region_of() {
  return fine;
}

template <class Real>
bool Viewpoint::State::set_source(std::uint32_t facet, int source_facing) {
  return region_of<Real>().set_source(receiver.point, receiver.normal, soup.facets()[facet].plane, source_facing, corners,
                                      horizons);
}

template <class Real>
typename VisibleRegion<Real>::Effect Viewpoint::State::add_occluder(std::uint32_t source_facet, std::uint32_t facet) {
  const auto facets = soup.facets();
  const std::uint32_t source_polygon = facets[source_facet].polygon;
  const Facet& f = facets[facet];
  const int side = facing(facet);
  if (side == 0 || f.polygon == source_polygon) return VisibleRegion<Real>::Effect::none;
  const auto coplanar = soup.coplanar(source_facet);
  const bool covers =
      std::binary_search(coplanar.begin(), coplanar.end(), facet) && soup.covers(facet, source_facet);
  const auto loop = soup.corners(f);
  // An edge whose neighbour faces the same way bounds nothing. Where an occluder lies in the source's plane, its neighbour
  // may dive behind that plane: there only pieces of the same polygon carry on.
  const auto bounds = [&](std::uint32_t k) {
    const std::uint32_t n = loop[k].neighbour;
    if (n == kNone || facets[n].polygon == source_polygon) return true;
    if (covers && facets[n].polygon != f.polygon) return true;
    return facing(n) != side;
  };
  return region_of<Real>().add_occluder(facet, side, covers, bounds, [&](std::uint32_t v) { return horizon(v); });
}

/// Looks for everything that hides something of the current source from the point; false when all of it is hidden.
bool Viewpoint::State::find_candidates(std::uint32_t facet) {
  // Half-spaces that hold all that can lie between: the source's cone and the near side of its plane. |v − x| and |v| are at
  // most `reach` within the scene; each offset is lowered by the errors of the normal and of both products.
  const double reach = 4 * std::fmax(soup.extent(), std::fmax(std::fabs(receiver.point.x),
                                                              std::fmax(std::fabs(receiver.point.y),
                                                                        std::fabs(receiver.point.z))));
  half_spaces.clear();
  for (const auto& side : region.source().sides) {
    const Vec3 m{side.m.x, side.m.y, side.m.z};
    half_spaces.push_back({m, dot(m, receiver.point) - (side.error + 16 * kRoundoff * side.length) * reach});
  }
  const Plane& plane = soup.facets()[facet].plane;
  const Vec3 normal = side_of(plane, receiver.point, counts) * plane.normal;
  half_spaces.push_back({receiver.normal, dot(receiver.normal, receiver.point) -
                                              16 * kRoundoff * norm(receiver.normal) * reach});
  half_spaces.push_back(
      {normal, dot(normal, plane.origin) - (2 * plane.normal_error + 16 * kRoundoff * norm(plane.normal)) * reach});
  found.clear();
  soup.index().find(half_spaces, found);

  candidates.facet = facet;
  candidates.blocked = false;
  candidates.occluders.clear();
  for (const std::uint32_t t : found) {
    const auto effect = add_occluder<double>(facet, t);
    if (effect == VisibleRegion<double>::Effect::none) continue;
    candidates.occluders.push_back(t);
    if (effect == VisibleRegion<double>::Effect::whole) {
      candidates.blocked = true;
      return false;
    }
  }
  return true;
}

/// Sets corners and their horizon signs; false when nothing of the source can be seen.
bool Viewpoint::State::prepare(const Source& source, int& source_facing) {
  const Facet& f = soup.facets()[source.facet];
  source_facing = excluded(source.facet) ? 0 : side_of(f.plane, receiver.point, counts);
  if (source_facing == 0) return false;
  corners.clear();
  horizons.clear();
  if (source.loop.empty()) {
    for (const Corner& c : soup.corners(f)) {
      corners.push_back(&soup.vertices()[c.vertex]);
      horizons.push_back(horizon(c.vertex));
    }
  } else {
    for (const Vec3& v : source.loop) {
      corners.push_back(&v);
      horizons.push_back(horizon_side(receiver.point, receiver.normal, v, counts));
    }
  }
  return std::any_of(horizons.begin(), horizons.end(), [](int s) { return s > 0; });
}

/// Adds the candidates to the current source; false when they hide all of it.
template <class Real>
bool Viewpoint::State::add_candidates(std::uint32_t facet) {
  for (const std::uint32_t t : candidates.occluders) {
    if (add_occluder<Real>(facet, t) == VisibleRegion<Real>::Effect::whole) return false;
  }
  return true;
}

/// Lambert's sum over what is visible of the current source.
template <class Real>
PointFormFactor Viewpoint::State::sum(PointFormFactor result) {
  auto& r = region_of<Real>();
  LambertSum<Real> lambert(receiver.normal);
  r.for_each_arc([&](const Arc<Real>& arc) { lambert.add(arc); });
  result.visibility = r.occluder_count() == 0 ? Visibility::open
                      : lambert.arcs() == 0   ? Visibility::blocked
                                              : Visibility::partial;
  // What does not exceed its own error is 0 as far as can be told. A true form factor is never negative, so that raising to
  // 0 only removes error.
  const Real value = lambert.value(), error = lambert.error();
  if (value > error) {
    result.F = static_cast<double>(value);
    result.error = static_cast<double>(error) * (1 + 4 * kRoundoff) + 2 * kRoundoff * result.F;
  } else {
    result.F = 0;
    result.error = static_cast<double>(value > 0 ? Real(value + error) : error) * (1 + 4 * kRoundoff);
  }
  return result;
}

/// Sets the current source, prepared, and adds its occluders; false when they hide all of it. The candidates of a facet are
/// looked for once for all its pieces.
bool Viewpoint::State::put_occluders(const Source& source, int source_facing) {
  if (candidates.facet == source.facet) {
    set_source<double>(source.facet, source_facing);
    return !candidates.blocked && add_candidates<double>(source.facet);
  }
  if (source.loop.empty()) {
    set_source<double>(source.facet, source_facing);
    return find_candidates(source.facet);
  }
  candidates.facet = source.facet;
  candidates.blocked = false;
  candidates.occluders.clear();
  int facet_facing = 0;
  if (prepare({source.facet, {}}, facet_facing)) {
    set_source<double>(source.facet, facet_facing);
    find_candidates(source.facet);
  }
  prepare(source, source_facing);
  set_source<double>(source.facet, source_facing);
  return !candidates.blocked && add_candidates<double>(source.facet);
}

Viewpoint::Viewpoint(const PolygonSoup& soup) : state_(std::make_unique<State>(soup)) {}
Viewpoint::~Viewpoint() = default;
Viewpoint::Viewpoint(Viewpoint&&) noexcept = default;
Viewpoint& Viewpoint::operator=(Viewpoint&&) noexcept = default;

void Viewpoint::look_from(const Receiver& receiver) {
  if (!is_finite(receiver.point)) throw std::invalid_argument("receiver point: a coordinate is not a finite number");
  if (!is_finite(receiver.normal) || receiver.normal == Vec3{}) {
    throw std::invalid_argument("receiver normal: zero or not finite");
  }
  State& s = *state_;
  s.receiver = receiver;
  s.candidates.facet = kNone;
  if (++s.epoch == 0) {
    for (auto& v : s.facet_view) v.epoch = 0;
    for (auto& v : s.vertex_view) v.epoch = 0;
    s.epoch = 1;
  }
  s.is_covered = false;
  if (receiver.facet == kNone) return;
  for (const std::uint32_t t : s.soup.coplanar(receiver.facet)) {
    if (s.soup.covers(t, receiver.facet) && holds(s.soup, s.soup.facets()[t], receiver.point, s.counts)) {
      s.is_covered = true;
    }
  }
}

bool Viewpoint::covered() const { return state_->is_covered; }

PointFormFactor Viewpoint::form_factor(const Source& source, double tolerance) {
  State& s = *state_;
  PointFormFactor result;
  int source_facing = 0;
  const bool above = s.prepare(source, source_facing);
  result.side = source_facing > 0 ? Side::front : source_facing < 0 ? Side::back : Side::edge_on;
  if (!above) return result;
  if (s.is_covered) {
    result.visibility = Visibility::blocked;
    return result;
  }
  if (!s.put_occluders(source, source_facing)) {
    result.visibility = Visibility::blocked;
    return result;
  }
  const PointFormFactor plain = s.sum<double>(result);
  if (plain.error <= tolerance) return plain;
  ++s.extended;
  s.set_source<Extended>(source.facet, source_facing);
  s.add_candidates<Extended>(source.facet);
  const PointFormFactor fine = s.sum<Extended>(result);
  return fine.error < plain.error ? fine : plain;
}

std::vector<BoundaryPiece> Viewpoint::visible_region(const Source& source) {
  State& s = *state_;
  std::vector<BoundaryPiece> pieces;
  int source_facing = 0;
  if (s.is_covered || !s.prepare(source, source_facing) || !s.put_occluders(source, source_facing)) return pieces;
  // Near the point of view a direction must be known far better than the point where it meets the source's plane.
  s.set_source<Extended>(source.facet, source_facing);
  s.add_candidates<Extended>(source.facet);
  const PlanePoints& plane = s.soup.facets()[source.facet].plane.points;
  const auto normal = cross(difference<Extended>(*plane.b, *plane.a), difference<Extended>(*plane.c, *plane.a));
  const Extended height = dot(normal, difference<Extended>(*plane.a, s.receiver.point));
  s.fine.for_each_arc([&](const Arc<Extended>& arc) {
    if (!(arc.t0 < arc.t1)) return;
    const auto& p = arc.cone->corners[arc.side->from].w;
    const auto e = arc.cone->corners[arc.side->to].w - p;
    const auto point = [&](const Extended& t) {
      const auto w = p + t * e;
      const Extended scale = arc.of_source ? Extended(1) : Extended(height / dot(normal, w));
      return Vec3{static_cast<double>(s.receiver.point.x + scale * w.x), static_cast<double>(s.receiver.point.y + scale * w.y),
                  static_cast<double>(s.receiver.point.z + scale * w.z)};
    };
    // The region lies to the left of the direction whose normal with x points to it: out of an occluder's cone.
    const bool towards_cone = dot(cross(p, e), arc.side->m) < 0;
    const Vec3 from = point(arc.t0), to = point(arc.t1);
    pieces.push_back(towards_cone == arc.of_source ? BoundaryPiece{from, to, arc.of_source}
                                                   : BoundaryPiece{to, from, arc.of_source});
  });
  return pieces;
}

const StageCounts& Viewpoint::stage_counts() const { return state_->counts; }
std::uint64_t Viewpoint::extended_count() const { return state_->extended; }

double area(std::span<const BoundaryPiece> region) {
  if (region.empty()) return 0;
  const Vec3 o = region.front().from;
  Vec3 sum;
  for (const BoundaryPiece& p : region) sum = sum + cross(p.from - o, p.to - o);
  return 0.5 * norm(sum);
}

}  // namespace exitance
