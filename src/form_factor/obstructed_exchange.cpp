#include "src/form_factor/obstructed_exchange.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "src/form_factor/outline.h"
#include "src/form_factor/pole.h"

namespace exitance {
namespace {

/// Orders of a cell's first rule, which only finds out whether anything is seen, of the next one at least, and of that
/// of halves.
constexpr int kScoutOrder = 2, kFirstOrder = 4, kOrderOfHalves = 5, kSureOrder = 8;
/// So many cells are cut along events before any of them is measured.
constexpr std::size_t kCellsCutFirst = 400;
/// What a cell with uncut events may hide from its sample points, as a share of what could be seen at most.
constexpr double kUnnoticed = 4e-3;
/// Part of the difference of what a cell's points see that its integral may be wrong by when they see different
/// outlines.
constexpr double kMixed = 3e-2;
/// What a cell's first rule may err by, as a share of what its corners say otherwise, and of the difference of what its
/// points see.
constexpr double kCorners = 0.5, kSpread = 2e-2;
/// How far inside a cell its corners are looked from, as a share of the way to the middle.
constexpr double kInset = 1e-3;
/// Proven error of a point's value beyond which extended precision is asked: this, or what the cell's share of the
/// tolerance allows. Cells near a contact are tiny, and there double precision proves little.
constexpr double kPointTolerance = 1e-13, kCellShare = 1e-2;
/// A corner of a cell is off by so many roundings of its largest coordinate, those of where it is cut included.
constexpr double kRoundedCorners = 4;
/// How many points a value in extended precision counts for.
constexpr std::uint64_t kExtendedCost = 5;

double extent_of(const AreaCell& shape) {
  double extent = 0;
  for (const Vec3& v : shape.loop()) extent = std::max({extent, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  return extent;
}

double perimeter_of(const AreaCell& shape) {
  const auto loop = shape.loop();
  double perimeter = norm(loop[0] - loop.back());
  for (std::size_t k = 1; k < loop.size(); ++k) perimeter += norm(loop[k] - loop[k - 1]);
  return perimeter;
}

}  // namespace

ObstructedExchange::ObstructedExchange(const PolygonSoup& soup, const Source& receiver, const Source& source,
                                       std::span<const std::uint32_t> items)
    : soup_(&soup),
      receiver_(receiver),
      source_(source),
      items_(items),
      bound_(soup, receiver, source),
      contact_(soup, receiver, source, items) {
  events_ = visual_events(soup, receiver, source, items);
  const std::vector<Vec3> loop = corners_of(soup, receiver);
  find_contacts();
  std::vector<AreaCell> shapes;
  for (const AreaCell& shape : cells_of(loop)) add_about_contacts(shape, shapes);
  for (const AreaCell& shape : shapes) {
    Cell cell = unmeasured(shape);
    for (std::uint32_t e = 0; e < events_.size(); ++e) {
      if (events_[e].concerns(shape.loop())) cell.uncut.push_back(e);
    }
    area_ += shape.area();
    cells_.push_back(std::move(cell));
  }
}

/// Of which nothing is known but what its points may see at most.
ObstructedExchange::Cell ObstructedExchange::unmeasured(const AreaCell& shape) const {
  Cell cell;
  cell.shape = shape;
  cell.most = bound_.from(shape);
  cell.error = cell.most * shape.area();
  return cell;
}

void ObstructedExchange::find_contacts() {
  const Plane& plane = soup_->facets()[receiver_.facet].plane;
  const double size = norm(plane.normal);
  const auto add_edge = [&](const Vec3& a, const Vec3& b) {
    const double at_a = dot(plane.normal, a - plane.origin), at_b = dot(plane.normal, b - plane.origin);
    if (std::fabs(at_a) <= 1e-12 * size * norm(a - plane.origin)) {
      contacts_.push_back(a);
    } else if (at_a * at_b < 0 && std::fabs(at_b) > 1e-12 * size * norm(b - plane.origin)) {
      contacts_.push_back(a + (at_a / (at_a - at_b)) * (b - a));
    }
  };
  const auto add_loop = [&](const auto& loop, const auto& point) {
    for (std::size_t k = 0; k < loop.size(); ++k) add_edge(point(loop[k]), point(loop[(k + 1) % loop.size()]));
  };
  add_loop(corners_of(*soup_, source_), [](const Vec3& v) { return v; });
  const auto facets = static_cast<std::uint32_t>(soup_->facets().size());
  const auto add_facet = [&](std::uint32_t f) {
    add_loop(soup_->corners(soup_->facets()[f]), [](const Corner& c) { return c.at; });
  };
  for (const std::uint32_t item : items_) {
    if (item < facets) {
      add_facet(item);
    } else {
      for (const std::uint32_t f : soup_->shells()[item - facets].facets) add_facet(f);
    }
  }
}

/// Appends the cell; if it touches contacts, as triangles that have one of them at their last corner or none at all.
void ObstructedExchange::add_about_contacts(const AreaCell& shape, std::vector<AreaCell>& shapes) const {
  if (!shape.is_straight()) {
    shapes.push_back(shape);
    return;
  }
  const auto loop = shape.loop();
  const std::size_t n = loop.size();
  const double near = 1e-12 * (norm(loop[1] - loop[0]) + norm(loop[2] - loop[1]));
  const auto touches = [&](const Vec3& v) {
    return std::ranges::any_of(contacts_, [&](const Vec3& c) { return norm(v - c) <= near; });
  };
  const auto first = static_cast<std::size_t>(std::ranges::find_if(loop, touches) - loop.begin());
  if (first == n) {
    shapes.push_back(shape);
    return;
  }
  // Triangles with the contact as apex; one that has another contact, too, is halved between them.
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const Vec3 &apex = loop[first], &a = loop[(first + k) % n], &b = loop[(first + k + 1) % n];
    const bool at_a = touches(a), at_b = touches(b);
    if (!at_a && !at_b) {
      shapes.push_back({{a, b, apex, a}, 3});
      continue;
    }
    const Vec3 other = at_a ? a : b, free = at_a ? b : a, middle = apex + 0.5 * (other - apex);
    const auto triangle = [&](const Vec3& p, const Vec3& q, const Vec3& r) { return AreaCell{{p, q, r, p}, 3}; };
    if (at_a && at_b) {  // all three: four triangles, one at each corner and the middle one
      const Vec3 m = a + 0.5 * (b - a), at_other = apex + 0.5 * (free - apex);
      const Vec3 &near_a = middle, &near_b = at_other;
      shapes.push_back(triangle(near_a, near_b, apex));
      shapes.push_back(triangle(m, near_a, a));
      shapes.push_back(triangle(near_b, m, b));
      shapes.push_back(triangle(near_a, m, near_b));
    } else if (at_a) {
      shapes.push_back(triangle(middle, b, apex));
      shapes.push_back(triangle(b, middle, a));
    } else {
      shapes.push_back(triangle(a, middle, apex));
      shapes.push_back(triangle(middle, a, b));
    }
  }
}

PointFormFactor ObstructedExchange::look(Viewpoint& view, const Vec3& from, double tolerance) {
  ++points_;
  if (contact_.buries(from)) return {};
  const std::uint64_t extended_before = view.extended_count();
  view.look_from({from, soup_->facets()[receiver_.facet].plane.normal, receiver_.facet});
  const PointFormFactor f = view.form_factor(source_, items_, tolerance);
  points_ += kExtendedCost * (view.extended_count() - extended_before);
  return f;
}

std::uint64_t ObstructedExchange::outline_of(const Viewpoint& view) const {
  std::uint64_t outline = view.outline();
  for (auto same = same_.find(outline); same != same_.end(); same = same_.find(outline)) outline = same->second;
  return outline;
}

ObstructedExchange::Sighting ObstructedExchange::sight(Viewpoint& view, const Vec3& from) {
  const PointFormFactor f = look(view, from, 1);
  if (f.side != Side::front) return {from, 0, 0};
  return {from, f.F, outline_of(view)};
}

/// A cell's corners lie on events; what counts is what is seen just inside.
void ObstructedExchange::sight_corners(Viewpoint& view, const AreaCell& shape, std::vector<Sighting>& sightings) {
  Vec3 middle;
  const double share = 1.0 / shape.corners;
  for (const Vec3& v : shape.loop()) middle = middle + share * v;
  if (!shape.is_straight()) middle = 0.5 * (first_side(shape, 0.5).at + opposite_side(shape, 0.5).at);
  for (const Vec3& v : shape.loop()) sightings.push_back(sight(view, v + kInset * (middle - v)));
}

void ObstructedExchange::measure(Viewpoint& view, Cell& cell, int order, double tolerance) {
  const bool first = cell.order == 0;
  cell.order = order;
  gauss_points(cell.shape, cell.order, scratch_);
  const double area = cell.shape.area();
  const double point_tolerance = std::max(kPointTolerance, kCellShare * tolerance / area);
  weighted_.clear();
  cell.integral = cell.point_error = 0;
  const bool compare = cell.uncut.empty();
  std::uint64_t outline = 0;
  double least = 1, greatest = 0, folded = 0;
  for (const WeightedPoint& p : scratch_) {
    folded += std::max(0.0, -p.weight);
    const PointFormFactor f = look(view, p.point, point_tolerance);
    const bool front = f.side == Side::front;
    const double F = front ? f.F : 0;
    weighted_.push_back(p.weight * F);
    cell.integral += p.weight * F;
    if (front) cell.point_error += std::fabs(p.weight) * f.error;
    least = std::min(least, F);
    greatest = std::max(greatest, F);
    if (compare) {
      const std::uint64_t now = front ? outline_of(view) : 0;
      cell.mixed = cell.mixed || (&p != scratch_.data() && now != outline);
      if (&p == scratch_.data()) outline = now;
    }
  }
  // Rounding: of each weight and product, and of the sum.
  cell.point_error += (16 + static_cast<double>(scratch_.size())) * kRoundoff * cell.integral;
  // Corners and points are rounded, too. That so far outside of a cell, or away from where a point should be, no more
  // is seen than `greatest` within is an estimate: nothing proves it.
  cell.point_error += kRoundedCorners * kRoundoff * extent_of(cell.shape) * perimeter_of(cell.shape) * greatest;
  const Truncation truncation = truncation_of(weighted_, cell.order);
  const double slowest = ray_fall(contacts_, cell.shape);
  if (first) {
    cell.decay = RuleDecay(order, cell.integral, order == kScoutOrder ? 0 : truncation.expected);
    cell.error = truncation.error;
    cell.fall = truncation.fall;
    if (cell.error > 0 && std::max(cell.slowest, slowest) > cell.fall) {
      cell.error *= std::pow(std::max(cell.slowest, slowest) / cell.fall, 1 + order);
      cell.fall = std::max(cell.slowest, slowest);
    }
  } else {
    cell.decay.next(order, cell.integral, truncation, slowest);
    cell.error = cell.decay.error();
    cell.fall = cell.decay.fall();
  }
  // Crossings are left to later rules: on a first one they cost more points than the little that they reveal.
  std::array<PoleError, 2> poles;
  if (compare && !cell.mixed && outline != 0) {
    const std::vector<SeenEdge> edges = view.seen_edges();
    poles = {order > kScoutOrder ? crossing_poles(edges, cell.shape, order) : PoleError{},
             corner_poles(edges, scratch_.back().point, contacts_, cell.shape, order)};
  }
  if (order == kScoutOrder) {
    sightings_.clear();
    sight_corners(view, cell.shape, sightings_);
    double mean = 0;
    for (const Sighting& s : sightings_) {
      cell.mixed = cell.mixed || (compare && s.outline != outline);
      mean += s.F / static_cast<double>(sightings_.size());
      least = std::min(least, s.F);
      greatest = std::max(greatest, s.F);
    }
    // Four points tell little, but what the corners see differs from them by more than they err.
    cell.error = kCorners * std::fabs(mean * area - cell.integral) + kSpread * (greatest - least) * area;
    cell.fall = std::clamp(cell.fall, 0.05, 0.3);
  }
  const double of_rule = cell.error;
  for (const PoleError& p : poles) {
    if (order > kScoutOrder && p.error > of_rule) cell.fall = std::max(cell.fall, p.fall);
    cell.error += p.error;
  }
  if (order > kScoutOrder && !cell.looked && compare && !cell.mixed && outline != 0) {
    cell.looked = find_hidden_events(view, cell, outline, scratch_.back().point);
    if (!cell.looked) cell.error += kUnnoticed * cell.most * area;
  }
  if (cell.mixed) cell.error = std::max(cell.error, truncation.last + kMixed * (greatest - least) * area);
  if (cell.mixed && greatest == 0) cell.error = kUnnoticed * cell.most * area;
  if (!cell.uncut.empty()) cell.error += kUnnoticed * cell.most * area;
  // Where a map folds, points lie outside of the cell.
  cell.error += folded * cell.most;
  // However little is known, the cell sees something between nothing and all that it may see.
  const double possible = std::max(cell.integral, cell.most * area - cell.integral);
  if (!(cell.error <= possible)) cell.error = possible;
}

/// Looks for events that happen in a cell but not between its points, from one of which the outline was seen last.
/// Whether it could look for all of them, or until it found one, before it was to stop.
bool ObstructedExchange::find_hidden_events(Viewpoint& view, Cell& cell, std::uint64_t outline, const Vec3& from) {
  if (edges_.empty()) edges_ = edges_of(*soup_, source_, items_);
  const std::vector<SeenEdge> edges = view.seen_edges();
  for (const HiddenEvent& hidden : hidden_events(edges, edges_, from, cell.shape, [&] { return is_over(); })) {
    if (is_over()) return false;
    const Sighting beyond = sight(view, hidden.beyond);
    if (beyond.outline == outline) continue;
    cell.mixed = true;
    const auto known = std::ranges::find(found_, hidden.event.id(), &EdgeEvent::id);
    cell.found.push_back(static_cast<std::uint32_t>(events_.size() + static_cast<std::size_t>(known - found_.begin())));
    if (known == found_.end()) found_.push_back(hidden.event);
    return true;
  }
  return !is_over();
}

/// Of the events that are known, straight ones first: which side of it a point is on.
double ObstructedExchange::side_of_event(std::uint32_t e, const Vec3& x) const {
  if (e < events_.size()) return events_[e].plane.at(x);
  const EdgeEvent& event = found_[e - events_.size()];
  return event.plane() ? event.plane()->at(x) : event.at(x);
}
std::vector<AreaCell> ObstructedExchange::cut_along(std::uint32_t e, const AreaCell& shape) const {
  if (e < events_.size()) return shape.is_straight() ? cut(shape, events_[e].plane) : std::vector<AreaCell>{};
  const EdgeEvent& event = found_[e - events_.size()];
  return event.plane() && shape.is_straight() ? cut(shape, *event.plane()) : cut(shape, event);
}

/// The event that happens between two points of different outlines, the first that is met from there on; found by
/// halving the way.
std::optional<std::uint32_t> ObstructedExchange::find_event(Viewpoint& view, Sighting here, Sighting there) {
  const Vec3 start = here.point, end = there.point;
  constexpr int kHalvings = 14, kTurns = 12;
  for (int k = 0; k < kHalvings; ++k) {
    const Sighting middle = sight(view, here.point + 0.5 * (there.point - here.point));
    (middle.outline == here.outline ? here : there) = middle;
  }
  const Vec3 step = 1e-2 * (end - start);
  const auto happens_here = [&](std::uint32_t e) {
    return side_of_event(e, start) * side_of_event(e, end) < 0 &&
           side_of_event(e, here.point - step) * side_of_event(e, there.point + step) < 0;
  };
  for (std::uint32_t e = 0; e < events_.size() + found_.size(); ++e) {
    if (happens_here(e)) return e;
  }
  const auto edges_from = [&](const Vec3& x) {
    return sight(view, x).outline != 0 ? view.seen_edges() : std::vector<SeenEdge>{};
  };
  const std::vector<SeenEdge> from_here = edges_from(here.point), from_there = edges_from(there.point);
  if (same_lines(from_here, from_there)) {
    same_.emplace(std::max(here.outline, there.outline), std::min(here.outline, there.outline));
    return {};
  }
  for (const EdgeEvent& event : events_between(from_here, from_there)) {
    found_.push_back(event);
    const auto e = static_cast<std::uint32_t>(events_.size() + found_.size() - 1);
    if (happens_here(e)) return e;
    found_.pop_back();
  }
  // Edges that coincide but for rounding take turns.
  bool turned = false;
  for (int k = 0; k <= kTurns; ++k) {
    const Vec3 x = here.point + (2.0 * k / kTurns - 1) * 4 * step;
    const std::uint64_t outline = sight(view, x).outline;
    if (turned && outline == here.outline) {
      same_.emplace(std::max(here.outline, there.outline), std::min(here.outline, there.outline));
      break;
    }
    turned = turned || outline == there.outline;
  }
  return {};
}

/// Events that tell the outlines that a mixed cell's points see from each other.
std::vector<std::uint32_t> ObstructedExchange::events_in(Viewpoint& view, const Cell& cell) {
  std::vector<WeightedPoint> places;
  gauss_points(cell.shape, std::clamp(cell.order, 3, 5), places);
  std::vector<Sighting> sightings;
  for (const WeightedPoint& p : places) sightings.push_back(sight(view, p.point));
  sight_corners(view, cell.shape, sightings);
  std::vector<std::uint64_t> outlines;
  for (const Sighting& s : sightings) {
    if (std::ranges::find(outlines, s.outline) == outlines.end()) outlines.push_back(s.outline);
  }
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t e = 0; e < events_.size() + found_.size(); ++e) {
    if (e >= events_.size() || events_[e].concerns(cell.shape.loop())) candidates.push_back(e);
  }
  constexpr std::size_t kOutlines = 5;
  std::vector<std::uint32_t> events;
  for (std::size_t k = 1; k < std::min(outlines.size(), kOutlines); ++k) {
    // Two points of the first outline and of this one, as near each other as can be.
    const Sighting *here = nullptr, *there = nullptr;
    double nearest = INFINITY;
    for (const Sighting& s : sightings) {
      for (const Sighting& t : sightings) {
        if (s.outline == t.outline || t.outline != outlines[k] ||
            std::ranges::find(outlines, s.outline) - outlines.begin() > static_cast<std::ptrdiff_t>(k)) {
          continue;
        }
        const double apart = norm(t.point - s.point);
        if (apart >= nearest) continue;
        nearest = apart;
        here = &s;
        there = &t;
      }
    }
    const auto separates = [&](std::uint32_t e) {
      const double one = side_of_event(e, here->point);
      return std::ranges::all_of(sightings, [&](const Sighting& s) {
        return (s.outline != here->outline || side_of_event(e, s.point) * one > 0) &&
               (s.outline != there->outline || side_of_event(e, s.point) * one < 0);
      });
    };
    const auto known = std::ranges::find_if(candidates, separates);
    std::optional<std::uint32_t> event;
    if (known != candidates.end()) {
      event = *known;
    } else {
      event = find_event(view, *here, *there);
      if (event) candidates.push_back(*event);
    }
    if (event && std::ranges::find(events, *event) == events.end()) events.push_back(*event);
  }
  return events;
}

/// A mixed cell, cut between what its points see; halved where that is too much for one cut.
std::vector<AreaCell> ObstructedExchange::separate(Viewpoint& view, const Cell& cell) {
  std::vector<std::uint32_t> events = events_in(view, cell);
  for (const std::uint32_t e : cell.found) {
    if (std::ranges::find(events, e) == events.end()) events.push_back(e);
  }
  const auto is_straight = [&](std::uint32_t e) { return e < events_.size() || found_[e - events_.size()].plane(); };
  if (cell.shape.is_straight()) {
    for (const std::uint32_t e : events) {
      if (!is_straight(e)) continue;
      if (auto parts = cut_along(e, cell.shape); !parts.empty()) return parts;
    }
  }
  for (const std::uint32_t e : events) {
    // Events that cross each other need smaller cells first.
    auto parts = cut_along(e, cell.shape);
    if (parts.empty()) continue;
    const bool apart = std::ranges::all_of(events, [&](std::uint32_t other) {
      double sign = 0;
      for (int k = 0; k <= 4 && other != e; ++k) {
        const AreaCell& beside = parts[0];
        const double value =
            side_of_event(other, (cell.shape.is_straight() ? first_side : opposite_side)(beside, 0.02 + 0.24 * k).at);
        if (value * sign < 0) return false;
        sign = value;
      }
      return true;
    });
    if (apart) return parts;
  }
  const auto [one, other] = bisect(cell.shape);
  return {one, other};
}

/// The cell cut along the event that divides it most evenly; without events, halved.
std::vector<ObstructedExchange::Cell> ObstructedExchange::parts_of(Viewpoint* view, const Cell& cell) {
  std::vector<AreaCell> shapes;
  std::uint32_t along = kNone;
  double evenness = -1;
  for (const std::uint32_t e : cell.uncut) {
    double below = 0, above = 0;
    for (const Vec3& v : cell.shape.loop()) {
      const double d = events_[e].plane.at(v);
      below = std::max(below, -d);
      above = std::max(above, d);
    }
    const double even = std::min(below, above) / std::max(below, above);
    if (even > evenness) {
      evenness = even;
      along = e;
    }
  }
  if (along != kNone) {
    shapes = cut(cell.shape, events_[along].plane);
    if (shapes.empty()) shapes = {cell.shape};  // what is cut off has no area in double precision
  } else if (cell.mixed) {
    shapes = separate(*view, cell);
  } else {
    const auto [one, other] = bisect(cell.shape);
    shapes = {one, other};
  }
  std::vector<AreaCell> arranged;
  for (const AreaCell& shape : shapes) add_about_contacts(shape, arranged);
  std::vector<Cell> parts;
  for (const AreaCell& shape : arranged) {
    Cell part = unmeasured(shape);
    // A half's poles lie twice as far away as those of the whole, so that its coefficients fall by the square at best.
    // What made those of the whole fall slowly may hide between the few points of the half's first rule.
    if (along == kNone && !cell.mixed) part.slowest = cell.fall * cell.fall;
    for (const std::uint32_t e : cell.uncut) {
      if (e != along && events_[e].concerns(shape.loop())) part.uncut.push_back(e);
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

/// Cuts along all events, the oldest cells first, as long as there are not too many cells.
void ObstructedExchange::cut_all() {
  for (std::size_t first = 0; first < cells_.size() && cells_.size() < kCellsCutFirst;) {
    if (cells_[first].uncut.empty()) {
      ++first;
      continue;
    }
    std::vector<Cell> parts = parts_of(nullptr, cells_[first]);
    cells_[first] = std::move(parts[0]);
    for (std::size_t k = 1; k < parts.size(); ++k) cells_.push_back(std::move(parts[k]));
  }
}

void ObstructedExchange::refine(Viewpoint& view, double tolerance, std::uint64_t points,
                                const std::function<bool()>& stop) {
  most_points_ = points;
  stop_ = &stop;
  const auto better = [&](std::uint32_t a, std::uint32_t b) {
    return cells_[a].error != cells_[b].error ? cells_[a].error < cells_[b].error : a < b;
  };
  const auto push = [&](std::uint32_t c) {
    heap_.push_back(c);
    std::push_heap(heap_.begin(), heap_.end(), better);
  };
  if (!started_) {
    started_ = true;
    cut_all();
    for (std::uint32_t c = 0; c < cells_.size(); ++c) {
      if (!is_over()) measure(view, cells_[c], kScoutOrder, tolerance);
      running_error_ += cells_[c].error + cells_[c].point_error;
      push(c);
    }
  }
  while (running_error_ > tolerance && !heap_.empty() && !is_over()) {
    std::pop_heap(heap_.begin(), heap_.end(), better);
    const std::uint32_t worst = heap_.back();
    heap_.pop_back();
    if (cells_[worst].error == 0) break;  // what is left are the points' own errors
    running_error_ -= cells_[worst].error + cells_[worst].point_error;
    // The order that the fall of the coefficients lets hope is enough; where that is too high, halves.
    const Cell& old = cells_[worst];
    const double wanted = 0.5 * tolerance * std::max(old.shape.area() / area_, 1 / static_cast<double>(cells_.size()));
    int order = std::max(kFirstOrder, old.order + 1);
    for (double left = old.error * std::pow(old.fall, 2 * (order - old.order)); left > wanted && order <= kHighestOrder;
         ++order) {
      left *= old.fall * old.fall;
    }
    if (order > kHighestOrder && old.order < kSureOrder) {
      order = kSureOrder;  // the rules of lowest order tell little of how the others do
    } else if (order > kHighestOrder && old.order < kHighestOrder &&
               old.error * std::pow(old.fall, kHighestOrder) <= wanted) {
      order = kHighestOrder;  // the figure of one rule may be by chance much larger than that of the next
    }
    // How fast the coefficients fall is a guess, which a farther jump raises to a high power.
    if (order <= kHighestOrder && old.order > 0) order = std::min(order, std::max(3 * kScoutOrder, 2 * old.order));
    std::vector<Cell> parts;
    if (old.order == 0) {
      order = kScoutOrder;
      parts.push_back(std::move(cells_[worst]));
    } else if (old.uncut.empty() && !old.mixed && order <= kHighestOrder) {
      parts.push_back(std::move(cells_[worst]));
    } else {
      const bool known = old.uncut.empty() && !old.mixed;
      parts = parts_of(&view, Cell(old));
      order = known ? kOrderOfHalves : kScoutOrder;
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
      measure(view, parts[k], order, tolerance);
      running_error_ += parts[k].error + parts[k].point_error;
      std::uint32_t place = worst;
      if (k > 0) {
        place = static_cast<std::uint32_t>(cells_.size());
        cells_.emplace_back();
      }
      cells_[place] = std::move(parts[k]);
      push(place);
    }
  }
}

double ObstructedExchange::integral() const {
  return std::accumulate(cells_.begin(), cells_.end(), 0.0, [](double sum, const Cell& c) { return sum + c.integral; });
}

double ObstructedExchange::error() const {
  const double rounding = static_cast<double>(cells_.size()) * kRoundoff * integral();
  return std::accumulate(cells_.begin(), cells_.end(), rounding,
                         [](double sum, const Cell& c) { return sum + c.error + c.point_error; });
}

}  // namespace exitance
