#include "src/form_factor/area_mean.h"

#include <algorithm>
#include <numeric>

namespace exitance {
namespace {

/// What the difference of two rules is multiplied by to make an error. That of low orders can be small by chance, and
/// is no bound where the integrand is not smooth.
constexpr double kLowOrderSafety = 10, kHighOrderSafety = 2;
/// What a cell with uncut events may hide from its sample points, as a share of the unobstructed value.
constexpr double kUnnoticed = 4e-3;
/// Proven error of a point's value beyond which extended precision is asked: this, or what the cell's share of the
/// tolerance allows. Cells near a contact are tiny, and there double precision proves little.
constexpr double kPointTolerance = 1e-13, kCellShare = 1e-3;
/// The lower order of each pair of rules.
constexpr int lower(std::uint32_t order) {
  return order == 4 ? 3 : 6;
}

/// How many points a value in extended precision counts for: it takes some 50 times as long.
constexpr std::uint64_t kExtendedCost = 5;

}  // namespace

AreaMean::AreaMean(const PolygonSoup& soup, std::uint32_t receiver_polygon, std::uint32_t source_polygon)
    : soup_(&soup), source_(source_polygon), first_facet_(soup.first_facet(receiver_polygon)) {
  for (std::uint32_t r = first_facet_; r < soup.first_facet(receiver_polygon + 1); ++r) {
    events_.emplace_back();
    bool faces = false;
    for (std::uint32_t s = soup.first_facet(source_polygon); s < soup.first_facet(source_polygon + 1); ++s) {
      faces = faces || face_each_other(soup, r, s);
    }
    if (!faces) continue;
    events_.back() = visual_events(soup, r, source_polygon, occluders_between(soup, r, source_polygon));
    std::vector<Vec3> loop;
    for (const Corner& c : soup.corners(soup.facets()[r])) loop.push_back(soup.vertices()[c.vertex]);
    for (const AreaCell& shape : cells_of(loop)) {
      Cell cell;
      cell.shape = shape;
      cell.facet = r;
      for (std::uint32_t e = 0; e < events_.back().size(); ++e) {
        if (events_.back()[e].concerns(shape)) cell.uncut.push_back(e);
      }
      cells_.push_back(std::move(cell));
    }
  }
}

double AreaMean::rule(AreaViews& views, const Cell& cell, int order, double tolerance, double& point_error) {
  gauss_points(cell.shape, order, scratch_);
  const Vec3& normal = soup_->facets()[cell.facet].plane.normal;
  const double point_tolerance = std::max(kPointTolerance, kCellShare * tolerance / cell.shape.area());
  const std::uint64_t extended_before = views.view.extended_count();
  double sum = 0;
  point_error = 0;
  for (const WeightedPoint& p : scratch_) {
    views.view.look_from({p.point, normal, cell.facet});
    for (std::uint32_t s = soup_->first_facet(source_); s < soup_->first_facet(source_ + 1); ++s) {
      const PointFormFactor f = views.view.form_factor({s, {}}, point_tolerance);
      if (f.side != Side::front) continue;
      sum += p.weight * f.F;
      point_error += p.weight * f.error;
    }
  }
  points_ += scratch_.size() + kExtendedCost * (views.view.extended_count() - extended_before);
  return sum;
}

void AreaMean::measure(AreaViews& views, Cell& cell, double tolerance) {
  double ignored = 0;
  const double coarse = rule(views, cell, lower(cell.order), tolerance, ignored);
  cell.integral = rule(views, cell, static_cast<int>(cell.order), tolerance, cell.point_error);
  // Rounding: of each weight and product, and of the sum of up to 64 of them.
  cell.point_error += 80 * kRoundoff * cell.integral;
  cell.error =
      (cell.order == 4 || !cell.uncut.empty() ? kLowOrderSafety : kHighOrderSafety) * std::fabs(cell.integral - coarse);
  if (!cell.uncut.empty()) {
    const auto loop = cell.shape.loop();
    const Vec3 middle = 0.25 * (cell.shape.corner[0] + cell.shape.corner[1] + cell.shape.corner[2] +
                                (loop.size() == 4 ? cell.shape.corner[3] : cell.shape.corner[2]));
    views.open.look_from({middle, soup_->facets()[cell.facet].plane.normal, cell.facet});
    double most = 0;
    for (std::uint32_t s = soup_->first_facet(source_); s < soup_->first_facet(source_ + 1); ++s) {
      const PointFormFactor f = views.open.form_factor({s, {}}, 1);
      if (f.side == Side::front) most += f.F;
    }
    cell.error += kUnnoticed * most * cell.shape.area();
    ++points_;
  }
}

/// The cell cut along the event that divides it most evenly; without events, halved.
std::vector<AreaMean::Cell> AreaMean::parts_of(const Cell& cell) const {
  const auto& events = events_[cell.facet - first_facet_];
  std::vector<AreaCell> shapes;
  std::uint32_t along = kNone;
  double evenness = -1;
  for (const std::uint32_t e : cell.uncut) {
    double below = 0, above = 0;
    for (const Vec3& v : cell.shape.loop()) {
      const double d = events[e].plane.at(v);
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
    shapes = cut(cell.shape, events[along].plane);
  } else {
    const auto [one, other] = bisect(cell.shape);
    shapes = {one, other};
  }
  std::vector<Cell> parts;
  for (const AreaCell& shape : shapes) {
    Cell part;
    part.shape = shape;
    part.facet = cell.facet;
    part.order = cell.order;
    for (const std::uint32_t e : cell.uncut) {
      if (e != along && events[e].concerns(shape)) part.uncut.push_back(e);
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

void AreaMean::refine(AreaViews& views, double tolerance, std::uint64_t points) {
  const auto better = [&](std::uint32_t a, std::uint32_t b) {
    return cells_[a].error != cells_[b].error ? cells_[a].error < cells_[b].error : a < b;
  };
  const auto push = [&](std::uint32_t c) {
    heap_.push_back(c);
    std::push_heap(heap_.begin(), heap_.end(), better);
  };
  if (!started_) {
    started_ = true;
    for (std::uint32_t c = 0; c < cells_.size(); ++c) {
      measure(views, cells_[c], tolerance);
      running_error_ += cells_[c].error + cells_[c].point_error;
      push(c);
    }
  }
  while (running_error_ > tolerance && points_ < points && !heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), better);
    const std::uint32_t worst = heap_.back();
    heap_.pop_back();
    if (cells_[worst].error == 0) break;  // what is left are the points' own errors
    const Cell old = cells_[worst];
    running_error_ -= old.error + old.point_error;
    std::vector<Cell> parts;
    if (old.uncut.empty() && old.order == 4) {
      parts.push_back(old);
      parts[0].order = 8;
    } else {
      parts = parts_of(old);
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
      Cell& part = parts[k];
      measure(views, part, tolerance);
      running_error_ += part.error + part.point_error;
      std::uint32_t place = worst;
      if (k > 0) {
        place = static_cast<std::uint32_t>(cells_.size());
        cells_.emplace_back();
      }
      cells_[place] = std::move(part);
      push(place);
    }
  }
}

double AreaMean::integral() const {
  return std::accumulate(cells_.begin(), cells_.end(), 0.0, [](double sum, const Cell& c) { return sum + c.integral; });
}

double AreaMean::error() const {
  const double rounding = static_cast<double>(cells_.size()) * kRoundoff * integral();
  return std::accumulate(cells_.begin(), cells_.end(), rounding,
                         [](double sum, const Cell& c) { return sum + c.error + c.point_error; });
}

}  // namespace exitance
