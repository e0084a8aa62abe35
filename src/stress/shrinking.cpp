#include "src/stress/shrinking.h"

#include <algorithm>
#include <cmath>

namespace exitance {
namespace {

/// To so many bits.
double rounded(double v, int bits) {
  if (v == 0) return v;
  const int shift = std::ilogb(v) - bits + 1;
  return std::ldexp(std::nearbyint(std::ldexp(v, -shift)), shift);
}

class Shrinking {
 public:
  Shrinking(Question question, const std::function<bool(const Question&)>& fails, std::size_t most_tries)
      : smallest_(std::move(question)), fails_(fails), tries_left_(most_tries) {}

  Question run() {
    for (bool smaller = true; smaller && tries_left_ > 0;) {
      smaller = drop_occluders();
      smaller = drop_parts() || smaller;
      for (const int bits : {3, 6, 12, 24, 36}) smaller = round_to(bits) || smaller;
    }
    return smallest_;
  }

 private:
  template <class Change>
  bool accept(const Change& change) {
    if (tries_left_ == 0) return false;
    Question smaller = smallest_;
    if (!change(smaller) || smaller.normal == Vec3{} || !has_sound_polygons(smaller)) return false;
    --tries_left_;
    if (!fails_(smaller)) return false;
    smallest_ = std::move(smaller);
    return true;
  }

  bool drop_occluders() {
    bool any = false;
    for (std::size_t k = smallest_.occluders.size(); k-- > 0;) {
      any = accept([&](Question& q) {
              q.occluders.erase(q.occluders.begin() + static_cast<std::ptrdiff_t>(k));
              return true;
            }) ||
            any;
    }
    return any;
  }

  /// Faces of sheets, holes, vertices.
  bool drop_parts() {
    bool any = false;
    for (std::size_t o = 0; o < smallest_.occluders.size(); ++o) {
      if (smallest_.occluders[o].solid) continue;
      for (std::size_t f = smallest_.occluders[o].faces.size(); f-- > 0;) {
        any = accept([&](Question& q) {
                auto& faces = q.occluders[o].faces;
                if (faces.size() < 2) return false;
                faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(f));
                return true;
              }) ||
              any;
      }
      for (std::size_t f = 0; f < smallest_.occluders[o].faces.size(); ++f) {
        any = thin_out([o, f](Question& q) -> Polygon& { return q.occluders[o].faces[f]; }) || any;
      }
    }
    any = thin_out([](Question& q) -> Polygon& { return q.receiver; }) || any;
    return thin_out([](Question& q) -> Polygon& { return q.source; }) || any;
  }

  template <class Which>
  bool thin_out(const Which& which) {
    bool any = accept([&](Question& q) {
      if (which(q).holes.empty()) return false;
      which(q).holes.clear();
      return true;
    });
    for (std::size_t k = which(smallest_).outer.size(); k-- > 0;) {
      any = accept([&](Question& q) {
              auto& loop = which(q).outer;
              if (loop.size() < 4) return false;
              loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(k));
              return true;
            }) ||
            any;
    }
    return any;
  }

  /// All coordinates that are equal alike, so that what touches goes on touching.
  bool round_to(int bits) {
    std::vector<double> values;
    const auto collect = [&](Question& q, const auto& visit) {
      const auto visit_vertex = [&](Vec3& v) {
        for (int axis = 0; axis < 3; ++axis) visit(v[axis]);
      };
      visit_vertex(q.point);
      visit_vertex(q.normal);
      const auto visit_polygon = [&](Polygon& p) {
        std::ranges::for_each(p.outer, visit_vertex);
        for (auto& hole : p.holes) std::ranges::for_each(hole, visit_vertex);
      };
      visit_polygon(q.receiver);
      visit_polygon(q.source);
      for (Obstacle& o : q.occluders) std::ranges::for_each(o.faces, visit_polygon);
    };
    collect(smallest_, [&](double& v) { values.push_back(v); });
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    bool any = false;
    for (const double value : values) {
      if (rounded(value, bits) == value) continue;
      any = accept([&](Question& q) {
              collect(q, [&](double& v) {
                if (v == value) v = rounded(v, bits);
              });
              return true;
            }) ||
            any;
    }
    return any;
  }

  Question smallest_;
  const std::function<bool(const Question&)>& fails_;
  std::size_t tries_left_;
};

}  // namespace

Question shrink(Question question, const std::function<bool(const Question&)>& fails, std::size_t most_tries) {
  return Shrinking(std::move(question), fails, most_tries).run();
}

}  // namespace exitance
