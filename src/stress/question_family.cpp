#include "src/stress/question_family.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace exitance {
namespace {

constexpr double kHeight = Stage::kSourceHeight, kMiddle = Stage::kMiddle;

// --- Edges and vertices that coincide -----------------------------------------------------------------------------

/// Sheets that share an edge, or, seen from the point, its shadow.
void shared_edge(Stage& s) {
  const Vec3 a = s.between(), along = s.step(4);
  for (int k = s.whole(2, 4); k > 0; --k) {
    // Half as far away the same edge covers the same directions.
    const double nearer = s.whole(0, 3) == 0 ? 0.5 : 1;
    const Vec3 p = nearer * a, e = nearer * along;
    s.add_sheet(s.coin() ? parallelogram(p, e, s.step(4)) : Loop{p, p + e, s.between()});
  }
}

void t_junction(Stage& s) {
  const Vec3 a = s.between(), half = s.step(2), across = s.step(3);
  s.add_sheet(parallelogram(a, 2 * half, across));
  s.add_sheet(parallelogram(a, half, -across));
  if (s.coin()) s.add_sheet(parallelogram(a + half, half, s.coin() ? -across : s.step(3)));
  if (s.coin()) s.add_sheet({a + half, s.between(), s.between()});
}

void collinear_edges(Stage& s) {
  const Vec3 a = s.between(), along = s.step(2), across = s.step(3);
  for (int k = s.whole(2, 4); k > 0; --k) {
    const double from = s.whole(-2, 2);
    s.add_sheet(parallelogram(a + from * along, double(s.whole(1, 3)) * along, s.sign() * across));
  }
}

/// Shadows on the source's edges, vertices and diagonals.
void source_edge(Stage& s) {
  static constexpr std::array<double, 7> kLines{-6, -4, -2, 0, 2, 4, 6};
  const auto line = [&] { return kLines[static_cast<std::size_t>(s.whole(0, 6))]; };
  for (int k = s.whole(1, 3); k > 0; --k) {
    const double z = s.coin() ? kMiddle : s.coin() ? 4 : 12, scale = z / 8;
    const double x = line(), y = line();
    if (s.coin()) {
      double x1 = line(), y1 = line();
      while (x1 == x) x1 = line();
      while (y1 == y) y1 = line();
      s.add_sheet(rectangle(z, scale * std::min(x, x1), scale * std::min(y, y1), scale * std::max(x, x1),
                            scale * std::max(y, y1)));
    } else {
      s.add_sheet(
          {{scale * x, scale * y, z}, {scale * line(), scale * line(), z}, {scale * line(), scale * line(), z}});
    }
  }
}

/// Tiles at several heights that hide the source exactly, or all of it but one of them.
void cover(Stage& s) {
  struct Tile {
    double x0, y0, x1, y1;
  };
  std::vector<Tile> tiles{{-4, -4, 4, 4}};
  for (int k = s.whole(1, 4); k > 0; --k) {
    const auto t = static_cast<std::size_t>(s.whole(0, static_cast<int>(tiles.size()) - 1));
    Tile &tile = tiles[t], rest = tile;
    if (s.coin() && tile.x1 - tile.x0 > 1) {
      tile.x1 = rest.x0 = s.whole(int(tile.x0) + 1, int(tile.x1) - 1);
    } else if (tile.y1 - tile.y0 > 1) {
      tile.y1 = rest.y0 = s.whole(int(tile.y0) + 1, int(tile.y1) - 1);
    } else {
      continue;
    }
    tiles.push_back(rest);
  }
  if (s.whole(0, 2) == 0) tiles.pop_back();
  for (const auto& [x0, y0, x1, y1] : tiles) {
    const double z = 4.0 * s.whole(1, 3), scale = z / 8;
    Loop tile = rectangle(z, scale * x0, scale * y0, scale * x1, scale * y1);
    if (s.whole(0, 3) != 0) {
      s.add_sheet(std::move(tile));
    } else {
      s.add_sheet({tile[0], tile[1], tile[2]});
      s.add_sheet({tile[0], tile[2], tile[3]});
    }
  }
}

void duplicate(Stage& s) {
  const Vec3 a = s.between();
  const Loop one = s.coin() ? parallelogram(a, s.step(4), s.step(4)) : Loop{a, s.between(), s.between()};
  s.add_sheet(one);
  for (int k = s.whole(1, 3); k > 0; --k) {
    Loop again = one;
    std::rotate(again.begin(), again.begin() + s.whole(0, 2), again.end());
    if (s.whole(0, 3) == 0) {
      for (Vec3& v : again) v = 0.5 * v;
    }
    s.add_sheet(std::move(again));
  }
  if (s.coin()) s.add_something();
}

void collinear_run(Stage& s) {
  const double x0 = s.whole(-4, 0), x1 = x0 + s.whole(2, 5), y0 = s.whole(-4, 0), y1 = y0 + s.whole(2, 5);
  const Loop corners = rectangle(kMiddle, x0, y0, x1, y1);
  Loop run;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3 &p = corners[k], &q = corners[(k + 1) % 4];
    for (int repeat = s.whole(1, 3); repeat > 0; --repeat) run.push_back(p);
    for (int part = 1; part < 4; ++part) {
      if (s.coin()) run.push_back(p + (part / 4.0) * (q - p));
    }
  }
  s.add_sheet(run);
  if (s.coin()) s.add_sheet(parallelogram(corners[1], {double(s.whole(1, 3)), 0, 0}, corners[2] - corners[1]));
  if (s.coin()) {
    for (Vec3& v : run) v = {2 * (v.x - x0), 2 * (y0 - v.y), kHeight};
    s.question.source = {run, {}};
  }
}

// --- The point, the horizon and the source's plane ----------------------------------------------------------------

/// Occluders whose plane holds the point.
void edge_on(Stage& s) {
  const Vec3 u = s.between(), v = s.between();
  const auto at = [&] { return 0.5 * s.whole(-2, 3) * u + 0.5 * s.whole(-2, 3) * v; };
  s.add_sheet({at(), at(), at()});
  if (s.coin()) s.add_sheet({u, v, u + v});
  if (s.coin()) s.add_sheet({u, v, s.between()});
  s.add_something();
}

/// The point on an occluder's plane, on its edge's line, on its edge, on its vertex, within it; or a solid's.
void at_the_point(Stage& s) {
  const Vec3 p = s.between(), q = s.between();
  switch (s.whole(0, 8)) {
    case 0:
      s.add_sheet({{}, p, q});
      break;
    case 1:
      s.add_sheet({p, 2 * p, q});
      break;
    case 2:
      s.add_sheet({-p, p, q});
      break;
    case 3:
      s.add_sheet({p, q, -(p + q)});
      break;
    case 4: {
      const Vec3 r = s.step(4);
      s.add_sheet(parallelogram(-1.0 * (p + r), 2 * p, 2 * r));
      break;
    }
    case 5:
      s.add_box({}, 3);
      break;
    case 6:
      s.add(box({0, -1.0 * s.whole(1, 3), 0}, {1.0 * s.whole(1, 3), 1.0 * s.whole(1, 3), 2}));
      break;
    case 7:
      s.add(box({-1.0 * s.whole(1, 3), -1, s.coin() ? 0.0 : -2.0}, {2, 2, s.coin() ? 1.0 : 4.0}));
      break;
    default:
      s.add_sheet({{}, p, q});
      s.add_sheet({{}, q, s.between()});
  }
  if (s.whole(0, 2) == 0) {  // or the point in the source's plane, on its edge or vertex
    const Vec3 onto[] = {{8, 0, 16}, {8, 8, 16}, {0, 0, 16}, {8, 12, 16}, {20, 3, 16}};
    s.question.point = onto[s.whole(0, 4)];
    s.question.normal = s.step(2);
  }
  s.add_something();
}

/// Sources and occluders through the horizon, or with vertices and edges exactly on it.
void horizon(Stage& s) {
  if (s.coin()) {
    const double z0 = s.coin() ? 0 : -s.whole(1, 8), x = s.whole(4, 10), y = s.whole(1, 9);
    s.question.source = {{{x, -y, z0}, {x, -y, 8}, {x, y, 8}, {x, y, z0}}, {}};
    for (int k = s.whole(1, 3); k > 0; --k) {
      const double low = s.whole(-3, 0), high = s.whole(0, 4), at = s.whole(1, 3), left = s.whole(-3, 1);
      if (low == high) continue;
      s.add_sheet(parallelogram({at, left, low}, {s.coin() ? 0.0 : 1.0, 1.0 * s.whole(1, 3), 0}, {0, 0, high - low}));
    }
  } else {
    // Through a vertex of the source, or of the first occluder.
    s.add_something();
    const auto& occluder = s.question.occluders[0].faces[0].outer;
    const Vec3 v = s.coin() ? s.question.source.outer[static_cast<std::size_t>(s.whole(0, 3))] : occluder[0];
    while ((s.question.normal = cross(v, s.step(2))) == Vec3{}) continue;
  }
  s.add_something();
}

/// Occluders that pierce the source's plane, with vertices and edges exactly in it.
void source_plane(Stage& s) {
  static constexpr std::array<double, 5> kHeights{8, 12, 16, 20, 24};
  const auto height = [&] { return kHeights[static_cast<std::size_t>(s.whole(0, 4))]; };
  const auto at = [&] { return Vec3{1.0 * s.whole(-10, 10), 1.0 * s.whole(-10, 10), height()}; };
  for (int k = s.whole(1, 3); k > 0; --k) {
    switch (s.whole(0, 3)) {
      case 0:
        s.add_sheet({at(), at(), at()});
        break;
      case 1: {
        const double x0 = 2 * s.whole(-5, 5), x1 = 2 * s.whole(-5, 5), y = s.whole(-9, 8);
        const Vec3 along{0, 1.0 * s.whole(1, 9), 0};
        s.add_sheet(parallelogram({x0, y, height()}, along, Vec3{x1, y, height()} - Vec3{x0, y, height()}));
        break;
      }
      case 2: {
        const Vec3 corner = at();
        s.add(box(corner, corner + Vec3{1.0 * s.whole(1, 6), 1.0 * s.whole(1, 6), 4.0 * s.whole(1, 2)}));
        break;
      }
      default:
        s.add(octahedron({1.0 * s.whole(-6, 6), 1.0 * s.whole(-6, 6), height()}, 4));
    }
  }
  if (s.coin()) s.add_something();
}

/// Sheets and solids in the source's plane, which face it or show it their backs.
void coplanar_contact(Stage& s) {
  for (int k = s.whole(1, 3); k > 0; --k) {
    const double x = s.whole(-10, 8), y = s.whole(-10, 8), w = s.whole(1, 8), h = s.whole(1, 8), d = s.whole(1, 4);
    switch (s.whole(0, 3)) {
      case 0:
        s.add(box({x, y, kHeight - d}, {x + w, y + h, kHeight}));
        break;
      case 1:
        s.add(box({x, y, kHeight}, {x + w, y + h, kHeight + d}));
        break;
      case 2:
        s.add(tetrahedron({x, y, kHeight}, {x + w, y, kHeight}, {x, y + h, kHeight}, {x, y, kHeight + s.sign() * d}));
        break;
      default:
        s.add_sheet(rectangle(kHeight, x, y, x + w, y + h));
    }
  }
  if (s.coin()) s.add_something();
}

/// Close before the source, the point and the horizon, by as much as things depart; on them where that is nothing.
void near(Stage& s) {
  const double e = s.sign() * s.size, x = s.whole(-4, 2), y = s.whole(-4, 2), w = s.whole(1, 5);
  switch (s.whole(0, 4)) {
    case 0:
      s.add_sheet(rectangle(kHeight - e, x, y, x + w, y + w));
      break;
    case 1:
      s.add_sheet({{x, y, kHeight - e}, {x + w, y, kHeight + e}, {x + w, y + w, kHeight + e}, {x, y + w, kHeight - e}});
      break;
    case 2:
      s.add_sheet(rectangle(e, x, y, x + w, y + w));
      break;
    case 3:
      s.add_sheet({{e, y, 4}, {0, y, 8}, {0, y + w, 8}, {e, y + w, 4}});
      break;
    default:
      s.question.point = {x, y, kHeight - std::fabs(e)};
      s.question.normal = s.coin() ? Vec3{0, 0, 1} : s.step(2);
  }
  s.add_something();
}

// --- Shapes -------------------------------------------------------------------------------------------------------

/// Needles as wide as things depart; without area where that is nothing.
void sliver(Stage& s) {
  for (int k = s.whole(1, 4); k > 0; --k) {
    const Vec3 a = s.between(), b = s.between(), off = s.size * s.step(2);
    s.add_sheet(s.coin() ? Loop{a, b, b + off} : Loop{a, b, b + off, a + off});
  }
  const double w = s.size * s.whole(1, 4);
  if (s.whole(0, 2) == 0) s.question.source = {reversed(rectangle(kHeight, -8, s.whole(-2, 2), 8, 2 + w)), {}};
  if (s.whole(0, 3) == 0) {
    const double y = s.whole(-4, 4);
    s.question.source = {reversed(rectangle(kHeight, -8, y, 8, y + w)), {}};
  }
  s.add_something();
}

void no_area(Stage& s) {
  const Vec3 a = s.between(), d = s.step(3);
  s.add_sheet({a, a + d, a + 2 * d});
  s.add_sheet({a, a, a});
  s.add_sheet({a, a + 2 * d, a + d, a + 3 * d});
  if (s.coin()) s.add_sheet(parallelogram(a, 2 * d, s.step(3)));
  if (s.whole(0, 4) == 0) s.question.source = {at_height(kHeight, {{-8, 0}, {0, 0}, {8, 0}}), {}};
  s.add_something();
}

/// Polygons with a spike that is as thin as things depart.
void spike(Stage& s) {
  const double w = s.size > 0 ? s.size : 0x1p-6, x = s.whole(-4, 2), y = s.whole(-4, 2), tip = s.whole(1, 9);
  const auto spiked = [&](double z) {
    return at_height(
        z,
        {{x, y}, {x + 2, y}, {x + 2, y + 1 - w}, {x + 2 + tip, y + 1}, {x + 2, y + 1 + w}, {x + 2, y + 3}, {x, y + 3}});
  };
  s.add_sheet(spiked(kMiddle));
  if (s.coin()) s.add_sheet(rectangle(kMiddle, x + 2, y, x + 4, y + 1));
  if (s.coin()) s.question.source = {reversed(spiked(kHeight)), {}};
  if (s.coin()) s.add_something();
}

/// Gaps and overlaps as wide as things depart; sheets that meet where that is nothing.
void gap(Stage& s) {
  const double e = s.sign() * s.size, x = s.whole(-3, 3), y = s.whole(-3, 3);
  switch (s.whole(0, 3)) {
    case 0:
      s.add_middle(-5, -5, x, 5);
      s.add_middle(x + e, -5, 5, 5);
      break;
    case 1:
      s.add_middle(-5, -5, x, y);
      s.add_middle(x + e, -5, 5, y);
      s.add_middle(-5, y + e, x, 5);
      s.add_middle(x + e, y + e, 5, 5);
      break;
    case 2:
      s.add_sheet(at_height(kMiddle, {{-4, -4}, {4, -3}, {x, 4}}));
      s.add_sheet(at_height(kMiddle, {{4, -3}, {4, 4}, {x + e, 4}}));
      break;
    default:
      s.add_middle(-2, -2, 4 - e, 2);
      s.add_middle(-4, y - 4, -2 - e, y + 1);
  }
  if (s.whole(0, 2) == 0) s.add_something();
}

/// Sources so small that the sum over their edges cancels.
void tiny_source(Stage& s) {
  const double e = 8 * (s.size > 0 ? s.size : 0x1p-20), x = 2 * s.whole(-3, 3), y = 2 * s.whole(-3, 3);
  s.question.source = {reversed(rectangle(kHeight, x - e, y - e, x + e, y + e)), {}};
  if (s.coin()) s.add_sheet(at_height(kMiddle, {{x / 2, y / 2 - 1}, {x / 2 + 2, y / 2 - 1}, {x / 2, y / 2 + 3}}));
  if (s.coin()) s.add_middle(x / 2 - e, y / 2 - e, x / 2 + e / 4, y / 2 + e / 8);
  if (s.coin())
    s.add_sheet(at_height(kMiddle, {{x / 2 - 3, y / 2 - 3}, {x / 2 + 3, y / 2 + 3}, {x / 2 + 3, y / 2 - 3}}));
  if (s.coin()) s.add_something();
}

const std::array<Points2, 3> kOutlines{
    Points2{{-4, -4}, {4, -4}, {4, 0}, {0, 0}, {0, 4}, {-4, 4}},
    Points2{{4, 0}, {1, 1}, {0, 4}, {-1, 1}, {-4, 0}, {-1, -1}, {0, -4}, {1, -1}},
    Points2{
        {-4, -4}, {4, -4}, {4, 4}, {2, 4}, {2, -2}, {1, -2}, {1, 4}, {-1, 4}, {-1, -2}, {-2, -2}, {-2, 4}, {-4, 4}}};

const Points2& an_outline(Stage& s) {
  return kOutlines[static_cast<std::size_t>(s.whole(0, 2))];
}

/// Shapes that are not convex, as source and occluder, flat and standing across the source's plane.
void not_convex(Stage& s) {
  if (s.coin()) {
    Points2 outline = an_outline(s);
    for (auto& [x, y] : outline) x *= 2, y *= 2;
    s.question.source = {reversed(at_height(kHeight, outline)), {}};
  }
  for (int k = s.whole(1, 2); k > 0; --k) {
    Loop loop;
    const Points2& outline = an_outline(s);
    switch (s.whole(0, 2)) {
      case 0:
        loop = at_height(kMiddle, outline);
        break;
      case 1:
        for (const auto& [x, y] : outline) loop.push_back({x, y, kHeight + x});
        break;
      default:
        for (const auto& [x, y] : outline) loop.push_back({x / 2 + 1, y / 4, 8 - x});
    }
    s.add_sheet(loop);
  }
  if (s.coin()) s.add_something();
}

void hole(Stage& s) {
  const Polygon frame{rectangle(kMiddle, -3, -3, 3, 3),
                      {rectangle(kMiddle, -2, -2, 1.0 * s.whole(-1, 2), 1.0 * s.whole(-1, 2))}};
  s.add({{frame}, false});
  if (s.coin()) s.add_sheet(frame.holes[0]);
  if (s.coin()) s.add_sheet(rectangle(4, -1, -1, 0.5 * s.whole(-1, 2), 0.5 * s.whole(-1, 2)));
  if (s.coin()) {
    s.question.source.holes.push_back(rectangle(kHeight, -4, -4, 2.0 * s.whole(-1, 2), 2.0 * s.whole(-1, 2)));
  }
}

void not_planar(Stage& s) {
  const double lift = s.whole(-3, 3) * (s.coin() ? 1 : 0x1p-30);
  if (s.coin()) {
    for (Vec3& v : s.question.source.outer) v.z += s.whole(-1, 1) * lift;
  }
  for (int k = s.whole(1, 2); k > 0; --k) {
    Loop loop = parallelogram(s.between(), s.step(4), s.step(4));
    loop[static_cast<std::size_t>(s.whole(0, 3))].z += lift;
    if (s.coin()) s.add_sheet({loop[0], loop[1], s.between()});
    s.add_sheet(std::move(loop));
  }
}

// --- Solids -------------------------------------------------------------------------------------------------------

/// Boxes that touch, in stacks and rows, and the source they may touch, too.
void box_stack(Stage& s) {
  Vec3 at{1.0 * s.whole(-4, 2), 1.0 * s.whole(-4, 2), 1.0 * s.whole(3, 8)};
  const int axis = s.whole(0, 2);
  for (int k = s.whole(2, 4); k > 0; --k) {
    const Vec3 size{1.0 * s.whole(1, 3), 1.0 * s.whole(1, 3), 1.0 * s.whole(1, 3)};
    s.add(box(at, at + size));
    at[axis] += size[axis];
    at[(axis + 1) % 3] += s.whole(-1, 1);
  }
  if (s.whole(0, 2) == 0) s.add(box({-2, -2, 12}, {1.0 * s.whole(-1, 4), 2, kHeight}));
}

void nested_boxes(Stage& s) {
  const Vec3 a{-4, -4, 4};
  Vec3 low = a, high = a + Vec3{6, 6, 6};
  for (int k = s.whole(2, 3); k > 0; --k) {
    s.add(box(low, high));
    for (int c = 0; c < 3; ++c) {
      low[c] += s.whole(0, 1);
      high[c] -= s.whole(0, 1);
    }
  }
  if (s.whole(0, 3) == 0) s.question.point = {-2, -2, 6};  // within
  if (s.coin()) s.add_sheet(rectangle(s.whole(4, 6), -3, -3, 1, 1));
}

void interpenetrating(Stage& s) {
  for (int k = s.whole(2, 3); k > 0; --k) {
    switch (s.whole(0, 2)) {
      case 0:
        s.add_box({1.0 * s.whole(-3, 0), 1.0 * s.whole(-3, 0), 1.0 * s.whole(4, 7)}, 4);
        break;
      case 1:
        s.add(octahedron({1.0 * s.whole(-1, 1), 1.0 * s.whole(-1, 1), 1.0 * s.whole(6, 8)}, 2));
        break;
      default:
        s.add(tetrahedron({-3, -2, 6}, {3, -1.0 * s.whole(0, 2), 7}, {0, 3, 8}, {0, 0, 1.0 * s.whole(10, 12)}));
    }
  }
}

/// Boxes without some of their faces, and edges that three sheets share.
void open_mesh(Stage& s) {
  Obstacle open = box({-2, -2, 5}, {1.0 * s.whole(0, 3), 1.0 * s.whole(0, 3), 8});
  open.solid = false;
  for (int k = s.whole(1, 3); k > 0; --k) open.faces.erase(open.faces.begin() + s.whole(0, int(open.faces.size()) - 1));
  s.add(open);
  const Vec3 a{-2, -2, 5}, along{0, 0, 3};
  for (int k = s.whole(0, 2); k > 0; --k) s.add_sheet(parallelogram(a, along, s.step(3)));
  if (s.coin()) s.add(box({-4, -4, 5}, {-2, -2, 8}));  // touches along an edge
}

/// Solids that are not convex: their silhouettes.
void not_convex_solid(Stage& s) {
  const double low = s.whole(3, 6);
  const Points2& outline = kOutlines[static_cast<std::size_t>(s.whole(0, 1))];
  s.add(prism(outline, low, low + s.whole(1, 6)));
  if (s.coin()) {
    Points2 moved = kOutlines[0];
    const double dx = s.whole(-2, 2), dy = s.whole(-2, 2);
    for (auto& [x, y] : moved) x = x / 2 + dx, y = y / 2 + dy;
    s.add(prism(moved, low + s.whole(-2, 2), low + s.whole(3, 8)));
  }
  if (s.coin()) s.add_something();
}

// --- Everything at once -------------------------------------------------------------------------------------------

/// Sheets that cross each other and meet in lattice points.
void crossing(Stage& s) {
  const Vec3 centre{0, 0, kMiddle};
  for (int k = s.whole(2, 4); k > 0; --k) {
    const Vec3 u = s.step(3), v = s.step(3);
    s.add_sheet(parallelogram(centre - u - v, 2 * u, 2 * v));
  }
  if (s.coin()) s.add_something();
}

void soup(Stage& s) {
  for (int k = s.whole(2, 6); k > 0; --k) s.add_something();
}

/// Occluders far larger than the rest, behind the point, beyond the source, through all of it.
void outside(Stage& s) {
  const double far = std::ldexp(1, s.whole(6, 14));
  switch (s.whole(0, 3)) {
    case 0:
      s.add_sheet({{-far, -far, kMiddle}, {far, -far, kMiddle}, {0, 1.0 * s.whole(-3, 3), kMiddle}});
      break;
    case 1:
      s.add_sheet({{3, -2, -8}, {3, 2, -8}, {1, 2, far}, {1, -2, far}});
      break;
    case 2:
      s.add_sheet(parallelogram({-far, -3, -4}, {2 * far, 0, 2}, {0, 6, 0}));
      break;
    default:
      s.add_sheet(rectangle(-1.0 * s.whole(1, 4), -far, -far, far, far));
      s.add_sheet(rectangle(kHeight + s.whole(1, 4), -far, -far, far, far));
  }
  s.add_something();
}

}  // namespace

std::span<const QuestionFamily> question_families() {
  static const std::array kFamilies{
      QuestionFamily{"shared_edge", "sheets with a common edge, in space or as seen", shared_edge},
      QuestionFamily{"t_junction", "an edge that ends within another", t_junction},
      QuestionFamily{"collinear_edges", "edges that overlap in one line", collinear_edges},
      QuestionFamily{"source_edge", "shadows that end on the source's edges, vertices and diagonals", source_edge},
      QuestionFamily{"cover", "tiles that hide the source exactly, or all but one of them", cover},
      QuestionFamily{"duplicate", "the same face again, turned over, or nearer in the same cone", duplicate},
      QuestionFamily{"collinear_run", "repeated and collinear vertices", collinear_run},
      QuestionFamily{"edge_on", "occluders whose plane holds the point", edge_on},
      QuestionFamily{"at_the_point",
                     "the point on an occluder's plane, edge line, edge, vertex, or in a solid's surface",
                     at_the_point},
      QuestionFamily{"horizon", "sources and occluders through the horizon, or with vertices on it", horizon},
      QuestionFamily{"source_plane", "occluders through the source's plane, or with vertices in it", source_plane},
      QuestionFamily{"coplanar_contact", "sheets and solids in the source's plane", coplanar_contact},
      QuestionFamily{"near", "occluders that nearly touch the source or the point", near, true},
      QuestionFamily{"sliver", "needles", sliver, true},
      QuestionFamily{"no_area", "faces of zero area", no_area},
      QuestionFamily{"spike", "polygons with thin spikes", spike, true},
      QuestionFamily{"gap", "gaps and overlaps", gap, true},
      QuestionFamily{"tiny_source", "sources whose Lambert sum cancels", tiny_source, true},
      QuestionFamily{"not_convex", "polygons that are not convex", not_convex},
      QuestionFamily{"hole", "polygons with holes, and plugs of them", hole},
      QuestionFamily{"not_planar", "bent quadrilaterals", not_planar},
      QuestionFamily{"box_stack", "boxes that touch each other and the source", box_stack},
      QuestionFamily{"nested_boxes", "boxes in boxes, with faces in common", nested_boxes},
      QuestionFamily{"interpenetrating", "solids that pierce each other", interpenetrating},
      QuestionFamily{"open_mesh", "boxes that are not closed, edges of more than two faces", open_mesh},
      QuestionFamily{"not_convex_solid", "solids seen by their silhouettes", not_convex_solid},
      QuestionFamily{"crossing", "sheets that cross each other", crossing},
      QuestionFamily{"soup", "anything on a coarse lattice", soup},
      QuestionFamily{"outside", "occluders beyond, behind and through everything", outside}};
  return kFamilies;
}

}  // namespace exitance
