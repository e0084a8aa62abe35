#include "tests/form_factor/exchange_scenes.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>

#include "src/form_factor/visual_events.h"
#include "src/scene/reader.h"
#include "src/stress/placement.h"
#include "tests/places.h"

namespace exitance {
namespace {

using Loops = std::vector<std::vector<Vec3>>;

/// Faces outward, of a box from the origin to `size`, turned by the quaternion (a, b, c, d) of integers, its middle
/// then moved to `at`.
Loops box(const Vec3& size, const std::array<int, 4>& quaternion, const Vec3& at) {
  const auto [a, b, c, d] = quaternion;
  const double s = 1.0 / (a * a + b * b + c * c + d * d);
  const auto column = [&](int x, int y, int z) { return s * Vec3{double(x), double(y), double(z)}; };
  const Vec3 u = column(a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)),
             v = column(2 * (b * c - a * d), a * a - b * b + c * c - d * d, 2 * (c * d + a * b)),
             w = column(2 * (b * d + a * c), 2 * (c * d - a * b), a * a - b * b - c * c + d * d);
  const auto corner = [&](int i) {
    return at + (i & 1 ? 0.5 : -0.5) * size.x * u + (i & 2 ? 0.5 : -0.5) * size.y * v +
           (i & 4 ? 0.5 : -0.5) * size.z * w;
  };
  Loops faces;
  for (const auto& f : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    faces.push_back({corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])});
  }
  return faces;
}

Loops triangles(const Loops& quadrilaterals) {
  Loops loops;
  for (const auto& q : quadrilaterals) {
    loops.push_back({q[0], q[1], q[2]});
    loops.push_back({q[0], q[2], q[3]});
  }
  return loops;
}

/// The walls of a room [0, side]³, facing in, each in n × n squares.
Loops room(double side, int n, bool floor = true) {
  Loops squares;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool far : {false, true}) {
      if (axis == 2 && !far && !floor) continue;
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int s, int t) {
            Vec3 p;
            p[axis] = far ? side : 0;
            p[(axis + 1) % 3] = side * s / n;
            p[(axis + 2) % 3] = side * t / n;
            return p;
          };
          if (far) {
            squares.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
          } else {
            squares.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
          }
        }
      }
    }
  }
  return squares;
}

void add(KnownScene& known, const Loops& loops) {
  for (const auto& loop : loops) known.scene.surfaces.push_back({{loop, {}}});
}
void add_body(KnownScene& known, const Loops& faces) {
  add(known, faces);
  known.bodies.push_back(faces);
}

/// Twenty bodies, turned differently, each in a cell of its own of a grid of 27.
KnownScene turned_bodies(const Vec3& size, std::string_view name) {
  KnownScene known;
  Random random(name);
  add(known, triangles(room(4, 4)));
  for (int k = 0; k < 20; ++k) {
    const int cell = k * 4 % 27;
    const std::array<int, 4> q{random.whole(1, 9), random.whole(-9, 9), random.whole(-9, 9), random.whole(-9, 9)};
    const Vec3 at{4.0 / 3 * (cell % 3 + 0.5), 4.0 / 3 * (cell / 3 % 3 + 0.5), 4.0 / 3 * (cell / 9 + 0.5)};
    add_body(known, triangles(box(size, q, at)));
  }
  return known;
}

double in_1024ths(Random& random, double low, double high) {
  return std::round(random.real(low, high) * 1024) / 1024;
}

/// A triangle or a parallelogram with a corner at `at`; with `front`, facing that way.
std::vector<Vec3> random_sheet(Random& random, const Vec3& at, double size, const Vec3* front) {
  const auto length = [&] { return in_1024ths(random, -size, size); };
  for (;;) {
    const Vec3 u{length(), length(), length()};
    Vec3 v{length(), length(), length()};
    if (random.whole(0, 7) == 0) v = (1.0 / 16) * v;
    const Vec3 n = cross(u, v);
    if (norm(n) < 1e-4) continue;
    std::vector<Vec3> loop =
        random.whole(0, 1) ? std::vector{at, at + u, at + v} : std::vector{at, at + u, at + u + v, at + v};
    if (front == nullptr || dot(n, *front) >= 0.2 * norm(n) * norm(*front)) return loop;
  }
}

}  // namespace

PolygonSoup soup_of(const KnownPair& pair) {
  std::vector<Polygon> polygons{{pair.receiver, {}}, {pair.source, {}}};
  std::vector<Role> roles(2, Role::patch);
  for (const ConvexBody& body : pair.occluders) {
    for (const auto& face : body) polygons.push_back({face, {}});
    roles.resize(polygons.size(), body.size() > 1 ? Role::solid_face : Role::sheet);
  }
  return PolygonSoup(polygons, roles, {}, 0, Planes::rounded);
}

KnownPair random_pair(int number) {
  Random random("exchange truth " + std::to_string(number));
  KnownPair pair;
  const auto at = [&](double xy, double low, double high) {
    Vec3 p;
    p.x = in_1024ths(random, -xy, xy);
    p.y = in_1024ths(random, -xy, xy);
    p.z = in_1024ths(random, low, high);
    return p;
  };
  const Vec3 up{0, 0, 1}, down{0, 0, -1};
  pair.receiver = random_sheet(random, at(0.5, 0, 0), 1, &up);
  pair.source = random_sheet(random, at(0.5, 0.25, 1.5), 1, &down);
  const int count = random.whole(1, 6);
  for (int k = 0; k < count; ++k) {
    const Vec3 corner = at(0.75, -0.125, 1.25);
    const double size = random.whole(0, 2) ? 0.5 : 0.875;
    pair.occluders.push_back({random_sheet(random, corner, size, nullptr)});
  }
  return pair;
}

KnownScene known_scene(std::string_view name) {
  KnownScene known;
  const Loops unit_box = box({1, 1, 1}, {1, 0, 0, 0}, {1.5, 1.5, 0.5});
  if (name == "box_room") {
    known.scene = read_scene(source_file("data/box_on_floor.toml"));
    known.patch_size = 1.0 / 3;
    known.bodies.push_back(unit_box);
  } else if (name == "box_on_uncut_floor") {
    add(known, room(3, 1));
    add_body(known, unit_box);
    known.patch_size = 0.75;
  } else if (name == "turned_cubes") {
    known = turned_bodies({0.5, 0.5, 0.5}, name);
  } else if (name == "thin_plates") {
    known = turned_bodies({0.7, 0.7, 1e-4}, name);
  } else if (name == "sliver_fan") {
    add(known, room(3, 2, false));
    const auto rim = [](int k) {  // around the floor's border, from a corner on
      const double t = 3.0 * (k % 50) / 50;
      return std::array{Vec3{t, 0, 0}, Vec3{3, t, 0}, Vec3{3 - t, 3, 0}, Vec3{0, 3 - t, 0}}[k / 50 % 4];
    };
    for (int k = 0; k < 200; ++k) add(known, {{{1.375, 1.625, 0}, rim(k), rim(k + 1)}});
    add_body(known, triangles(box({1, 0.75, 0.5}, {4, 1, -2, 3}, {1.5, 1.25, 1})));
  } else {
    throw std::invalid_argument("no such scene: " + std::string(name));
  }
  if (known.scene.materials.empty()) known.scene.materials.push_back({"grey", {0.5}, {0}});
  return known;
}

ExchangeTruth patch_truth(const KnownScene& known, const PolygonSoup& soup, const PatchMesh& mesh, std::uint32_t i,
                          std::uint32_t j, const TruthOptions& options) {
  ExchangeTruth sum;
  const auto corners = [&](const PatchPiece& piece) { return corners_of(soup, {piece.facet, mesh.loop(piece)}); };
  for (const PatchPiece& a : mesh.pieces_of(mesh.patches[i])) {
    for (const PatchPiece& b : mesh.pieces_of(mesh.patches[j])) {
      const ExchangeTruth t = exchange_truth(corners(a), corners(b), known.bodies, options);
      sum.integral += t.integral;
      sum.error += t.error;
      sum.evaluations += t.evaluations;
    }
  }
  return sum;
}

}  // namespace exitance
