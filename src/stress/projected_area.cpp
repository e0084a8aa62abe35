#include "src/stress/projected_area.h"

#include <algorithm>

namespace exitance::truth {

Real area(const Area& loop) {
  Real sum = 0;
  for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
    sum +=
        (loop[k].x - loop[0].x) * (loop[k + 1].y - loop[0].y) - (loop[k + 1].x - loop[0].x) * (loop[k].y - loop[0].y);
  }
  return sum / 2;
}

void hull(std::vector<Spot>& spots, Area& out) {
  std::ranges::sort(spots, [](const Spot& a, const Spot& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  out.clear();
  for (int chain = 0; chain < 2; ++chain) {
    const std::size_t base = out.size();
    for (const Spot& s : spots) {
      while (out.size() >= base + 2 && left(out[out.size() - 2], out.back(), s) <= 0) out.pop_back();
      out.push_back(s);
    }
    out.pop_back();
    std::ranges::reverse(spots);
  }
}

void split(const Area& loop, const Spot& a, const Spot& b, Area& inside, Area& outside) {
  inside.clear();
  outside.clear();
  Real before = left(a, b, loop.back());
  Spot from = loop.back();
  for (const Spot& p : loop) {
    const Real now = left(a, b, p);
    if ((before > 0 && now < 0) || (before < 0 && now > 0)) {
      const Real t = before / (before - now);
      const Spot at{from.x + t * (p.x - from.x), from.y + t * (p.y - from.y)};
      inside.push_back(at);
      outside.push_back(at);
    }
    if (now >= 0) inside.push_back(p);
    if (now <= 0) outside.push_back(p);
    before = now;
    from = p;
  }
  if (inside.size() < 3) inside.clear();
  if (outside.size() < 3) outside.clear();
}

}  // namespace exitance::truth
