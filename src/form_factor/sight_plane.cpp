#include "src/form_factor/sight_plane.h"

#include <algorithm>
#include <cmath>

namespace exitance {

void LineStretch::add(double t) {
  from = std::min(from, t);
  to = std::max(to, t);
}
void LineStretch::add(const LineStretch& other) {
  from = std::min(from, other.from);
  to = std::max(to, other.to);
}
void LineStretch::keep_within(const LineStretch& other) {
  from = std::max(from, other.from);
  to = std::min(to, other.to);
}

SightPlane::SightPlane(const CutPlane& receiver, const CutPlane& plane, double blur)
    : receiver_(receiver), plane_(plane), blur_(blur * norm(plane.normal)) {
  along_ = normalized(cross(receiver_.normal, plane.normal));
}

SightPlane::Place SightPlane::place_of(const Vec3& v) const {
  return {dot(along_, v - plane_.point), receiver_.at(v)};
}

std::optional<std::array<Vec3, 2>> SightPlane::chord_of(std::span<const Vec3> loop, bool across) const {
  std::optional<std::array<Vec3, 2>> chord;
  bool below = false, above = false;
  const auto add = [&](const Vec3& v) {
    if (!chord) chord = {v, v};
    auto& [one, other] = *chord;
    // Of three points in line the two that are farthest apart.
    const double apart = norm(other - one), from_one = norm(v - one), from_other = norm(v - other);
    if (from_one >= std::max(apart, from_other)) {
      other = v;
    } else if (from_other > apart) {
      one = v;
    }
  };
  const auto value = [&](const Vec3& v) {
    const double d = plane_.at(v);
    return std::fabs(d) <= blur_ * norm(v - plane_.point) ? 0 : d;
  };
  double before = value(loop.back());
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 &a = k == 0 ? loop.back() : loop[k - 1], &b = loop[k];
    const double d = value(b);
    below = below || d < 0;
    above = above || d > 0;
    if (d == 0) add(b);
    if (before * d < 0) add(a + (before / (before - d)) * (b - a));
    before = d;
  }
  if (across && !(below && above)) return {};
  return chord;
}

LineStretch SightPlane::through(const Place& pivot, const Place& a, const Place& b, Order order) const {
  const double h = pivot.height;
  LineStretch found;
  // The part that counts, by its heights.
  const double low = order == Order::before ? 0 : h, high = order == Order::before ? h : INFINITY;
  const Place &lower = a.height <= b.height ? a : b, &upper = a.height <= b.height ? b : a;
  if (upper.height < low || lower.height > high) return found;
  const auto at_height = [&](double height) {
    const double share = (height - lower.height) / (upper.height - lower.height);
    return lower.along + share * (upper.along - lower.along);
  };
  const auto add = [&](double along, double height) {
    const double beside = along - pivot.along, below = h - height;
    if (below != 0) {
      found.add(pivot.along + beside * (h / below));
    } else if (beside != 0) {
      found.add(std::copysign(INFINITY, order == Order::before ? beside : -beside));
    } else {
      found.add({-INFINITY, INFINITY});
    }
  };
  add(lower.height < low ? at_height(low) : lower.along, std::max(lower.height, low));
  add(upper.height > high ? at_height(high) : upper.along, std::min(upper.height, high));
  return found;
}

void take_out(std::vector<LineStretch>& stretches, const LineStretch& gap) {
  if (gap.empty()) return;
  std::vector<LineStretch> left;
  for (const LineStretch& s : stretches) {
    if (gap.to <= s.from || gap.from >= s.to) {
      left.push_back(s);
      continue;
    }
    if (s.from < gap.from) left.push_back({s.from, gap.from});
    if (s.to > gap.to) left.push_back({gap.to, s.to});
  }
  stretches = std::move(left);
}

}  // namespace exitance
