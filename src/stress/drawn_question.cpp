#include "src/stress/drawn_question.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace exitance {
namespace {

// --- Into space ---------------------------------------------------------------------------------------------------

template <class Move>
void move_all(Obstacle& obstacle, const Move& move) {
  for (Polygon& face : obstacle.faces) {
    for (Vec3& v : face.outer) v = move(v);
    for (Loop& hole : face.holes) std::ranges::transform(hole, hole.begin(), move);
  }
}

/// Moves points at random, equal ones alike.
class Jitter {
 public:
  template <class Move>
  Vec3 operator()(const Vec3& v, const Move& move) {
    for (const auto& [from, to] : moved_) {
      if (from == v) return to;
    }
    moved_.push_back({v, move(v)});
    return moved_.back().second;
  }

 private:
  std::vector<std::pair<Vec3, Vec3>> moved_;
};

template <class Move>
void move_all(Polygon& polygon, const Move& move) {
  Obstacle sheet{{polygon}, false};
  move_all(sheet, move);
  polygon = std::move(sheet.faces[0]);
}

/// Moves some of the sheets, solids, the source and the point, each as a whole: its faces stay together.
template <class Move>
void depart(PointQuestion& question, Random& random, const Move& move) {
  for (Obstacle& obstacle : question.occluders) {
    if (random.whole(0, 3) == 0) continue;
    Jitter jitter;
    move_all(obstacle, [&](const Vec3& v) { return jitter(v, move); });
  }
  if (random.whole(0, 2) == 0) {
    Jitter jitter;
    move_all(question.source, [&](const Vec3& v) { return jitter(v, move); });
  }
  if (random.whole(0, 3) == 0) question.point = move(question.point);
}

Placement random_placement(Random& random, bool is_exact) {
  static const std::array<Vec3, 3> kNear{Vec3{}, {5, -3, 7}, {0.1, 0.2, 0.3}};
  static const std::array<Vec3, 4> kFar{Vec3{1003, -2001, 1507},
                                        {1000003, -2000001, 1500007},
                                        {-100000007, 30000001, 50000003},
                                        {1000000007, -300000001, 500000003}};
  static const std::array<std::pair<const char*, double>, 9> kScales{{{"", 1},
                                                                      {"", 1},
                                                                      {"", 1},
                                                                      {"_1e-12", 1e-12},
                                                                      {"_1e-3", 1e-3},
                                                                      {"_1e12", 1e12},
                                                                      {"_2^-40", 0x1p-40},
                                                                      {"_2^400", 0x1p400},
                                                                      {"_2^-400", 0x1p-400}}};
  const bool is_far = random.whole(0, 2) == 0;
  const Vec3 origin =
      is_far ? kFar[static_cast<std::size_t>(random.whole(0, 3))] : kNear[static_cast<std::size_t>(random.whole(0, 2))];
  const auto& [scale_name, scale] = kScales[static_cast<std::size_t>(random.whole(0, 8))];
  const std::string name = (is_far ? "_far" : "") + std::string(scale_name);
  switch (random.whole(0, is_exact ? 9 : 8)) {
    case 0:
      return {"lattice" + name, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, origin, scale};
    case 1:
      return {"tilted" + name, {2, 1, -1}, {-1, 3, 1}, {1, -1, 2}, origin, scale};
    case 2:
      return {"turned" + name, {1, 2, 2}, {2, 1, -2}, {-2, 2, -1}, origin, scale};
    case 9:  // twelve bits above the smallest number
      return {"denormal", {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}, 0x1p-1066};
    default:
      return random_rotation("rotated" + name, origin, scale, random);
  }
}

/// A move of every coordinate by an ulp up, down, or not; from 0 by an ulp of the vertex's largest coordinate.
Vec3 by_an_ulp(Vec3 v, Random& random) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  for (int axis = 0; axis < 3; ++axis) {
    const int way = random.whole(-1, 1);
    if (v[axis] == 0) {
      v[axis] = way * 0x1p-53 * largest;
    } else if (way != 0) {
      v[axis] = std::nextafter(v[axis], way * std::numeric_limits<double>::infinity());
    }
  }
  return v;
}

// --- Receivers ----------------------------------------------------------------------------------------------------

/// A vector of whole numbers, brought near 1 by a power of two.
Vec3 of_size_one(const Vec3& v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  return std::ldexp(1, -std::ilogb(largest)) * v;
}

/// Beside the source, with which it shares an edge.
Polygon wall(const Polygon& source, Random& random) {
  const std::size_t n = source.outer.size(), k = static_cast<std::size_t>(random.whole(0, static_cast<int>(n) - 1));
  const Vec3 &a = source.outer[k], &b = source.outer[(k + 1) % n];
  const Vec3 along{1.0 * random.whole(-8, 8), 1.0 * random.whole(-8, 8), -1.0 * random.whole(4, 16)};
  Loop loop{b, a, a + along, b + along};
  const Vec3 normal = area_vector(loop);
  double side = 0;
  for (const Vec3& v : source.outer) side += dot(normal, v - a);
  if (side < 0) std::ranges::reverse(loop);
  return {loop, {}};
}

Polygon receiver_about(const PointQuestion& question, double size, Random& random) {
  if (random.whole(0, 5) == 0) return wall(question.source, random);
  const Vec3& n = question.normal;
  const std::array<Vec3, 3> across{Vec3{0, n.z, -n.y}, {-n.z, 0, n.x}, {n.y, -n.x, 0}};
  std::size_t axis = static_cast<std::size_t>(random.whole(0, 2));
  while (across[axis] == Vec3{}) axis = (axis + 1) % 3;
  const Vec3 u = of_size_one(across[axis]), v = of_size_one(cross(n, across[axis]));
  const auto at = [&](const Points2& points) {
    Loop loop;
    for (const auto& [x, y] : points) loop.push_back(question.point + x * u + y * v);
    return Polygon{loop, {}};
  };
  const double x0 = random.whole(-4, 0), x1 = random.whole(1, 4), y0 = random.whole(-4, 0), y1 = random.whole(1, 4);
  switch (random.whole(0, 7)) {
    case 0:
      return at({{x0, y0}, {x1, y0}, {0, y1}});
    case 1:
      return at({{0, y0}, {x1, y0}, {x1, 0}, {0, 0}, {0, y1}, {x0 - 1, y1}});
    case 2: {
      const double narrow = size > 0 ? size : 0x1p-20;
      return at({{0, y0}, {narrow, y0}, {narrow, y1}, {0, y1}});
    }
    case 3:
      return at({{-64, -64}, {64, -64}, {64, 64}, {-64, 64}});
    default:
      return at({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
  }
}

/// of_receiver: none where there is to be no receiver.
DrawnQuestion draw(const QuestionFamily& family, const Departure& departure, Random& random, Random* of_receiver) {
  constexpr int kTries = 1000;  // rounding may fold a narrow polygon
  for (int k = 0; k < kTries; ++k) {
    Stage stage(random, departure.size);
    family.set_up(stage);
    Question question{stage.question, {}};
    if (of_receiver != nullptr) question.receiver = receiver_about(question, departure.size, *of_receiver);
    const auto depart_by = [&](const auto& move_by) {
      depart(question, random, [&](const Vec3& v) { return move_by(v, random); });
      if (of_receiver == nullptr || of_receiver->whole(0, 2) == 0) return;
      Jitter jitter;
      move_all(question.receiver,
               [&](const Vec3& v) { return jitter(v, [&](const Vec3& w) { return move_by(w, *of_receiver); }); });
    };
    if (departure.size > 0 && !departure.by_an_ulp && !family.departs_by_itself) {
      depart_by([&](const Vec3& v, Random& numbers) {
        return v + departure.size * Vec3{numbers.real(-1, 1), numbers.real(-1, 1), numbers.real(-1, 1)};
      });
    }
    const Placement place = random_placement(random, departure.size == 0);
    question.point = place(question.point);
    question.normal = place.normal(question.normal);
    question.source = place(question.source);
    question.receiver = place(question.receiver);
    for (Obstacle& obstacle : question.occluders) move_all(obstacle, place);
    if (departure.by_an_ulp) depart_by(by_an_ulp);
    if (has_sound_polygons(question)) return {place.name, std::move(question)};
  }
  throw std::logic_error(family.name + ": no usable question in " + std::to_string(kTries) + " tries");
}

}  // namespace

std::span<const Departure> departures() {
  static const std::array<Departure, 6> kDepartures{Departure{"none", 0}, {"ulp", 0x1p-52, true}, {"1e-12", 1e-12},
                                                    {"1e-9", 1e-9},       {"1e-6", 1e-6},         {"1e-3", 1e-3}};
  return kDepartures;
}

DrawnQuestion draw_question(const QuestionFamily& family, const Departure& departure, Random& random) {
  return draw(family, departure, random, nullptr);
}

DrawnQuestion draw_area_question(const QuestionFamily& family, const Departure& departure, Random& random,
                                 Random& of_receiver) {
  return draw(family, departure, random, &of_receiver);
}

}  // namespace exitance
