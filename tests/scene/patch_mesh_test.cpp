#include "src/scene/patch_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>
#include <tuple>

#include "src/scene/furnished_room.h"
#include "src/scene/input_error.h"

namespace exitance {
namespace {

using Point = std::tuple<double, double, double>;

Point key(const Vec3& p) {
  return {p.x, p.y, p.z};
}

Scene scene_of(const std::vector<Polygon>& polygons) {
  Scene scene;
  Material& grey = scene.materials.emplace_back();
  grey.rho = {0.5, 0.5, 0.5};
  grey.E = {0, 0, 0};
  scene.objects = {{"all", ""}};
  for (const Polygon& polygon : polygons) {
    Surface surface;
    surface.polygon = polygon;
    scene.surfaces.push_back(surface);
  }
  return scene;
}

Loop square(double x0, double y0, double x1, double y1) {
  return {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
}

/// Turned about a skew axis and moved, so that every coordinate is rounded.
Polygon turned(Polygon polygon) {
  const auto turn = [](Vec3& p) {
    const double a = 0.7, b = 1.1;
    const Vec3 q{std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y, p.z};
    p = Vec3{std::cos(b) * q.x + std::sin(b) * q.z, q.y, -std::sin(b) * q.x + std::cos(b) * q.z} + Vec3{3.3, -1.7, 0.9};
  };
  std::for_each(polygon.outer.begin(), polygon.outer.end(), turn);
  for (Loop& hole : polygon.holes) std::for_each(hole.begin(), hole.end(), turn);
  return polygon;
}

Loop corners(const PolygonSoup& soup, std::uint32_t facet) {
  Loop loop;
  for (const Corner& c : soup.corners(soup.facets()[facet])) loop.push_back(soup.vertices()[c.vertex]);
  return loop;
}

Loop outline(const PolygonSoup& soup, const PatchMesh& mesh, const PatchPiece& piece) {
  if (piece.loop_count == 0) return corners(soup, piece.facet);
  const auto loop = mesh.loop(piece);
  return {loop.begin(), loop.end()};
}

/// How far inside a convex loop a point of its plane is: distance to the nearest edge, negative outside.
double depth(const Loop& loop, const Vec3& p) {
  const Vec3 normal = normalized(area_vector(loop));
  double least = 1e300;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 edge = loop[(k + 1) % loop.size()] - loop[k];
    if (norm(edge) > 0) least = std::min(least, dot(cross(normal, normalized(edge)), p - loop[k]));
  }
  return least;
}

double size_of(const Loop& loop) {
  double size = 0;
  for (const Vec3& p : loop) size = std::max(size, norm(p - loop[0]));
  return size;
}

/// What holds of every mesh: patches and elements tile their surfaces' facets by convex pieces in the facets' planes,
/// facing their way; sample points lie well inside.
void expect_sound(const Scene& scene, const PolygonSoup& soup, const PatchMesh& mesh) {
  std::vector<double> facet_area(soup.facets().size()), by_patches(facet_area), by_elements(facet_area);
  for (std::uint32_t f = 0; f < facet_area.size(); ++f) facet_area[f] = norm(area_vector(corners(soup, f)));
  const auto check_piece = [&](const PatchPiece& piece) {
    const Loop facet = corners(soup, piece.facet), loop = outline(soup, mesh, piece);
    const double size = size_of(facet);
    const Vec3 normal = normalized(area_vector(facet));
    ASSERT_GE(loop.size(), 3u);
    EXPECT_NEAR(piece.area, norm(area_vector(loop)), 1e-14 * facet_area[piece.facet]);
    EXPECT_GT(dot(area_vector(loop), normal), 0);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      EXPECT_NEAR(dot(normal, loop[k] - facet[0]), 0, 2e-15 * (size + norm(facet[0]))) << "off its facet's plane";
      EXPECT_GT(depth(facet, loop[k]), -1e-8 * size) << "outside its facet";
      const Vec3 a = loop[(k + 1) % loop.size()] - loop[k],
                 b = loop[(k + 2) % loop.size()] - loop[(k + 1) % loop.size()];
      EXPECT_GT(dot(cross(a, b), normal), -1e-13 * size * size) << "not convex";
    }
  };
  std::uint32_t surface = 0, element = 0;
  for (const Patch& patch : mesh.patches) {
    EXPECT_GE(patch.surface, surface);
    surface = patch.surface;
    EXPECT_EQ(soup.facets()[mesh.pieces[patch.piece_first].facet].polygon, surface);
    double pieces = 0, elements = 0;
    for (const PatchPiece& piece : mesh.pieces_of(patch)) {
      check_piece(piece);
      pieces += piece.area;
      by_patches[piece.facet] += piece.area;
    }
    EXPECT_EQ(patch.element_first, element);
    EXPECT_GE(patch.element_count, 1u);
    for (; element < patch.element_first + patch.element_count; ++element) {
      const Element& e = mesh.elements[element];
      EXPECT_EQ(&mesh.patches[e.patch], &patch);
      double in_element = 0, deepest = -1;
      for (const PatchPiece& piece : mesh.pieces_of(e)) {
        check_piece(piece);
        in_element += piece.area;
        by_elements[piece.facet] += piece.area;
        const Loop loop = outline(soup, mesh, piece);
        // A centroid is at least a third of the width away from every edge, which is at least a third of area / size.
        if (piece.facet == e.facet)
          deepest = std::max(deepest, depth(loop, e.sample) - 0.2 * piece.area / size_of(loop));
      }
      const Loop facet = corners(soup, e.facet);
      EXPECT_GT(deepest, 0) << "the sample point is not well inside";
      EXPECT_GT(depth(facet, e.sample), 0);
      EXPECT_NEAR(dot(e.normal, e.sample - facet[0]), 0, 2e-15 * (size_of(facet) + norm(facet[0])));
      EXPECT_NEAR(norm(e.normal), 1, 1e-15);
      EXPECT_GT(dot(e.normal, area_vector(facet)), 0);
      EXPECT_NEAR(e.area, in_element, 1e-14 * in_element);
      EXPECT_GE(mesh.loop(e).size(), 3u);
      elements += e.area;
    }
    EXPECT_NEAR(patch.area, elements, 1e-13 * elements);
    EXPECT_NEAR(patch.area, pieces, 1e-12 * pieces);
  }
  EXPECT_EQ(element, mesh.elements.size());
  for (std::size_t f = 0; f < facet_area.size(); ++f) {
    if (scene.surfaces[soup.facets()[f].polygon].obstruction_only) continue;
    EXPECT_NEAR(by_patches[f], facet_area[f], 1e-12 * facet_area[f]);
    EXPECT_NEAR(by_elements[f], facet_area[f], 1e-12 * facet_area[f]);
  }
}

PatchMesh sound_mesh(const Scene& scene, double patch_size, std::uint32_t elements_per_edge) {
  const PolygonSoup soup = make_soup(scene);
  PatchMesh mesh = make_patch_mesh(scene, soup, {patch_size, elements_per_edge});
  expect_sound(scene, soup, mesh);
  return mesh;
}

/// Directed edges of all patches' pieces, less their reverses.
std::map<std::pair<Point, Point>, int> unmatched_edges(const PatchMesh& mesh) {
  std::map<std::pair<Point, Point>, int> balance;
  for (const Patch& patch : mesh.patches)
    for (const PatchPiece& piece : mesh.pieces_of(patch)) {
      const auto loop = mesh.loop(piece);
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Point a = key(loop[k]), b = key(loop[(k + 1) % loop.size()]);
        const auto place = balance.try_emplace({std::min(a, b), std::max(a, b)}, 0).first;
        place->second += a < b ? 1 : -1;
        if (place->second == 0) balance.erase(place);
      }
    }
  return balance;
}

const Polygon kTrapezoid{{{0, 0, 0}, {4, 0, 0}, {3, 2, 0}, {0.5, 2, 0}}, {}};
const Polygon kBent{{{0, 0, 0}, {2, 0, 0.3}, {2.2, 1.5, 0}, {0, 1.4, 0.4}}, {}};
const Polygon kTriangle{{{0, 0, 0}, {3, 0, 0}, {1, 2, 0}}, {}};
const Polygon kPentagon{{{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {1, 2.5, 0}, {-0.5, 1, 0}}, {}};
const Polygon kL{{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}}, {}};
const Polygon kDart{{{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5, 1, 0}}, {}};
const Polygon kRing{square(0, 0, 3, 3), {square(1, 1, 2, 2)}};

struct Shape {
  const char* name;
  Polygon polygon;
};

class PatchMeshOf : public testing::TestWithParam<Shape> {};

TEST_P(PatchMeshOf, TilesAtAnySize) {
  for (const bool turn : {false, true})
    for (const double size : {0.0, 10.0, 1.0, 0.3, 0.07})
      for (const std::uint32_t elements : {1u, 2u, 3u}) {
        SCOPED_TRACE(testing::Message() << "turned " << turn << " size " << size << " elements " << elements);
        sound_mesh(scene_of({turn ? turned(GetParam().polygon) : GetParam().polygon}), size, elements);
      }
}

TEST_P(PatchMeshOf, WithoutAPatchSizeIsOnePatchOfWholeFacets) {
  const Scene scene = scene_of({GetParam().polygon});
  const PolygonSoup soup = make_soup(scene);
  const PatchMesh mesh = make_patch_mesh(scene, soup, {});
  ASSERT_EQ(mesh.patches.size(), 1u);
  EXPECT_EQ(mesh.elements.size(), 1u);
  EXPECT_EQ(mesh.pieces.size(), soup.facets().size());
  for (const PatchPiece& piece : mesh.pieces) EXPECT_EQ(piece.loop_count, 0u);
  EXPECT_EQ(mesh.loop(mesh.elements[0]).size(), GetParam().polygon.outer.size());
}

// Every random point of a facet lies in exactly one piece, unless it is within rounding of an edge.
TEST_P(PatchMeshOf, PiecesNeitherOverlapNorLeaveGaps) {
  std::mt19937_64 bits(5);
  const auto random = [&] { return std::ldexp(static_cast<double>(bits() >> 11), -53); };
  const Scene scene = scene_of({turned(GetParam().polygon)});
  const PolygonSoup soup = make_soup(scene);
  const PatchMesh mesh = make_patch_mesh(scene, soup, {0.3, 1});
  for (int trial = 0; trial < 2000; ++trial) {
    const auto f = static_cast<std::uint32_t>(bits() % soup.facets().size());
    const Loop facet = corners(soup, f);
    Vec3 p;
    double sum = 0;
    for (const Vec3& corner : facet) {
      const double weight = -std::log(1 - random());
      p = p + weight * corner;
      sum += weight;
    }
    p = (1 / sum) * p;
    int inside = 0, near = 0;
    for (const Patch& patch : mesh.patches)
      for (const PatchPiece& piece : mesh.pieces_of(patch)) {
        if (piece.facet != f) continue;
        const double d = depth(outline(soup, mesh, piece), p);
        inside += d > 1e-9;
        near += std::fabs(d) <= 1e-9;
      }
    EXPECT_TRUE(inside == 1 || near > 0) << inside;
    EXPECT_LE(inside, 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, PatchMeshOf,
                         testing::Values(Shape{"rectangle", {square(0, 0, 3, 2), {}}}, Shape{"trapezoid", kTrapezoid},
                                         Shape{"bent", kBent}, Shape{"triangle", kTriangle},
                                         Shape{"pentagon", kPentagon}, Shape{"L", kL}, Shape{"dart", kDart},
                                         Shape{"ring", kRing}),
                         [](const auto& test) { return test.param.name; });

TEST(PatchMesh, CutsQuadrilateralsIntoQuadrilateralsOfTheSizeAskedFor) {
  const PatchMesh mesh = sound_mesh(scene_of({{square(0, 0, 3, 2), {}}}), 0.3, 1);
  EXPECT_EQ(mesh.patches.size(), 10u * 7u);
  for (const Patch& patch : mesh.patches) {
    EXPECT_NEAR(patch.area, 6.0 / 70, 1e-15);
    const auto loop = mesh.loop(mesh.pieces[patch.piece_first]);
    ASSERT_EQ(loop.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_LE(norm(loop[(k + 1) % 4] - loop[k]), 0.3 * (1 + 1e-12));
  }
}

TEST(PatchMesh, CutsTrianglesIntoEqualTriangles) {
  const PatchMesh mesh = sound_mesh(scene_of({kTriangle}), 1, 2);
  EXPECT_EQ(mesh.patches.size(), 9u);
  EXPECT_EQ(mesh.elements.size(), 36u);
  for (const Patch& patch : mesh.patches) EXPECT_NEAR(patch.area, 3.0 / 9, 1e-15);
  for (const Element& e : mesh.elements) EXPECT_NEAR(e.area, 3.0 / 36, 1e-15);
}

TEST(PatchMesh, CutsAFloorWithAHoleIntoSquares) {
  for (const double size : {1.0 / 3, 1.0 / 7}) {
    const auto cells = static_cast<std::size_t>(std::lround(3 / size)),
               hole = static_cast<std::size_t>(std::lround(1 / size));
    for (const bool turn : {false, true}) {
      const PatchMesh mesh = sound_mesh(scene_of({turn ? turned(kRing) : kRing}), size, 1);
      EXPECT_EQ(mesh.patches.size(), cells * cells - hole * hole);
      for (const Patch& patch : mesh.patches) EXPECT_NEAR(patch.area, size * size, 1e-14);
    }
  }
}

TEST(PatchMesh, ElementsOfAQuadrilateralAreItsParts) {
  const PatchMesh mesh = sound_mesh(scene_of({{square(0, 0, 2, 1), {}}}), 1, 4);
  ASSERT_EQ(mesh.patches.size(), 2u);
  EXPECT_EQ(mesh.elements.size(), 32u);
  for (const Element& e : mesh.elements) {
    EXPECT_NEAR(e.area, 1.0 / 16, 1e-16);
    EXPECT_EQ(e.sample.z, 0) << "a constant coordinate must stay what it is";
    EXPECT_NEAR(e.sample.x * 8, std::round(e.sample.x * 8), 1e-14) << "the centre";
  }
}

// The two facets of a turned rectangle differ by rounding; of a bent one they are two triangles at an angle.
TEST(PatchMesh, PatchesOnADiagonalLieInPiecesOnBothFacets) {
  for (const Polygon& polygon : {turned({square(0, 0, 3, 2), {}}), kBent, turned(kBent), turned(kTrapezoid)}) {
    const Scene scene = scene_of({polygon});
    const PolygonSoup soup = make_soup(scene);
    if (soup.facets().size() == 1) continue;
    const PatchMesh mesh = make_patch_mesh(scene, soup, {0.3, 1});
    std::size_t bent = 0;
    for (const Patch& patch : mesh.patches) bent += patch.piece_count == 2;
    EXPECT_GE(bent, 5u);
    EXPECT_LT(bent, mesh.patches.size() / 2);
  }
}

TEST(PatchMesh, TurnedSquareIsCutLikeTheSquareItIs) {
  const PatchMesh mesh = sound_mesh(scene_of({turned({square(0, 0, 2, 2), {}})}), 0.25, 1);
  ASSERT_EQ(mesh.patches.size(), 64u);
  for (const Patch& patch : mesh.patches) {
    EXPECT_NEAR(patch.area, 1.0 / 16, 1e-14);
    EXPECT_LE(patch.piece_count, 2u);
  }
}

TEST(PatchMesh, NeighbouringPatchesShareTheirPointsBitForBit) {
  for (const Polygon& polygon : {turned({square(0, 0, 3, 2), {}}), kBent, turned(kTriangle), kTrapezoid}) {
    const PatchMesh mesh = sound_mesh(scene_of({polygon}), 0.3, 1);
    double perimeter = 0, open = 0;
    for (std::size_t k = 0, n = polygon.outer.size(); k < n; ++k)
      perimeter += norm(polygon.outer[(k + 1) % n] - polygon.outer[k]);
    for (const auto& [edge, count] : unmatched_edges(mesh)) {
      EXPECT_EQ(std::abs(count), 1);
      const auto [ax, ay, az] = edge.first;
      const auto [bx, by, bz] = edge.second;
      open += norm(Vec3{bx - ax, by - ay, bz - az});
    }
    EXPECT_NEAR(open, perimeter, 1e-12) << "only the surface's own edges have no neighbour";
  }
}

TEST(PatchMesh, SurfacesShareThePointsOfTheirCommonEdgeBitForBit) {
  const Vec3 a{0.1, 0.2, 0.3}, b{1.7, 0.9, 2.1}, c{-1, 2, 0.4}, d = c + (b - a), e{2, -1, 0.7}, g{0.4, 1.2, 1.1};
  const Polygon quad{{a, b, d, c}, {}}, other{{b, a, e - b + a, e}, {}}, triangle{{b, a, g}, {}};
  const Scene scene = scene_of({quad, other, triangle});
  const PatchMesh mesh = sound_mesh(scene, 0.8, 1);
  const auto on_edge = [&](std::uint32_t surface) {
    std::set<Point> found;
    for (const Patch& patch : mesh.patches)
      if (patch.surface == surface)
        for (const PatchPiece& piece : mesh.pieces_of(patch))
          for (const Vec3& p : mesh.loop(piece))
            if (norm(cross(p - a, normalized(b - a))) < 1e-12) found.insert(key(p));
    return found;
  };
  const auto points = on_edge(0);
  EXPECT_EQ(points.size(), 1 + std::ceil(norm(b - a) / 0.8));
  EXPECT_EQ(on_edge(1), points);
  EXPECT_EQ(on_edge(2), points) << "its longest edge";
}

TEST(PatchMesh, ObstructionsAndZeroAreaGiveNoPatch) {
  Scene scene = scene_of(
      {{square(0, 0, 1, 1), {}}, {square(0, 0, 2, 2), {}}, {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {}}, kTriangle});
  scene.surfaces[0].obstruction_only = true;
  const PolygonSoup soup = make_soup(scene);
  EXPECT_EQ(soup.role(0), Role::sheet);
  EXPECT_EQ(soup.role(1), Role::patch);
  const PatchMesh mesh = make_patch_mesh(scene, soup, {});
  ASSERT_EQ(mesh.patches.size(), 2u);
  EXPECT_EQ(mesh.patches[0].surface, 1u);
  EXPECT_EQ(mesh.patches[1].surface, 3u);
}

/// Corners collinear up to rounding: doubles lose all of the product, which is exactly 1, in its digits.
TEST(PatchMesh, NeedlesKeepTheirAreaAndStayWhole) {
  const double a = 0x1p30;
  const Vec3 tip{a, a - 1, 0}, middle{a - 1, a - 2, 0};
  ASSERT_EQ(cross(middle, tip), Vec3{});
  for (const bool up : {true, false})
    for (const double size : {0.0, 1.0})
      for (const std::uint32_t elements : {1u, 3u}) {
        const Scene scene = scene_of({{{{0, 0, 0}, up ? middle : tip, up ? tip : middle}, {}}});
        const PatchMesh mesh = make_patch_mesh(scene, make_soup(scene), {size, elements});
        ASSERT_EQ(mesh.elements.size(), 1u);
        EXPECT_EQ(mesh.patches[0].area, 0.5);
        EXPECT_EQ(mesh.elements[0].area, 0.5);
        EXPECT_EQ(mesh.elements[0].normal, (Vec3{0, 0, up ? 1.0 : -1.0}));
        EXPECT_EQ(mesh.elements[0].sample.z, 0);
        EXPECT_NEAR(mesh.elements[0].sample.x, 2 * a / 3, 1);
        EXPECT_NEAR(mesh.elements[0].sample.y, 2 * a / 3, 1);
      }
}

/// A square with further vertices on its edges, which rounding moves off them: needles beside the rest of it.
TEST(PatchMesh, VerticesOnEdgesUpToRounding) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> share;
  for (const double far : {0.0, 1e3, 1e6})
    for (int trial = 0; trial < 20; ++trial) {
      const Loop corner = turned({square(0, 0, 3, 3), {}}).outer;
      Polygon polygon;
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 from = corner[k] + Vec3{far, -far, far}, to = corner[(k + 1) % 4] + Vec3{far, -far, far};
        polygon.outer.push_back(from);
        polygon.outer.push_back(from + 0.5 * share(random) * (to - from));
        polygon.outer.push_back(from + (0.5 + 0.5 * share(random)) * (to - from));
      }
      const Scene scene = scene_of({polygon});
      const PolygonSoup soup = make_soup(scene);
      for (const double size : {0.0, 1.0})
        for (const std::uint32_t elements : {1u, 2u}) {
          const PatchMesh mesh = make_patch_mesh(scene, soup, {size, elements});
          double area = 0;
          for (const Patch& patch : mesh.patches) area += patch.area;
          EXPECT_NEAR(area, 9, 1e-14 * (1 + far));
          for (const Element& e : mesh.elements) {
            EXPECT_GT(e.area, 0);
            EXPECT_NEAR(norm(e.normal), 1, 1e-15);
            EXPECT_TRUE(is_finite(e.sample));
          }
        }
    }
}

TEST(PatchMesh, KeepsItsAccuracyFarAwayAndInAnyUnit) {
  for (const double scale : {1e-12, 1e-3, 1e12})
    for (Polygon polygon : {turned(kRing), turned({square(0, 0, 3, 2), {}}), kBent}) {
      for (Vec3& p : polygon.outer) p = scale * p;
      for (Loop& hole : polygon.holes)
        for (Vec3& p : hole) p = scale * p;
      sound_mesh(scene_of({polygon}), 0.3 * scale, 2);
    }
}

TEST(PatchMesh, MeshesAFurnishedRoom) {
  const Scene scene = make_furnished_room(500, 3);
  const PatchMesh whole = sound_mesh(scene, 0, 1);
  EXPECT_EQ(whole.patches.size(), 500u);
  EXPECT_EQ(whole.elements.size(), 500u);
  sound_mesh(scene, 0.25, 2);
}

TEST(PatchMesh, MakesAMillionElements) {
  const Scene scene = scene_of({{square(0, 0, 1, 1), {}}, turned({square(0, 0, 1, 1), {}})});
  const PolygonSoup soup = make_soup(scene);
  const PatchMesh mesh = make_patch_mesh(scene, soup, {0.01, 7});
  EXPECT_EQ(mesh.patches.size(), 20000u);
  EXPECT_EQ(mesh.elements.size(), 980000u);
  double area = 0;
  for (const Patch& patch : mesh.patches) area += patch.area;
  EXPECT_NEAR(area, 2, 1e-12);
}

TEST(PatchMesh, RefusesSenselessSizes) {
  const Scene scene = scene_of({{square(0, 0, 1, 1), {}}, kPentagon, kTriangle});
  const PolygonSoup soup = make_soup(scene);
  EXPECT_THROW(make_patch_mesh(scene, soup, {-1, 1}), std::invalid_argument);
  EXPECT_THROW(make_patch_mesh(scene, soup, {std::nan(""), 1}), std::invalid_argument);
  EXPECT_THROW(make_patch_mesh(scene, soup, {INFINITY, 1}), std::invalid_argument);
  EXPECT_THROW(make_patch_mesh(scene, soup, {1, 0}), std::invalid_argument);
  EXPECT_THROW(make_patch_mesh(scene, soup, {1e-9, 1}), LimitError);
  EXPECT_THROW(make_patch_mesh(scene, soup, {1e-5, 1}), LimitError);
  EXPECT_THROW(make_patch_mesh(scene, soup, {1e-320, 1}), LimitError);
}

TEST(PatchMesh, RefusesWhatWouldNotFitInMemory) {
  const Scene scene = scene_of({{square(0, 0, 1, 1), {}}, {square(1, 0, 2, 1), {}}});
  const PolygonSoup soup = make_soup(scene);
  const auto limited = [](double patch_size, std::uint32_t per_edge) {
    MeshOptions options{patch_size, per_edge};
    options.memory_limit = 100'000'000;
    return options;
  };
  EXPECT_EQ(make_patch_mesh(scene, soup, limited(0.01, 1)).patches.size(), 20000u);
  EXPECT_THROW(make_patch_mesh(scene, soup, limited(0.01, 7)), LimitError);
  try {
    make_patch_mesh(scene, soup, limited(1e-4, 1));
    FAIL();
  } catch (const LimitError& refused) {
    EXPECT_THAT(refused.what(), testing::HasSubstr("2e+08 patches"));
  }
}

/// The estimate is what is refused, so it must be no less than what a mesh takes, nor many times as much.
TEST(PatchMesh, EstimatesItsMemory) {
  const std::vector<Polygon> polygons = {{square(0, 0, 1, 1), {}}, kPentagon, kTriangle};
  for (const Polygon& polygon : polygons) {
    for (const std::uint32_t per_edge : {1u, 3u}) {
      const Scene scene = scene_of({polygon});
      const PolygonSoup soup = make_soup(scene);
      const PatchMesh mesh = make_patch_mesh(scene, soup, {0.02, per_edge});
      const std::uint64_t bytes = mesh.points.size() * sizeof(Vec3) + mesh.pieces.size() * sizeof(PatchPiece) +
                                  mesh.patches.size() * sizeof(Patch) + mesh.elements.size() * sizeof(Element);
      const auto limited_to = [&](std::uint64_t limit) {
        MeshOptions options{0.02, per_edge};
        options.memory_limit = limit;
        return options;
      };
      EXPECT_THROW(make_patch_mesh(scene, soup, limited_to(bytes)), LimitError) << per_edge;
      EXPECT_NO_THROW(make_patch_mesh(scene, soup, limited_to(8 * bytes))) << per_edge;
    }
  }
}

}  // namespace
}  // namespace exitance
