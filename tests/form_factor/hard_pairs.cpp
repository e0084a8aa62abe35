#include "tests/form_factor/hard_pairs.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "src/stress/placement.h"

namespace exitance {
namespace {

using Loop = std::vector<Vec3>;

/// A number of the lattice of 1/steps.
double lattice(Random& random, double low, double high, int steps) {
  return static_cast<double>(random.whole(static_cast<int>(low * steps), static_cast<int>(high * steps))) / steps;
}

/// Two different ones, ascending.
std::array<double, 2> range(Random& random, double low, double high, int steps) {
  for (;;) {
    const double a = lattice(random, low, high, steps), b = lattice(random, low, high, steps);
    if (a != b) return {std::min(a, b), std::max(a, b)};
  }
}

/// Across an axis, counter-clockwise seen from its positive end.
Loop rectangle(int axis, double at, const std::array<double, 2>& s, const std::array<double, 2>& t) {
  const auto corner = [&](double a, double b) {
    Vec3 p;
    p[axis] = at;
    p[(axis + 1) % 3] = a;
    p[(axis + 2) % 3] = b;
    return p;
  };
  return {corner(s[0], t[0]), corner(s[1], t[0]), corner(s[1], t[1]), corner(s[0], t[1])};
}
Loop turned_over(Loop loop) {
  std::ranges::reverse(loop);
  return loop;
}

using Range = std::array<double, 2>;
ConvexBody box(const Range& x, const Range& y, const Range& z) {
  return {turned_over(rectangle(0, x[0], y, z)), rectangle(0, x[1], y, z),
          turned_over(rectangle(1, y[0], z, x)), rectangle(1, y[1], z, x),
          turned_over(rectangle(2, z[0], x, y)), rectangle(2, z[1], x, y)};
}

/// The rotation of a quaternion of integers, about the origin; then a shift.
class Turn {
 public:
  explicit Turn(Random& random) {
    const double a = random.whole(1, 9), b = random.whole(-9, 9), c = random.whole(-9, 9), d = random.whole(-9, 9),
                 s = 1 / (a * a + b * b + c * c + d * d);
    u_ = s * Vec3{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)};
    v_ = s * Vec3{2 * (b * c - a * d), a * a - b * b + c * c - d * d, 2 * (c * d + a * b)};
    w_ = s * Vec3{2 * (b * d + a * c), 2 * (c * d - a * b), a * a - b * b - c * c + d * d};
    shift_ = {random.real(-1, 1), random.real(-1, 1), random.real(-1, 1)};
  }
  void operator()(Loop& loop, const Vec3& about = {}, bool shifted = true) const {
    for (Vec3& p : loop) {
      const Vec3 q = p - about;
      p = (shifted ? shift_ : about) + q.x * u_ + q.y * v_ + q.z * w_;
    }
  }

 private:
  Vec3 u_, v_, w_, shift_;
};

/// Opposite, or the source at a right angle.
KnownPair lattice_plates(Random& random, int steps) {
  KnownPair pair;
  pair.receiver = rectangle(2, 0, range(random, 0, 1, steps), range(random, 0, 1, steps));
  if (random.whole(0, 1)) {
    pair.source = turned_over(rectangle(2, 1, range(random, 0, 1, steps), range(random, 0, 1, steps)));
  } else {
    pair.source = rectangle(0, 0, range(random, 0, 1, steps), range(random, 0, 1, steps));
  }
  return pair;
}

KnownPair plates(Random& random) {
  KnownPair pair = lattice_plates(random, 16);
  const int count = random.whole(1, 4);
  for (int k = 0; k < count; ++k) {
    const int axis = random.whole(0, 2);
    pair.occluders.push_back(
        {rectangle(axis, lattice(random, 1.0 / 16, 15.0 / 16, 16), range(random, 0, 1, 16), range(random, 0, 1, 16))});
  }
  return pair;
}

/// Turned ones neither stand on the receiver nor reach a source opposite it: pairs of `standing` do.
KnownPair boxes(Random& random, bool exact) {
  const double low = exact ? 0 : 0.125, high = exact ? 1 : 0.875;
  KnownPair pair = lattice_plates(random, 8);
  const int count = random.whole(1, 3);
  for (int k = 0; k < count; ++k) {
    pair.occluders.push_back(box(range(random, low, 1, 8), range(random, 0, 1, 8), range(random, 0, high, 8)));
  }
  return pair;
}

KnownPair hinged(Random& random, bool exact) {
  KnownPair pair;
  pair.receiver = rectangle(2, 0, {0, 1}, {0, 1});
  const double angle = random.real(exact ? 0.1 : 1.6, 3.0), length = random.real(0.3, 1.5);
  const Vec3 up{length * std::cos(angle), 0, length * std::sin(angle)};
  pair.source = {{0, 0, 0}, {0, 1, 0}, Vec3{0, 1, 0} + up, up};
  const Range x = range(random, 0, 1, 8), y = range(random, 0, 1, 8);
  const double z = lattice(random, 0.125, 0.5, 8);
  pair.occluders.push_back(box(x, y, {0, z}));
  if (random.whole(0, 1)) {
    pair.occluders.push_back(box({x[0], 0.5 * (x[0] + x[1])}, y, {z, z + lattice(random, 0.125, 0.5, 8)}));
  }
  return pair;
}

KnownPair thin(Random& random) {
  KnownPair pair;
  pair.receiver = rectangle(2, 0, {0, 1}, {0, 1});
  pair.source = turned_over(rectangle(2, 1, range(random, 0, 1, 8), range(random, 0, 1, 8)));
  const int count = random.whole(1, 2);
  for (int k = 0; k < count; ++k) {
    const Vec3 at{lattice(random, 0.25, 0.75, 16), lattice(random, 0.25, 0.75, 16), lattice(random, 0.25, 0.75, 16)};
    const double width = random.real(0.1, 0.5);
    ConvexBody plate = box({at.x - width, at.x + width}, {at.y - 0.25, at.y + 0.25}, {at.z - 0x1p-14, at.z + 0x1p-14});
    const Turn turn(random);
    for (Loop& face : plate) turn(face, at, false);
    pair.occluders.push_back(plate);
  }
  return pair;
}

/// A box, turned about the floor's normal, stands on the floor and ends below the ceiling, in it or above it; another
/// one may stand on it.
KnownPair standing(Random& random) {
  KnownPair pair;
  pair.receiver = rectangle(2, 0, range(random, 0, 1, 4), range(random, 0, 1, 4));
  pair.source = turned_over(rectangle(2, 1, range(random, 0, 1, 4), range(random, 0, 1, 4)));
  const int a = random.whole(1, 9), b = random.whole(-9, 9);
  const double s = 1.0 / (a * a + b * b), cosine = s * (a * a - b * b), sine = s * 2 * a * b;
  const Vec3 middle{lattice(random, 0.25, 0.75, 8), lattice(random, 0.25, 0.75, 8), 0};
  const auto add = [&](double width, double depth, double low, double high) {
    ConvexBody body = box({-width, width}, {-depth, depth}, {low, high});
    for (Loop& face : body) {
      for (Vec3& p : face) p = middle + Vec3{cosine * p.x - sine * p.y, sine * p.x + cosine * p.y, p.z};
    }
    pair.occluders.push_back(body);
  };
  const double width = lattice(random, 0.125, 0.5, 16), depth = lattice(random, 0.125, 0.5, 16),
               high = lattice(random, 0.25, 1.25, 8);
  add(width, depth, 0, high);
  if (random.whole(0, 1)) add(0.5 * width, depth, high, high + lattice(random, 0.125, 1, 8));
  return pair;
}

KnownPair slivers(Random& random) {
  const auto point = [&](double low, double high) {
    return Vec3{random.real(-0.25, 1.25), random.real(-0.25, 1.25), random.real(low, high)};
  };
  const auto narrow = [&] { return std::pow(10.0, random.real(-4, -1)); };
  KnownPair pair;
  const bool one = random.whole(0, 1), other = random.whole(0, 1);
  pair.receiver = rectangle(2, 0, {0, one ? narrow() : 1}, {0, 1});
  pair.source = turned_over(rectangle(2, 1, {0, 1}, {0.5, other ? 0.5 + narrow() : 1}));
  const int count = random.whole(1, 4);
  for (int k = 0; k < count; ++k) {
    const Vec3 a = point(0.1, 0.9), b = point(0.1, 0.9);
    const Vec3 c = a + random.real(0, 1) * (b - a) + narrow() * (point(0, 1) - Vec3{0.5, 0.5, 0.5});
    pair.occluders.push_back({{a, b, c}});
  }
  return pair;
}

/// A triangle of three corners, or all.
Loop part_of(Loop loop, Random& random) {
  if (random.whole(0, 1)) return loop;
  loop.erase(loop.begin() + random.whole(0, static_cast<int>(loop.size()) - 1));
  return loop;
}

KnownPair rooms(Random& random) {
  constexpr int kSteps = 4;
  const auto any = [&] { return range(random, 0, 1, kSteps); };
  const ConvexBody walls = box({0, 1}, {0, 1}, {0, 1});
  const int one = random.whole(0, 5), other = (one + random.whole(1, 5)) % 6;
  KnownPair pair{part_of(turned_over(walls[static_cast<std::size_t>(one)]), random),
                 part_of(turned_over(walls[static_cast<std::size_t>(other)]), random),
                 {}};
  const int count = random.whole(1, 4);
  for (int k = 0; k < count; ++k) {
    if (random.whole(0, 1)) {
      pair.occluders.push_back(box(any(), any(), any()));
    } else {
      const int axis = random.whole(0, 2);
      pair.occluders.push_back({part_of(rectangle(axis, lattice(random, 0.25, 0.75, kSteps), any(), any()), random)});
    }
  }
  return pair;
}

}  // namespace

KnownPair hard_pair(std::string_view family, int number) {
  const std::string name = "hard " + std::string(family) + " " + std::to_string(number);
  Random random(name);
  const bool exact = number % 2 == 0;
  KnownPair pair;
  if (family == "plates") {
    pair = plates(random);
  } else if (family == "boxes") {
    pair = boxes(random, exact);
  } else if (family == "hinged") {
    pair = hinged(random, exact);
  } else if (family == "thin") {
    pair = thin(random);
  } else if (family == "standing") {
    pair = standing(random);
  } else if (family == "slivers") {
    pair = slivers(random);
  } else if (family == "rooms") {
    pair = rooms(random);
  } else if (family == "sheets") {
    return random_pair(1'000'000 + number);
  } else {
    throw std::invalid_argument("no such family: " + std::string(family));
  }
  if (exact) return pair;
  const Turn turn(random);
  turn(pair.receiver);
  turn(pair.source);
  for (ConvexBody& body : pair.occluders) {
    for (Loop& face : body) turn(face);
  }
  return pair;
}

}  // namespace exitance
