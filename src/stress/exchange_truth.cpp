#include "src/stress/exchange_truth.h"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <numbers>
#include <queue>
#include <stdexcept>

#include "src/stress/placement.h"
#include "src/stress/projected_area.h"
#include "src/stress/truth_body.h"

namespace exitance {
namespace {

using namespace truth;

constexpr Real kPi = std::numbers::pi_v<Real>;
/// In units of the configuration's size: by how much an event may seem hidden before it is left out.
constexpr Real kTouch = 1e-12L;

using Rule = boost::math::quadrature::gauss_kronrod<Real, 21>;
using Gauss = boost::math::quadrature::gauss<Real, 10>;

struct Estimate {
  Real value = 0, error = 0;
};

/// Gauss–Kronrod with 21 points. The error is QUADPACK's.
template <class Function>
Estimate kronrod(const Function& f, Real a, Real b) {
  const auto& x = Rule::abscissa();
  const auto& w = Rule::weights();
  const auto& g = Gauss::weights();
  const Real middle = (a + b) / 2, half = (b - a) / 2;
  std::array<Real, 21> values{};
  Real kronrod_sum = 0, gauss_sum = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    for (const Real sign : {1, -1}) {
      if (k == 0 && sign < 0) continue;
      const Real v = f(middle + sign * half * x[k]);
      values[count++] = v;
      kronrod_sum += w[k] * v;
      if (k % 2 == 1) gauss_sum += g[k / 2] * v;
    }
  }
  Real spread = 0;
  count = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    for (int s = 0; s < (k == 0 ? 1 : 2); ++s) spread += w[k] * std::fabs(values[count++] - kronrod_sum / 2);
  }
  const Real apart = std::fabs(kronrod_sum - gauss_sum);
  Real error = apart;
  if (spread > 0) error = std::min(apart, spread * std::pow(200 * apart / spread, 1.5L));
  return {half * kronrod_sum, half * error};
}

class Truth {
 public:
  Truth(std::span<const Vec3> receiver, std::span<const Vec3> source, std::span<const ConvexBody> occluders,
        const TruthOptions& options);
  ExchangeTruth integrate();
  ExchangeTruth sample(std::uint64_t seed, long directions, long step);
  Real smaller_area() const { return smaller_; }

 private:
  /// A body's edge at a fixed longitude: points along it are (x, cos β (a + b x) − sin β (c + d x)).
  struct Line {
    std::size_t body;
    Real low, high, a, b, c, d;
    std::size_t from, to;
  };

  void set_longitude(Real alpha);
  bool shows(Real beta, Real x, Real y) const;
  void find_latitudes();
  Real lit_area(Real beta);
  Estimate latitude_integral(Real alpha);
  std::vector<Real> longitudes();

  TruthOptions options_;
  std::vector<Body> bodies_;  ///< receiver, source, occluders
  Side receiver_plane_, source_plane_;
  Real size_ = 0, smaller_ = 0;
  Point u_, v_, w_;  ///< w: axis of the coordinates
  bool empty_ = false;

  Point e1_, toward_;  ///< at the longitude
  std::vector<std::vector<Real>> x_, h_, z_;
  std::vector<Line> lines_;
  std::vector<std::pair<std::size_t, Real>> upright_;  ///< bodies and x of edges that a line x = const holds
  std::vector<Real> latitudes_;
  long evaluations_ = 0;
  std::vector<Spot> spots_;
  std::vector<Area> pieces_, rest_;
  Area shadow_, inside_, outside_, remaining_;
};

Truth::Truth(std::span<const Vec3> receiver, std::span<const Vec3> source, std::span<const ConvexBody> occluders,
             const TruthOptions& options)
    : options_(options) {
  const Vec3 o = receiver[0];
  const auto local = [&](const Vec3& p) { return Point{Real(p.x) - o.x, Real(p.y) - o.y, Real(p.z) - o.z}; };
  const auto face_of = [&](std::span<const Vec3> loop) {
    Face face;
    for (const Vec3& p : loop) face.push_back(local(p));
    return face;
  };
  Face r = face_of(receiver), s = face_of(source);
  receiver_plane_ = plane_of(r);
  source_plane_ = plane_of(s);
  const auto doubled = [](const Face& f) {
    Point n;
    for (std::size_t k = 1; k + 1 < f.size(); ++k) n = n + cross(f[k] - f[0], f[k + 1] - f[0]);
    return std::sqrt(dot(n, n));
  };
  smaller_ = std::min(doubled(r), doubled(s)) / 2;
  for (const Face* f : {&r, &s}) {
    for (const Point& p : *f) size_ = std::max({size_, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  }
  // Faces of one side of a turned body leave its plane by some roundings of their coordinates.
  const Real rounding = 1e-14L * size_;
  r = clip(r, source_plane_, rounding);
  s = clip(s, receiver_plane_, rounding);
  empty_ = r.empty() || s.empty();
  if (empty_) return;
  bodies_.push_back(body_of({r}));
  bodies_.push_back(body_of({s}));
  for (const ConvexBody& occluder : occluders) {
    std::vector<Face> faces;
    bool above = false, before = false;
    for (const auto& loop : occluder) {
      Face f = clip(clip(face_of(loop), receiver_plane_, rounding), source_plane_, rounding);
      for (const Point& p : f) {
        above = above || receiver_plane_.at(p) > rounding;
        before = before || source_plane_.at(p) > rounding;
      }
      if (!f.empty()) faces.push_back(std::move(f));
    }
    if (!above || !before) continue;
    Body body = body_of(faces);
    if (!is_beside(body, r, s, rounding)) bodies_.push_back(std::move(body));
  }

  // An axis in both planes makes their horizons meridians.
  Point axis = cross(receiver_plane_.normal, source_plane_.normal);
  if (dot(axis, axis) < 1e-12L) axis = r[1] - r[0];
  const Point n = receiver_plane_.normal, t = cross(n, unit(axis));
  const Point base = unit(axis);
  if (options.axis == 0)
    w_ = base;
  else
    w_ = unit(base + (0.61L * options.axis) * t + (0.37L * options.axis) * n);
  u_ = unit(std::fabs(dot(w_, n)) < 0.9L ? n - dot(n, w_) * w_ : t - dot(t, w_) * w_);
  v_ = cross(w_, u_);
}

void Truth::set_longitude(Real alpha) {
  toward_ = std::cos(alpha) * u_ + std::sin(alpha) * v_;
  e1_ = std::cos(alpha) * v_ - std::sin(alpha) * u_;
  x_.resize(bodies_.size());
  h_.resize(bodies_.size());
  z_.resize(bodies_.size());
  lines_.clear();
  upright_.clear();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Body& body = bodies_[k];
    x_[k].clear();
    h_[k].clear();
    z_[k].clear();
    for (const Point& p : body.points) {
      x_[k].push_back(dot(p, e1_));
      h_[k].push_back(dot(p, toward_));
      z_[k].push_back(dot(p, w_));
    }
    for (const auto& [p, q] : body.edges) {
      const bool swap = x_[k][p] > x_[k][q];
      const std::size_t i = swap ? q : p, j = swap ? p : q;
      const Real low = x_[k][i], high = x_[k][j], width = high - low;
      if (!(width > kTouch * size_)) {
        upright_.push_back({k, low});
        continue;
      }
      const Real b = (z_[k][j] - z_[k][i]) / width, d = (h_[k][j] - h_[k][i]) / width;
      lines_.push_back({k, low, high, z_[k][i] - b * low, b, h_[k][i] - d * low, d, i, j});
    }
  }
}

/// Whether a projected point lies on receiver and source, borders included, and not inside any shadow.
bool Truth::shows(Real beta, Real x, Real y) const {
  const Real c = std::cos(beta), s = std::sin(beta), near = kTouch * size_;
  std::size_t k = 0;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    Real low = INFINITY, high = -INFINITY;
    const auto take = [&](Real at) {
      low = std::min(low, at);
      high = std::max(high, at);
    };
    bool at_end = true;
    for (; k < lines_.size() && lines_[k].body == body; ++k) {
      const Line& l = lines_[k];
      if (x < l.low - near || x > l.high + near) continue;
      if (x > l.low + near && x < l.high - near) at_end = false;
      const Real at = std::clamp(x, l.low, l.high);
      // By its ends: steep lines lose less.
      const Real t = (at - l.low) / (l.high - l.low);
      const Real y0 = c * z_[body][l.from] - s * h_[body][l.from], y1 = c * z_[body][l.to] - s * h_[body][l.to];
      take(y0 + t * (y1 - y0));
    }
    if (body < 2) {
      if (!(low <= high) || y < low - near || y > high + near) return false;
    } else if (!at_end && y > low + near && y < high - near) {
      return false;
    }
  }
  return true;
}

void Truth::find_latitudes() {
  latitudes_ = {-kPi / 2, kPi / 2};
  const auto add = [&](Real up, Real along, Real x, Real z, Real h) {
    if (!(std::fabs(along) > 1e-18L * size_)) return;
    const Real beta = std::atan2(along > 0 ? up : -up, std::fabs(along));
    if (shows(beta, x, std::cos(beta) * z - std::sin(beta) * h)) latitudes_.push_back(beta);
  };
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    for (std::size_t p = 0; p < bodies_[body].points.size(); ++p) {
      const Real x = x_[body][p], z = z_[body][p], h = h_[body][p];
      for (const Line& l : lines_) {
        if (x < l.low || x > l.high || (l.body == body && (l.from == p || l.to == p))) continue;
        const Real t = (x - l.low) / (l.high - l.low);
        const auto &zs = z_[l.body], &hs = h_[l.body];
        add(z - (zs[l.from] + t * (zs[l.to] - zs[l.from])), h - (hs[l.from] + t * (hs[l.to] - hs[l.from])), x, z, h);
      }
    }
  }
  // Three edges of different bodies, or two of one body and one of another, are a vertex and an edge.
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    for (std::size_t j = i + 1; j < lines_.size(); ++j) {
      if (lines_[i].body == lines_[j].body) continue;
      const Line &l = lines_[i], &m = lines_[j];
      const Real low_lm = std::max(l.low, m.low), high_lm = std::min(l.high, m.high);
      if (!(low_lm < high_lm)) continue;
      const Real a1 = m.a - l.a, b1 = m.b - l.b, c1 = m.c - l.c, d1 = m.d - l.d;
      for (const auto& [body, x] : upright_) {
        if (body == l.body || body == m.body || x < low_lm || x > high_lm) continue;
        add(a1 + b1 * x, c1 + d1 * x, x, l.a + l.b * x, l.c + l.d * x);
      }
      for (std::size_t k = j + 1; k < lines_.size(); ++k) {
        const Line& n = lines_[k];
        if (n.body == m.body || n.body == l.body) continue;
        const Real low = std::max(low_lm, n.low), high = std::min(high_lm, n.high);
        if (!(low < high)) continue;
        const Real a2 = n.a - l.a, b2 = n.b - l.b, c2 = n.c - l.c, d2 = n.d - l.d;
        // (a1 + b1 x) (c2 + d2 x) = (a2 + b2 x) (c1 + d1 x)
        const Real A = b1 * d2 - b2 * d1, B = (a1 * d2 + b1 * c2 - a2 * d1 - b2 * c1) / 2, C = a1 * c2 - a2 * c1;
        const Real root = B * B - A * C;
        if (root < 0) continue;
        const Real q = -(B + std::copysign(std::sqrt(root), B));
        for (const Real x : {A != 0 ? q / A : INFINITY, q != 0 ? C / q : INFINITY}) {
          if (!(x >= low && x <= high)) continue;
          const Real up1 = a1 + b1 * x, along1 = c1 + d1 * x, up2 = a2 + b2 * x, along2 = c2 + d2 * x;
          const bool first = std::fabs(up1) + std::fabs(along1) > std::fabs(up2) + std::fabs(along2);
          add(first ? up1 : up2, first ? along1 : along2, x, l.a + l.b * x, l.c + l.d * x);
        }
      }
    }
  }
  std::ranges::sort(latitudes_);
}

/// Of receiver ∩ source \ shadows, at the longitude.
Real Truth::lit_area(Real beta) {
  const Real c = std::cos(beta), s = std::sin(beta);
  const Point d = c * toward_ + s * w_;
  if (dot(d, receiver_plane_.normal) <= 0 || dot(d, source_plane_.normal) >= 0) return 0;
  ++evaluations_;
  const auto project = [&](std::size_t body, Area& out) {
    spots_.clear();
    for (std::size_t p = 0; p < x_[body].size(); ++p)
      spots_.push_back({x_[body][p], c * z_[body][p] - s * h_[body][p]});
    hull(spots_, out);
  };
  project(0, remaining_);
  project(1, shadow_);
  if (remaining_.size() < 3 || shadow_.size() < 3) return 0;
  for (std::size_t k = 0; k < shadow_.size() && !remaining_.empty(); ++k) {
    split(remaining_, shadow_[k], shadow_[(k + 1) % shadow_.size()], inside_, outside_);
    std::swap(remaining_, inside_);
  }
  pieces_.clear();
  if (!remaining_.empty()) pieces_.push_back(remaining_);
  for (std::size_t body = 2; body < bodies_.size() && !pieces_.empty(); ++body) {
    project(body, shadow_);
    if (shadow_.size() < 3) continue;
    rest_.clear();
    for (const Area& piece : pieces_) {
      bool apart = false;
      for (std::size_t k = 0; k < shadow_.size() && !apart; ++k) {
        const Spot &a = shadow_[k], &b = shadow_[(k + 1) % shadow_.size()];
        apart = std::ranges::all_of(piece, [&](const Spot& p) { return left(a, b, p) <= 0; });
      }
      if (apart) {
        rest_.push_back(piece);
        continue;
      }
      remaining_ = piece;
      for (std::size_t k = 0; k < shadow_.size() && !remaining_.empty(); ++k) {
        split(remaining_, shadow_[k], shadow_[(k + 1) % shadow_.size()], inside_, outside_);
        if (!outside_.empty()) rest_.push_back(outside_);
        std::swap(remaining_, inside_);
      }
    }
    std::swap(pieces_, rest_);
  }
  Real sum = 0;
  for (const Area& piece : pieces_) sum += area(piece);
  return sum;
}

Estimate Truth::latitude_integral(Real alpha) {
  set_longitude(alpha);
  find_latitudes();
  const auto f = [&](Real beta) { return std::cos(beta) * lit_area(beta); };
  // Panels are as few as the visible events; each holds one analytic function.
  struct Panel {
    Real a, b;
    int depth;
  };
  std::vector<Panel> panels;
  for (std::size_t k = 0; k + 1 < latitudes_.size(); ++k) {
    if (latitudes_[k + 1] > latitudes_[k]) panels.push_back({latitudes_[k], latitudes_[k + 1], 0});
  }
  Estimate sum;
  const Real enough = options_.tolerance * smaller_ / 100;
  while (!panels.empty()) {
    const Panel p = panels.back();
    panels.pop_back();
    // Nothing is seen beyond the outermost events.
    if (p.depth == 0 && f((p.a + p.b) / 2) == 0 && f(p.a + 0.3L * (p.b - p.a)) == 0) continue;
    const Estimate e = kronrod(f, p.a, p.b);
    if (e.error <= enough || p.depth > 12 || p.b - p.a < 1e-14L) {
      sum.value += e.value;
      sum.error += e.error;
    } else {
      const Real middle = (p.a + p.b) / 2;
      panels.push_back({p.a, middle, p.depth + 1});
      panels.push_back({middle, p.b, p.depth + 1});
    }
  }
  return sum;
}

std::vector<Real> Truth::longitudes() {
  std::vector<Real> found{-kPi, kPi};
  const auto try_direction = [&](Point d, const Point& through) {
    const Real size = std::sqrt(dot(d, d)), up = dot(d, receiver_plane_.normal), into = -dot(d, source_plane_.normal);
    if (up + into < 0) d = Real(-1) * d;
    const Real along = std::hypot(dot(d, u_), dot(d, v_));
    if (!(along > 1e-15L * size)) return;
    const Real alpha = std::atan2(dot(d, v_), dot(d, u_)), beta = std::atan2(dot(d, w_), along);
    set_longitude(alpha);
    const Real x = dot(through, e1_), y = std::cos(beta) * dot(through, w_) - std::sin(beta) * dot(through, toward_);
    if (!shows(beta, x, y)) return;
    found.push_back(alpha);
    // Along a horizon, rounding may have turned it round.
    if (std::min(std::fabs(up), std::fabs(into)) < 1e-12L * size)
      found.push_back(alpha > 0 ? alpha - kPi : alpha + kPi);
  };
  struct Edge {
    std::size_t body;
    Point a, b;
  };
  std::vector<Edge> edges;
  std::vector<std::pair<std::size_t, Point>> points;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    for (const Point& p : bodies_[k].points) points.emplace_back(k, p);
    for (const auto& [i, j] : bodies_[k].edges) edges.push_back({k, bodies_[k].points[i], bodies_[k].points[j]});
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const Point d = points[j].second - points[i].second;
      if (dot(d, d) > 1e-30L * size_ * size_) try_direction(d, points[i].second);
    }
  }
  for (const auto& point : points) {
    const std::size_t body = point.first;
    const Point& p = point.second;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Edge& e = edges[i];
      const Point along = e.b - e.a, to = p - e.a;
      const Point n = cross(e.a - p, e.b - p);
      if (dot(n, n) < 1e-30L * dot(along, along) * size_ * size_) continue;
      // An edge along the axis: a vertex passes over it at one longitude, at any latitude.
      const Point tilt = cross(along, w_);
      if (dot(tilt, tilt) < 1e-28L * dot(along, along)) {
        const Real alpha = std::atan2(dot(to, v_), dot(to, u_));
        found.push_back(alpha);
        found.push_back(alpha > 0 ? alpha - kPi : alpha + kPi);
        continue;
      }
      for (std::size_t j = i + 1; j < edges.size(); ++j) {
        const Edge& f = edges[j];
        if (e.body == body || f.body == body || e.body == f.body) continue;
        const Point m = cross(f.a - p, f.b - p), d = cross(n, m);
        const Real length = dot(d, d);
        if (length < 1e-28L * dot(n, n) * dot(m, m)) continue;
        const auto meets = [&](const Edge& g) {
          const Point a = cross(g.a - p, d), b = cross(g.b - p, d);
          return dot(a, b) <= 0;
        };
        if (meets(e) && meets(f)) try_direction(d, p);
      }
    }
  }
  std::ranges::sort(found);
  std::vector<Real> apart;
  for (const Real alpha : found) {
    if (apart.empty() || alpha - apart.back() > 1e-13L) apart.push_back(alpha);
  }
  return apart;
}

ExchangeTruth Truth::integrate() {
  ExchangeTruth truth;
  if (empty_) return truth;
  struct Panel {
    Real a, b, value, error;
    bool operator<(const Panel& o) const { return error < o.error; }
  };
  Real inner_error = 0;
  const auto f = [&](Real alpha) {
    const Estimate e = latitude_integral(alpha);
    inner_error = std::max(inner_error, e.error);
    return e.value;
  };
  std::priority_queue<Panel> panels;
  Real error = 0;
  const auto add = [&](Real a, Real b) {
    const Estimate e = kronrod(f, a, b);
    panels.push({a, b, e.value, e.error});
    error += e.error;
  };
  const std::vector<Real> ends = longitudes();
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) add(ends[k], ends[k + 1]);
  const Real enough = options_.tolerance * smaller_ * kPi;
  for (int step = 0; step < 400 && error > enough && !panels.empty(); ++step) {
    const Panel p = panels.top();
    panels.pop();
    error -= p.error;
    add(p.a, (p.a + p.b) / 2);
    add((p.a + p.b) / 2, p.b);
  }
  std::vector<Real> values;
  error = 0;
  for (; !panels.empty(); panels.pop()) {
    values.push_back(panels.top().value);
    error += panels.top().error;
  }
  std::ranges::sort(values);
  Real sum = 0;
  for (const Real v : values) sum += v;
  truth.integral = sum / kPi;
  // Ten times, because the rule's estimate supposes more smoothness than there is where events have been missed.
  truth.error = 10 * (error + 2 * kPi * inner_error) / kPi + 1e-17L * truth.integral + 1e-19L * smaller_;
  truth.evaluations = evaluations_;
  return truth;
}

/// Where all lines from receiver to source rise steeply enough, over the part of the plane at height 1 that they meet;
/// else over the disc below the hemisphere.
ExchangeTruth Truth::sample(std::uint64_t seed, long directions, long step) {
  ExchangeTruth truth;
  if (empty_) return truth;
  constexpr int kShifts = 8;
  constexpr Real kSteep = 0.3L;
  const Point n = receiver_plane_.normal, s = unit(cross(n, std::fabs(n.x) < 0.6L ? Point{1, 0, 0} : Point{0, 1, 0})),
              t = cross(n, s);
  bool is_steep = true;
  Spot low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (const Point& p : bodies_[0].points) {
    for (const Point& q : bodies_[1].points) {
      const Point d = q - p;
      const Real up = dot(d, n);
      is_steep = is_steep && up > kSteep * std::sqrt(dot(d, d));
      if (!is_steep) break;
      low = {std::min(low.x, dot(d, s) / up), std::min(low.y, dot(d, t) / up)};
      high = {std::max(high.x, dot(d, s) / up), std::max(high.y, dot(d, t) / up)};
    }
  }
  const auto value_at = [&](Real a, Real b) {
    Point d;
    Real weight = 0;
    if (is_steep) {
      const Real x = low.x + a * (high.x - low.x), y = low.y + b * (high.y - low.y), square = 1 + x * x + y * y;
      d = (1 / std::sqrt(square)) * (n + x * s + y * t);
      weight = (high.x - low.x) * (high.y - low.y) / (kPi * square * std::sqrt(square));
    } else {
      const Real up = std::sqrt(1 - a), along = std::sqrt(a);
      d = up * n + (along * std::cos(2 * kPi * b)) * s + (along * std::sin(2 * kPi * b)) * t;
      weight = up > 0 ? 1 / up : 0;
    }
    set_longitude(std::atan2(dot(d, v_), dot(d, u_)));
    return weight * lit_area(std::asin(std::clamp(dot(d, w_), Real(-1), Real(1))));
  };
  Random random(seed);
  Real sum = 0, squares = 0, largest = 0;
  for (int shift = 0; shift < kShifts; ++shift) {
    const Real a = random.real(0, 1), b = random.real(0, 1);
    Real mean = 0;
    const auto count = static_cast<Real>(directions);
    for (long k = 0; k < directions; ++k) {
      const Real value = value_at(std::fmod(a + static_cast<Real>(k) / count, Real(1)),
                                  std::fmod(b + static_cast<Real>(k * step % directions) / count, Real(1)));
      mean += value / count;
      largest = std::max(largest, value);
    }
    sum += mean;
    squares += mean * mean;
  }
  truth.integral = sum / kShifts;
  const Real variance = std::max(Real(0), squares / kShifts - truth.integral * truth.integral) / (kShifts - 1);
  truth.standard_error = std::sqrt(variance);
  truth.error = 6 * truth.standard_error + 6 * largest / static_cast<Real>(kShifts * directions);
  truth.evaluations = evaluations_;
  return truth;
}

}  // namespace

ExchangeTruth sampled_exchange(std::span<const Vec3> receiver, std::span<const Vec3> source,
                               std::span<const ConvexBody> occluders, std::uint64_t seed) {
  constexpr Real kEnough = 1e-5L;
  Truth truth(receiver, source, occluders, {});
  const ExchangeTruth coarse = truth.sample(seed, 1597, 987);  // Fibonacci numbers
  return 6 * coarse.standard_error <= kEnough * truth.smaller_area() ? coarse : truth.sample(seed, 17711, 10946);
}

ExchangeTruth exchange_truth(std::span<const Vec3> receiver, std::span<const Vec3> source,
                             std::span<const ConvexBody> occluders, const TruthOptions& options) {
  return Truth(receiver, source, occluders, options).integrate();
}

}  // namespace exitance
