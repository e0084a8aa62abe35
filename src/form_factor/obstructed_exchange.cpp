#include "src/form_factor/obstructed_exchange.h"

#include <algorithm>
#include <numeric>

namespace exitance {
namespace {

/// Orders of a cell's first rule, which only finds out whether anything is seen, of the next one at least, and of that
/// of halves.
constexpr int kScoutOrder = 2, kFirstOrder = 4, kOrderOfHalves = 5;
/// Likewise, where events of three edges may cross the cell.
constexpr int kFirstOrderAcross = 5;
/// So many cells are cut along events before any of them is measured.
constexpr std::size_t kCellsCutFirst = 400;
/// What a cell with uncut events may hide from its sample points, as a share of what could be seen at most.
constexpr double kUnnoticed = 4e-3;
/// Proven error of a point's value beyond which extended precision is asked: this, or what the cell's share of the
/// tolerance allows. Cells near a contact are tiny, and there double precision proves little.
constexpr double kPointTolerance = 1e-13, kCellShare = 1e-2;
/// How many points a value in extended precision counts for.
constexpr std::uint64_t kExtendedCost = 5;

}  // namespace

ObstructedExchange::ObstructedExchange(const PolygonSoup& soup, const Source& receiver, const Source& source,
                                       std::span<const std::uint32_t> items, double most)
    : soup_(&soup), receiver_(receiver), source_(source), items_(items), most_(most) {
  events_ = visual_events(soup, receiver, source, items, complete_);
  analytic_ = is_one_convex_body(soup, items);
  const std::vector<Vec3> loop = corners_of(soup, receiver);
  find_contacts();
  std::vector<AreaCell> shapes;
  for (const AreaCell& shape : cells_of(loop)) add_about_contacts(shape, shapes);
  for (const AreaCell& shape : shapes) {
    Cell cell;
    cell.shape = shape;
    for (std::uint32_t e = 0; e < events_.size(); ++e) {
      if (events_[e].concerns(shape.loop())) cell.uncut.push_back(e);
    }
    area_ += shape.area();
    cells_.push_back(std::move(cell));
  }
}

void ObstructedExchange::find_contacts() {
  const Plane& plane = soup_->facets()[receiver_.facet].plane;
  const double size = norm(plane.normal);
  const auto add = [&](const Vec3& v) {
    const Vec3 w = v - plane.origin;
    if (std::fabs(dot(plane.normal, w)) <= 1e-12 * size * norm(w)) contacts_.push_back(v);
  };
  for (const Vec3& v : corners_of(*soup_, source_)) add(v);
  const auto facets = static_cast<std::uint32_t>(soup_->facets().size());
  for (const std::uint32_t item : items_) {
    if (item < facets) {
      for (const Corner& c : soup_->corners(soup_->facets()[item])) add(c.at);
    } else {
      for (const std::uint32_t v : soup_->shells()[item - facets].vertices) add(soup_->vertices()[v]);
    }
  }
}

/// Appends the cell; if it touches contacts, as triangles that have one of them at their last corner or none at all.
void ObstructedExchange::add_about_contacts(const AreaCell& shape, std::vector<AreaCell>& shapes) const {
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

void ObstructedExchange::measure(Viewpoint& view, Cell& cell, int order, double tolerance) {
  cell.order = order;
  gauss_points(cell.shape, cell.order, scratch_);
  const Vec3& normal = soup_->facets()[receiver_.facet].plane.normal;
  const double area = cell.shape.area();
  const double point_tolerance = std::max(kPointTolerance, kCellShare * tolerance / area);
  const std::uint64_t extended_before = view.extended_count();
  weighted_.clear();
  cell.integral = cell.point_error = 0;
  for (const WeightedPoint& p : scratch_) {
    view.look_from({p.point, normal, receiver_.facet});
    const PointFormFactor f = view.form_factor(source_, items_, point_tolerance);
    const double F = f.side == Side::front ? f.F : 0;
    weighted_.push_back(p.weight * F);
    cell.integral += p.weight * F;
    if (f.side == Side::front) cell.point_error += p.weight * f.error;
  }
  points_ += scratch_.size() + kExtendedCost * (view.extended_count() - extended_before);
  // Rounding: of each weight and product, and of the sum.
  cell.point_error += (16 + static_cast<double>(scratch_.size())) * kRoundoff * cell.integral;
  const Truncation truncation = truncation_of(weighted_, cell.order);
  cell.error = analytic_ ? truncation.error : std::max(truncation.error, 0.5 * truncation.last);
  cell.fall = truncation.fall;
  // Four points tell little of what is seen, but where each of them sees nothing nothing is seen.
  if (cell.order == kScoutOrder && cell.integral > 0) {
    cell.error = cell.integral;
    cell.fall = std::clamp(cell.fall, 0.05, 0.3);
  }
  if (!cell.uncut.empty() || !complete_) cell.error += kUnnoticed * most_ * area;
}

/// The cell cut along the event that divides it most evenly; without events, halved.
std::vector<ObstructedExchange::Cell> ObstructedExchange::parts_of(const Cell& cell) const {
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
  } else {
    const auto [one, other] = bisect(cell.shape);
    shapes = {one, other};
  }
  std::vector<AreaCell> arranged;
  for (const AreaCell& shape : shapes) add_about_contacts(shape, arranged);
  std::vector<Cell> parts;
  for (const AreaCell& shape : arranged) {
    Cell part;
    part.shape = shape;
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
    std::vector<Cell> parts = parts_of(cells_[first]);
    cells_[first] = std::move(parts[0]);
    for (std::size_t k = 1; k < parts.size(); ++k) cells_.push_back(std::move(parts[k]));
  }
}

void ObstructedExchange::refine(Viewpoint& view, double tolerance, std::uint64_t points) {
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
      measure(view, cells_[c], analytic_ ? kScoutOrder : kFirstOrderAcross, tolerance);
      running_error_ += cells_[c].error + cells_[c].point_error;
      push(c);
    }
  }
  while (running_error_ > tolerance && points_ < points && !heap_.empty()) {
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
    std::vector<Cell> parts;
    if (old.uncut.empty() && order <= kHighestOrder) {
      parts.push_back(std::move(cells_[worst]));
    } else {
      parts = parts_of(old);
      order = old.uncut.empty() ? kOrderOfHalves : kFirstOrder;
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
