#include "src/form_factor/event_reach.h"

#include <algorithm>
#include <cmath>

#include "src/form_factor/visual_event.h"

namespace exitance {
namespace {

using Order = SightPlane::Order;

/// Shares of the receiver's size: what is left of a trace is longer by this, what is taken out of it shorter by that.
constexpr double kLonger = 1e-9, kShorter = 1e-7;
/// Stretches of one item's facets that lie no farther apart are one.
constexpr double kSame = 1e-11;
/// What counts as lying in a plane, as a share of distances.
constexpr double kInPlane = 1e-12;

LineStretch widened(const LineStretch& s, double by) {
  return {s.from - by, s.to + by};
}

/// The plane through a vertex and an edge is known the worse the nearer they are to a line.
double blur_of(const CutPlane& plane, const Vec3& from, const Vec3& to) {
  return kInPlane * norm(from - plane.point) * norm(to - plane.point) / norm(plane.normal);
}

}  // namespace

EventReach::EventReach(const PolygonSoup& soup, const Source& receiver, const Source& source,
                       std::span<const std::uint32_t> items)
    : receiver_{normalized(soup.facets()[receiver.facet].plane.normal), soup.facets()[receiver.facet].plane.origin},
      source_plane_{normalized(soup.facets()[source.facet].plane.normal), soup.facets()[source.facet].plane.origin},
      loop_(corners_of(soup, receiver)),
      source_(corners_of(soup, source)) {
  for (const Vec3& v : loop_) size_ = std::max(size_, norm(v - loop_[0]));
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  const auto add = [&](std::uint32_t f, std::uint32_t item) {
    const std::vector<Vec3> loop = corners_of(soup, {f, {}});
    const auto lies_in = [&](const CutPlane& plane) {
      return std::ranges::all_of(loop, [&](const Vec3& v) { return std::fabs(plane.at(v)) <= kLonger * size_; });
    };
    if (!lies_in(receiver_) && !lies_in(source_plane_)) blockers_.push_back({loop, item});
  };
  if (items.size() == 1) return;  // what is on its outline it does not hide itself
  for (const std::uint32_t item : items) {
    if (item < facets) {
      add(item, item);
    } else {
      for (const std::uint32_t f : soup.shells()[item - facets].facets) add(f, item);
    }
  }
}

/// The part in front of the source.
bool EventReach::clip_to_front(std::array<Vec3, 2>& segment) const {
  const double one = source_plane_.at(segment[0]), other = source_plane_.at(segment[1]);
  if (one <= 0 && other <= 0) return false;
  const Vec3 along = segment[1] - segment[0];
  if (one < 0) segment[0] = segment[0] + (one / (one - other)) * along;
  if (other < 0) segment[1] = segment[0] + (one / (one - other)) * along;
  return true;
}

void EventReach::take_out_blocked(const SightPlane& sight, const Vec3& vertex,
                                  std::vector<LineStretch>& stretches) const {
  const SightPlane::Place pivot = sight.place_of(vertex);
  const double near = kLonger * size_;
  std::vector<LineStretch> blocked;
  std::uint32_t item = kNone;
  const auto take_out_item = [&] {
    std::ranges::sort(blocked, {}, &LineStretch::from);
    LineStretch whole;
    for (const LineStretch& s : blocked) {
      if (!whole.empty() && s.from > whole.to + kSame * size_) {
        take_out(stretches, widened(whole, -kShorter * size_));
        whole = {};
      }
      whole.add(s);
    }
    if (!whole.empty()) take_out(stretches, widened(whole, -kShorter * size_));
    blocked.clear();
  };
  for (const Blocker& b : blockers_) {
    if (stretches.empty()) return;
    if (b.item != item) take_out_item();
    item = b.item;
    if (std::ranges::find(b.loop, vertex) != b.loop.end()) continue;
    std::optional<std::array<Vec3, 2>> chord = sight.chord_of(b.loop, true);
    if (!chord || !clip_to_front(*chord)) continue;
    const SightPlane::Place one = sight.place_of((*chord)[0]), other = sight.place_of((*chord)[1]);
    // One that all but runs through the vertex: rounding would tell what it blocks.
    const double along = other.along - one.along, up = other.height - one.height, to_along = pivot.along - one.along,
                 to_up = pivot.height - one.height,
                 share = std::clamp((along * to_along + up * to_up) / (along * along + up * up), 0.0, 1.0);
    if (!(std::hypot(to_along - share * along, to_up - share * up) > near)) continue;
    for (const Order order : {Order::before, Order::beyond}) {
      const LineStretch s = sight.through(pivot, one, other, order);
      if (!s.empty()) blocked.push_back(s);
    }
  }
  take_out_item();
}

std::vector<LineStretch> EventReach::of_vertex_edge(const CutPlane& plane, const Vec3& vertex, const Vec3& from,
                                                    const Vec3& to, Way way, Vec3& along) const {
  const SightPlane sight(receiver_, plane, blur_of(plane, from, to));
  along = sight.along();
  // Of what pierces the planes of receiver or source no part of the trace is left out: there what was left out was
  // missed.
  const double below = -kLonger * size_;
  for (const Vec3& v : {vertex, from, to}) {
    if (receiver_.at(v) < below || source_plane_.at(v) < below) return {{-INFINITY, INFINITY}};
  }
  const SightPlane::Place pivot = sight.place_of(vertex);
  if (!(pivot.height > kInPlane * size_)) return {};
  const double longer = kLonger * size_;
  const bool edge_first = way == Way::edge_vertex || way == Way::edge_source;
  LineStretch reach = widened(
      sight.through(pivot, sight.place_of(from), sight.place_of(to), edge_first ? Order::before : Order::beyond),
      longer);
  // A vertex that touches the source is seen against it from all along the trace.
  if ((way == Way::vertex_edge || way == Way::edge_vertex) && source_plane_.at(vertex) > longer) {
    const auto chord = sight.chord_of(source_, false);
    if (!chord) return {};
    reach.keep_within(
        widened(sight.through(pivot, sight.place_of((*chord)[0]), sight.place_of((*chord)[1]), Order::beyond), longer));
  }
  if (reach.empty()) return {};
  std::vector<LineStretch> stretches{reach};
  if (!blockers_.empty() && VisualEvent{plane, along, reach}.concerns(loop_)) {
    take_out_blocked(sight, vertex, stretches);
  }
  return stretches;
}

/// What a polygon or edge in the plane hides of some of the source there, from the receiver.
LineStretch EventReach::shadow_of(const SightPlane& sight, std::span<const Vec3> facet) const {
  const auto chord = sight.chord_of(source_, false);
  LineStretch reach, heights;
  if (!chord) return reach;
  const std::array ends{sight.place_of((*chord)[0]), sight.place_of((*chord)[1])};
  for (const Vec3& v : facet) heights.add(receiver_.at(v));
  const double lowest = std::min(ends[0].height, ends[1].height), highest = std::max(ends[0].height, ends[1].height),
               longer = kLonger * size_;
  if (highest >= heights.from - longer && lowest <= heights.to + longer) return {-INFINITY, INFINITY};
  if (lowest < heights.from) return reach;
  for (const SightPlane::Place& end : ends) {
    for (std::size_t k = 0; k < facet.size(); ++k) {
      reach.add(
          sight.through(end, sight.place_of(facet[k]), sight.place_of(facet[(k + 1) % facet.size()]), Order::before));
    }
  }
  return reach;
}

std::vector<LineStretch> EventReach::of_edges(const CutPlane& plane, std::span<const Vec3, 2> one,
                                              std::span<const Vec3, 2> other, Vec3& along) const {
  const SightPlane sight(receiver_, plane, blur_of(plane, other[0], other[1]));
  along = sight.along();
  LineStretch reach = widened(shadow_of(sight, one), kLonger * size_);
  reach.keep_within(widened(shadow_of(sight, other), kLonger * size_));
  if (reach.empty()) return {};
  return {reach};
}

std::vector<LineStretch> EventReach::of_facet(const CutPlane& plane, std::span<const Vec3> facet, Vec3& along) const {
  const SightPlane sight(receiver_, plane, kInPlane);
  along = sight.along();
  const double longer = kLonger * size_;
  LineStretch reach = shadow_of(sight, facet);
  for (std::size_t k = 0; k < facet.size(); ++k) {
    const SightPlane::Place a = sight.place_of(facet[k]), b = sight.place_of(facet[(k + 1) % facet.size()]);
    if (std::fabs(a.height) <= longer) reach.add(a.along);
    if (a.height * b.height < 0) reach.add(a.along + (a.height / (a.height - b.height)) * (b.along - a.along));
  }
  if (reach.empty()) return {};
  return {widened(reach, longer)};
}

}  // namespace exitance
