#include "geometry/viewpoint.h"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "geometry/extended.h"
#include "geometry/lambert.h"
#include "geometry/point_hash.h"
#include "geometry/visible_region.h"

namespace exitance {
namespace {

constexpr std::uint64_t kHorizon = 1;
/// The same for an edge from either end.
std::uint64_t id_of(const ViewPlane& side) {
  switch (side.kind) {
    case ViewPlane::Kind::edge:
      return mixed_bits(hash_of(*side.c) + hash_of(*side.d));
    case ViewPlane::Kind::horizon:
      return 1;
    case ViewPlane::Kind::cut:
      return mixed_bits(hash_of(*side.T->a) + 3 * hash_of(*side.T->b) + 5 * hash_of(*side.T->c));
  }
  return 0;
}

/// [rad] Shorter stretches of edges come and go by rounding; of others the ends are known to a sixteenth of that
/// (answer).
constexpr double kShortest = 1e-10;

/// Ends of a stretch, as unit vectors from the point of view.
using Ends = std::pair<Vec3, Vec3>;
Ends ends_of(const Arc<double>& arc) {
  const auto p = arc.cone->corners.w(arc.side->from), e = arc.cone->corners.w(arc.side->to) - p;
  const auto direction = [&](double t) {
    const Vec3 w{p.x + t * e.x, p.y + t * e.y, p.z + t * e.z};
    return (1 / norm(w)) * w;
  };
  return {direction(arc.t0), direction(arc.t1)};
}

/// Whether a stretch lies along the horizon, where which edge bounds is a matter of rounding, or in the sliver above it
/// that a gap of rounding opens beside an edge in contact.
bool is_level(const Ends& ends, const Vec3& normal) {
  constexpr double kLevel = 1e-9;  // sine
  const double highest = kLevel * norm(normal);
  return std::fabs(dot(ends.first, normal)) <= highest && std::fabs(dot(ends.second, normal)) <= highest;
}

/// How many chains stretches form that follow each other end to end, each from its first to its second end. Those that
/// go round a sliver end where they began, and are none.
std::int64_t chains(std::span<const Ends> stretches) {
  const auto meet = [](const Vec3& p, const Vec3& q) { return norm(p - q) <= kShortest; };
  std::int64_t begun = 0;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const Vec3& p = stretches[i].first;
    const auto begins = [&](const Ends& s) { return meet(s.first, p); };
    const auto ends = [&](const Ends& s) { return meet(s.second, p); };
    if (std::ranges::any_of(stretches.first(i), begins)) continue;  // counted there
    begun +=
        std::max<std::int64_t>(0, std::ranges::count_if(stretches, begins) - std::ranges::count_if(stretches, ends));
  }
  return begun;
}

/// Two points of the line in which planes meet, given by a point and a normal each.
std::pair<Vec3, Vec3> line_of(const Vec3& p, const Vec3& n, const Vec3& q, const Vec3& m) {
  const Vec3 d = cross(n, m);
  const double size = dot(d, d);
  // Both planes through p + v: n·v = 0, m·v = m·(q − p).
  const Vec3 at = p + (dot(m, q - p) / size) * cross(d, n);
  return {at, at + (1 / std::sqrt(size)) * d};
}

}  // namespace

struct Viewpoint::State {
  static constexpr std::size_t kRecentBlockers = 4;
  /// A shell of which this part of the facets is found is taken by its silhouette.
  static constexpr std::size_t kFacetsOfSilhouette = 16;

  /// What stands between the point and a facet, kept while pieces of the same facet are asked about.
  struct Candidates {
    std::uint32_t facet = kNone;
    bool blocked = false;
    std::vector<OccluderId> occluders;
    std::vector<std::uint32_t> facets;  // that will_add_only
  };

  explicit State(const PolygonSoup& s)
      : soup(s), view(s), region(view), fine(view), finest(view), in_silhouette(s.shells().size(), 0) {}

  template <class Real>
  VisibleRegion<Real>& region_of();
  template <class Real>
  bool set_source(std::uint32_t facet, int source_facing) {
    return region_of<Real>().set_source(facet, source_facing, corners, horizons, dropped ? &*dropped : nullptr);
  }
  bool add_candidate(const OccluderId& occluder);
  bool hidden_by_recent();
  bool find_candidates(std::uint32_t facet);
  void bound_across_axes(double reach);
  bool add_flush_faces(std::uint32_t facet);
  bool add_items(std::span<const std::uint32_t> items);
  void choose_silhouettes();
  void forget_silhouettes() {
    for (const std::uint32_t s : by_silhouette) in_silhouette[s] = 0;
    by_silhouette.clear();
  }
  bool is_of_silhouette(std::uint32_t facet) const {
    const std::uint32_t shell = soup.first_corners(facet).shell;
    return shell != kNone && in_silhouette[shell] != 0;
  }
  bool prepare(const Source& source, int& source_facing);
  void find_drop(const Source& source);
  int horizon_of_piece(std::size_t corner);
  bool put_occluders(const Source& source, int source_facing);
  Candidates& candidates_of(std::uint32_t facet) { return recent[facet % recent.size()]; }
  template <class Real>
  bool add_candidates(std::uint32_t facet);
  bool put_items(const Source& source, int source_facing, std::span<const std::uint32_t> items);
  template <class Real>
  PointFormFactor sum(PointFormFactor result);
  template <class Real>
  void sum_again(const Source& source, int source_facing, PointFormFactor& result);
  template <class Put>
  PointFormFactor answer(const Source& source, double tolerance, const Put& put);

  const PolygonSoup& soup;
  View view;
  std::uint64_t extended = 0;
  double hidden_value = 0;  // of the last sum, when its own error hides it
  bool tells_outline = false;
  std::uint64_t outline = 0;  // of the last answer
  std::vector<Ends> level;    // stretches along the horizon
  VisibleRegion<double> region;
  VisibleRegion<long double> fine;
  VisibleRegion<Extended> finest;
  std::array<Candidates, 4> recent;  // the facets of a polygon take turns
  std::vector<OccluderId> blockers;  // of this view, the latest first
  std::vector<const Vec3*> corners;
  std::vector<int> horizons;
  ViewFrame frame;  // of the source that is prepared, if it is a piece
  std::vector<double> heights;
  std::optional<Drop> dropped;  // if its corners lie in its plane up to rounding only
  std::vector<HalfSpace> half_spaces;
  std::vector<std::uint32_t> found, left;    // items, and those that do not miss the source at a glance
  std::vector<std::uint32_t> by_silhouette;  // shells
  std::vector<std::uint32_t> in_silhouette;  // by shell: not 0 for those
};

template <>
VisibleRegion<double>& Viewpoint::State::region_of() {
  return region;
}
template <>
VisibleRegion<long double>& Viewpoint::State::region_of() {
  return fine;
}
template <>
VisibleRegion<Extended>& Viewpoint::State::region_of() {
  return finest;
}

/// Adds an occluder to the current source; false when it hides all of it.
bool Viewpoint::State::add_candidate(const OccluderId& occluder) {
  const auto effect = region.add(occluder);
  Candidates& candidates = candidates_of(region.source_facet());
  if (effect != VisibleRegion<double>::Effect::none) candidates.occluders.push_back(occluder);
  candidates.blocked = effect == VisibleRegion<double>::Effect::whole;
  if (candidates.blocked) {
    if (blockers.size() == kRecentBlockers) blockers.pop_back();
    blockers.insert(blockers.begin(), occluder);
  }
  return !candidates.blocked;
}

/// Whether one of the occluders that hid the last hidden sources hides all of the current source, too. They are likely
/// to when sources that follow each other lie close together.
bool Viewpoint::State::hidden_by_recent() {
  for (std::size_t k = 0; k < blockers.size(); ++k) {
    const OccluderId blocker = blockers[k];
    if (!region.stands_before_the_middle(blocker)) continue;
    if (blocker.shell != kNone &&
        region.place_of(soup.shells()[blocker.shell]) != VisibleRegion<double>::Place::in_front) {
      continue;
    }
    if (region.hides(blocker)) {
      std::rotate(blockers.begin(), blockers.begin() + static_cast<std::ptrdiff_t>(k),
                  blockers.begin() + static_cast<std::ptrdiff_t>(k) + 1);
      return true;
    }
  }
  return false;
}

/// Adds half-spaces that hold the way to the source in its shadow along each axis, a wedge unless the point's own
/// shadow lies within that of the source. No side of the cone need be near these planes, and only such as hold an axis
/// keep a box away that a thin cone passes by at a slant.
///
/// The corners are a whole facet's, pieces take what is found for theirs. The normal as rounded is the normal, so that
/// only signs of heights count: u of each difference, of each product and of the sum make one that is found ≥ 0 truly
/// ≥ −3 u |n|₁ |v − x|, |v − x| ≤ reach / 2. n · x adds 2 u |n|₁ reach / 4 and the subtraction u |n|₁ reach / 4: well
/// under 16 u together.
void Viewpoint::State::bound_across_axes(double reach) {
  const Vec3 x = view.receiver().point;
  for (const int axis : {0, 1, 2}) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (const double turn : {1.0, -1.0}) {
      Vec3 normal;
      const auto height = [&](const Vec3* v) { return normal[b] * ((*v)[b] - x[b]) + normal[c] * ((*v)[c] - x[c]); };
      for (const Vec3* v : corners) {
        if (height(v) >= 0 && normal != Vec3{}) continue;
        normal = Vec3{};
        normal[b] = -turn * ((*v)[c] - x[c]);
        normal[c] = turn * ((*v)[b] - x[b]);
      }
      if (!std::ranges::all_of(corners, [&](const Vec3* v) { return height(v) >= 0; })) continue;
      const double size = std::fabs(normal[b]) + std::fabs(normal[c]);
      half_spaces.push_back({normal, dot(normal, x) - 16 * kRoundoff * size * reach});
    }
  }
}

/// Looks for everything that hides something of the current source from the point; false when all of it is hidden.
bool Viewpoint::State::find_candidates(std::uint32_t facet) {
  if (hidden_by_recent()) {
    candidates_of(facet).blocked = true;
    return false;
  }
  // Half-spaces that hold all that can lie between: the source's cone and the near side of its plane. |v − x| and |v|
  // are at most `reach` within the scene; each offset is lowered by the errors of the normal and of both products.
  const double reach =
      4 * std::fmax(soup.extent(),
                    std::fmax(std::fabs(view.receiver().point.x),
                              std::fmax(std::fabs(view.receiver().point.y), std::fabs(view.receiver().point.z))));
  half_spaces.clear();
  for (const auto& side : region.source().sides) {
    const Vec3 m{side.m.x, side.m.y, side.m.z};
    half_spaces.push_back({m, dot(m, view.receiver().point) - (side.error + 16 * kRoundoff * side.length) * reach});
  }
  bound_across_axes(reach);
  const Plane& plane = soup.facets()[facet].plane;
  const Vec3 normal = side_of(plane, view.receiver().point, view.counts()) * plane.normal;
  half_spaces.push_back({view.receiver().normal, dot(view.receiver().normal, view.receiver().point) -
                                                     16 * kRoundoff * norm(view.receiver().normal) * reach});
  half_spaces.push_back({normal, dot(normal, plane.origin) -
                                     (2 * plane.normal_error + 16 * kRoundoff * norm(plane.normal)) * reach -
                                     norm(plane.normal) * soup.pile()});
  Box box;
  box.extend(view.receiver().point);
  for (const Vec3* v : corners) box.extend(*v);
  if (!add_flush_faces(facet)) return false;
  found.clear();
  soup.index().find(half_spaces, box.grown(soup.pile()), found);
  soup.prefetch_corners(found);
  choose_silhouettes();
  return std::ranges::all_of(by_silhouette,
                             [&](std::uint32_t s) {
                               return add_candidate({kNone, s});
                             }) &&
         add_items(found);
}

/// Chooses the shells of which many facets were found, to be taken by their silhouettes; their facets are then not
/// asked for. A source's own shell lies on both sides of its plane, or not in front of it at all.
void Viewpoint::State::choose_silhouettes() {
  forget_silhouettes();
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  const std::uint32_t own = soup.facets()[region.source_facet()].shell;
  for (const std::uint32_t item : found) {
    const std::uint32_t shell = item < facets ? soup.first_corners(item).shell : kNone;
    if (shell != kNone && shell != own && in_silhouette[shell]++ == 0) by_silhouette.push_back(shell);
  }
  std::erase_if(by_silhouette, [&](std::uint32_t s) {
    const Shell& shell = soup.shells()[s];
    const bool is_taken = kFacetsOfSilhouette * in_silhouette[s] >= shell.facets.size() && view.outside(shell) &&
                          region.place_of(shell) == VisibleRegion<double>::Place::in_front && region.has_silhouette(s);
    in_silhouette[s] = 0;
    return !is_taken;
  });
  for (const std::uint32_t s : by_silhouette) in_silhouette[s] = 1;
}

/// What lies in the source's plane covers it without reaching in front of it: of a convex shell on the far side, which
/// is passed by as a whole, one face does. False when it hides all of the source.
bool Viewpoint::State::add_flush_faces(std::uint32_t facet) {
  for (const std::uint32_t t : soup.coplanar(facet)) {
    const std::uint32_t shell = soup.facets()[t].shell;
    if (shell != kNone && soup.shells()[shell].convex && !add_candidate({t, kNone})) return false;
  }
  return true;
}

/// Adds items of the index; false when they hide all of the current source.
bool Viewpoint::State::add_items(std::span<const std::uint32_t> items) {
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  left.clear();
  for (const std::uint32_t item : items) {
    if (item >= facets || (!is_of_silhouette(item) && !region.misses(item))) left.push_back(item);
  }
  for (const std::uint32_t item : left) {
    if (item < facets) view.prefetch(item);
  }
  for (const std::uint32_t item : left) {
    if (item < facets) {
      if (!add_candidate({item, kNone})) return false;
      continue;
    }
    const Shell& shell = soup.shells()[item - facets];
    const Facet& source = soup.facets()[region.source_facet()];
    if (source.shell == item - facets && view.side(region.source_facet()) > 0) continue;  // convex, it lies behind
    const auto place = region.place_of(shell);
    if (place == VisibleRegion<double>::Place::nowhere) continue;
    if (place == VisibleRegion<double>::Place::in_front && view.outside(shell)) {
      if (!add_candidate({kNone, item - facets})) return false;
      continue;
    }
    for (const std::uint32_t f : shell.facets) {
      if (!region.misses(f) && !add_candidate({f, kNone})) return false;
    }
  }
  return true;
}

/// Sets corners and their horizon signs; false when nothing of the source can be seen.
bool Viewpoint::State::prepare(const Source& source, int& source_facing) {
  const Facet& f = soup.facets()[source.facet];
  source_facing = view.excluded(source.facet) ? 0 : side_of(f.plane, view.receiver().point, view.counts());
  if (source_facing == 0) return false;
  // From outside a solid no back face of it can be seen.
  if (source_facing < 0 && f.shell != kNone && view.outside(soup.shells()[f.shell])) return false;
  corners.clear();
  horizons.clear();
  dropped.reset();
  if (source.loop.empty()) {
    for (const Corner& c : soup.corners(f)) {
      corners.push_back(&soup.vertices()[c.vertex]);
      horizons.push_back(view.horizon(c.vertex));
    }
  } else {
    for (const Vec3& v : source.loop) corners.push_back(&v);
    find_drop(source);
    for (std::size_t k = 0; k < corners.size(); ++k) horizons.push_back(horizon_of_piece(k));
  }
  return std::any_of(horizons.begin(), horizons.end(), [](int s) { return s > 0; });
}

/// Finds how far the corners of a piece lie off its facet's plane. Along an axis they are dropped onto it exactly,
/// which only arithmetic that is exact need do. Those of a facet so narrow that double precision does not know its
/// normal are left where they are.
void Viewpoint::State::find_drop(const Source& source) {
  const Plane& plane = soup.facets()[source.facet].plane;
  const auto in_plane_at_sight = [&](const Vec3& v) {
    return plane.axis >= 0 && v[plane.axis] == plane.origin[plane.axis];
  };
  if (std::ranges::all_of(source.loop, in_plane_at_sight) || !(plane.normal_size > 4 * plane.normal_error)) return;
  const Vec3& n = plane.normal;
  frame = {view.receiver().point, view.receiver().normal, plane.points};
  while (std::fabs(n[frame.axis]) < plane.normal_size) ++frame.axis;
  frame.axis_sign = n[frame.axis] > 0 ? 1 : -1;
  // n · (v − o): the normal is wrong by at most √3 normal_error; u of each component of the difference, three
  // roundings.
  heights.assign((source.loop.size() + kLanes - 1) / kLanes * kLanes, 0);
  for (std::size_t k = 0; k < source.loop.size(); ++k) {
    const Vec3 w = source.loop[k] - plane.origin;
    heights[k] = (std::fabs(dot(n, w)) + (1.8 * plane.normal_error + 6 * kRoundoff * norm(n)) * norm(w)) /
                 (plane.normal_size - plane.normal_error) * 1.01;
  }
  dropped.emplace(Drop{frame, heights});
}

/// On which side of the horizon a corner of the prepared piece lies.
int Viewpoint::State::horizon_of_piece(std::size_t corner) {
  const Receiver& r = view.receiver();
  const Vec3& v = *corners[corner];
  if (!dropped) return horizon_side(r.point, r.normal, v, view.counts());
  const Vec3 w = v - r.point;
  const double value = dot(r.normal, w), bound = norm(r.normal) * (5 * kRoundoff * norm(w) + 1.01 * heights[corner]);
  if (value > bound || value < -bound) return value > 0 ? 1 : -1;
  return exact_value_at(frame, {ViewPlane::Kind::horizon}, {ViewPoint::Kind::vertex, true, 0, &v, nullptr},
                        view.counts())
      .sign;
}

/// Adds the candidates to the current source; false when they hide all of it.
template <class Real>
bool Viewpoint::State::add_candidates(std::uint32_t facet) {
  if (!candidates_of(facet).facets.empty()) region_of<Real>().will_add_only(candidates_of(facet).facets);
  for (const OccluderId& occluder : candidates_of(facet).occluders) {
    if (region_of<Real>().add(occluder) == VisibleRegion<Real>::Effect::whole) return false;
  }
  return true;
}

/// Lambert's sum over what is visible of the current source.
template <class Real>
PointFormFactor Viewpoint::State::sum(PointFormFactor result) {
  auto& r = region_of<Real>();
  LambertSum<Real> lambert(view.receiver().normal);
  level.clear();
  if (std::is_same_v<Real, double>) outline = 0;
  r.for_each_arc([&](const Arc<Real>& arc) {
    const Real angle = lambert.add(arc);
    if constexpr (std::is_same_v<Real, double>) {
      if (!tells_outline || !(angle > kShortest)) return;
      if (const Ends ends = ends_of(arc); is_level(ends, view.receiver().normal)) {
        const bool forth = (arc.cone->turn > 0) == arc.of_source;
        level.push_back(forth ? ends : Ends{ends.second, ends.first});
      } else {
        outline += id_of(arc.side->exact);
      }
    }
  });
  if (!level.empty()) outline += kHorizon * static_cast<std::uint64_t>(chains(level));
  result.visibility = r.occluder_count() == 0 ? Visibility::open
                      : lambert.arcs() == 0   ? Visibility::blocked
                                              : Visibility::partial;
  // What does not exceed its own error is 0 as far as can be told. A true form factor is never negative, so that
  // raising to 0 only removes error.
  const Real value = lambert.value(), error = lambert.error();
  hidden_value = value > 0 && value <= error ? static_cast<double>(value) : 0;
  if (value > error) {
    result.F = static_cast<double>(value);
    result.error = static_cast<double>(error) * (1 + 4 * kRoundoff) + 2 * kRoundoff * result.F;
  } else {
    result.F = 0;
    result.error = static_cast<double>(value > 0 ? Real(value + error) : error) * (1 + 4 * kRoundoff);
  }
  return result;
}

/// Sets the current source, prepared, and adds its occluders; false when they hide all of it. The candidates of a facet
/// are looked for once for all its pieces.
bool Viewpoint::State::put_occluders(const Source& source, int source_facing) {
  Candidates& candidates = candidates_of(source.facet);
  if (candidates.facet != source.facet) {
    candidates.facet = source.facet;
    candidates.blocked = false;
    candidates.occluders.clear();
    candidates.facets.clear();
    if (source.loop.empty()) {
      set_source<double>(source.facet, source_facing);
      return find_candidates(source.facet);
    }
    int facet_facing = 0;
    if (prepare({source.facet, {}}, facet_facing)) {
      set_source<double>(source.facet, facet_facing);
      find_candidates(source.facet);
    } else {
      candidates.blocked = true;
    }
    for (const OccluderId& o : candidates.occluders) {
      if (o.shell == kNone) candidates.facets.push_back(o.facet);
    }
    std::ranges::sort(candidates.facets);
    prepare(source, source_facing);
  }
  set_source<double>(source.facet, source_facing);
  return !candidates.blocked && add_candidates<double>(source.facet);
}

/// Sets the current source, prepared, and adds the items; false when they hide all of it.
bool Viewpoint::State::put_items(const Source& source, int source_facing, std::span<const std::uint32_t> items) {
  Candidates& candidates = candidates_of(source.facet);
  candidates.facet = kNone;  // what is kept here holds for this piece only
  candidates.occluders.clear();
  candidates.facets.assign(items.begin(), items.end());
  set_source<double>(source.facet, source_facing);
  region.will_add_only(items);
  forget_silhouettes();
  return add_flush_faces(source.facet) && add_items(items);
}

/// `put` puts what may hide something of the source, prepared and seen from the side it is told; false: all is hidden.
template <class Put>
PointFormFactor Viewpoint::State::answer(const Source& source, double tolerance, const Put& put) {
  // Of one arc's end nearly all of the tolerance is borne at first: few are known so badly.
  region.set_bearable_angle(std::clamp(tolerance, 0x1p-46, kShortest / 16));
  PointFormFactor result;
  outline = 0;
  int source_facing = 0;
  const bool above = prepare(source, source_facing);
  result.side = source_facing > 0 ? Side::front : source_facing < 0 ? Side::back : Side::edge_on;
  if (!above) return result;
  if (view.covered() || !put(source_facing)) {
    result.visibility = Visibility::blocked;
    return result;
  }
  result = sum<double>(result);
  // All values that are given as 0 err the same way: they must not add up.
  const auto is_good = [&] { return result.error <= tolerance && hidden_value <= tolerance / 1024; };
  if (is_good()) return result;
  region.set_bearable_angle(std::clamp(tolerance / 16, 0x1p-46, kShortest / 16));
  sum_again<double>(source, source_facing, result);
  if (is_good()) return result;
  ++extended;
  sum_again<long double>(source, source_facing, result);
  if (!is_good()) sum_again<Extended>(source, source_facing, result);
  return result;
}

/// Sums once more with more digits, over the candidates that were found; keeps what was known better before.
template <class Real>
void Viewpoint::State::sum_again(const Source& source, int source_facing, PointFormFactor& result) {
  set_source<Real>(source.facet, source_facing);
  add_candidates<Real>(source.facet);
  const PointFormFactor again = sum<Real>(result);
  if (again.error < result.error) result = again;
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
  state_->view.look_from(receiver);
  for (auto& candidates : state_->recent) candidates.facet = kNone;
  state_->blockers.clear();
}

bool Viewpoint::covered() const {
  return state_->view.covered();
}

PointFormFactor Viewpoint::form_factor(const Source& source, double tolerance) {
  state_->tells_outline = false;
  return state_->answer(source, tolerance, [&](int facing) { return state_->put_occluders(source, facing); });
}

PointFormFactor Viewpoint::form_factor(const Source& source, std::span<const std::uint32_t> items, double tolerance) {
  state_->tells_outline = true;
  return state_->answer(source, tolerance, [&](int facing) { return state_->put_items(source, facing, items); });
}

std::uint64_t Viewpoint::outline() const {
  return state_->outline;
}

std::vector<SeenEdge> Viewpoint::seen_edges() {
  State& s = *state_;
  std::vector<SeenEdge> edges;
  if (s.outline == 0) return edges;
  const Plane& plane = s.soup.facets()[s.region.source_facet()].plane;
  s.region.for_each_arc([&](const Arc<double>& arc) {
    const ViewPlane& side = arc.side->exact;
    SeenEdge edge;
    const Ends ends = ends_of(arc);
    edge.id = is_level(ends, s.view.receiver().normal) ? kHorizon : id_of(side);
    if (side.kind == ViewPlane::Kind::edge) {
      edge.a = *side.c;
      edge.b = *side.d;
    } else if (side.kind == ViewPlane::Kind::horizon) {
      std::tie(edge.a, edge.b) = line_of(plane.origin, plane.normal, s.view.receiver().point, s.view.receiver().normal);
    } else {
      const PlanePoints& T = *side.T;
      std::tie(edge.a, edge.b) = line_of(plane.origin, plane.normal, *T.a, cross(*T.b - *T.a, *T.c - *T.a));
    }
    std::tie(edge.from, edge.to) = ends;
    if (norm(edge.to - edge.from) > kShortest) edges.push_back(edge);
  });
  return edges;
}

std::vector<BoundaryPiece> Viewpoint::visible_region(const Source& source) {
  State& s = *state_;
  std::vector<BoundaryPiece> pieces;
  int source_facing = 0;
  if (s.view.covered() || !s.prepare(source, source_facing) || !s.put_occluders(source, source_facing)) return pieces;
  // Near the point of view a direction must be known far better than the point where it meets the source's plane.
  s.set_source<Extended>(source.facet, source_facing);
  s.add_candidates<Extended>(source.facet);
  const PlanePoints& plane = s.soup.facets()[source.facet].plane.points;
  const auto normal = cross(difference<Extended>(*plane.b, *plane.a), difference<Extended>(*plane.c, *plane.a));
  const Extended height = dot(normal, difference<Extended>(*plane.a, s.view.receiver().point));
  s.finest.for_each_arc([&](const Arc<Extended>& arc) {
    if (!(arc.t0 < arc.t1)) return;
    const auto p = arc.cone->corners.w(arc.side->from);
    const auto e = arc.cone->corners.w(arc.side->to) - p;
    const auto point = [&](const Extended& t) {
      const auto w = p + t * e;
      const Extended scale = arc.of_source ? Extended(1) : Extended(height / dot(normal, w));
      return Vec3{static_cast<double>(s.view.receiver().point.x + scale * w.x),
                  static_cast<double>(s.view.receiver().point.y + scale * w.y),
                  static_cast<double>(s.view.receiver().point.z + scale * w.z)};
    };
    // The region lies to the left of the direction whose normal with x points to it: out of an occluder's cone.
    const bool towards_cone = dot(cross(p, e), arc.side->m) < 0;
    const Vec3 from = point(arc.t0), to = point(arc.t1);
    pieces.push_back(towards_cone == arc.of_source ? BoundaryPiece{from, to, arc.of_source}
                                                   : BoundaryPiece{to, from, arc.of_source});
  });
  return pieces;
}

const StageCounts& Viewpoint::stage_counts() const {
  return state_->view.counts();
}
std::uint64_t Viewpoint::extended_count() const {
  return state_->extended;
}

std::vector<Vec3> corners_of(const PolygonSoup& soup, const Source& source) {
  std::vector<Vec3> corners(source.loop.begin(), source.loop.end());
  if (corners.empty()) {
    for (const Corner& c : soup.corners(soup.facets()[source.facet])) corners.push_back(c.at);
  }
  return corners;
}

double area(std::span<const BoundaryPiece> region) {
  if (region.empty()) return 0;
  const Vec3 o = region.front().from;
  Vec3 sum;
  for (const BoundaryPiece& p : region) sum = sum + cross(p.from - o, p.to - o);
  return 0.5 * norm(sum);
}

}  // namespace exitance
