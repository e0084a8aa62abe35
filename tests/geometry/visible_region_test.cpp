// The kernel against the oracle, in every degenerate position.

#include "geometry/visible_region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "geometry/polygon_soup.h"
#include "geometry/viewpoint.h"
#include "src/stress/visibility_oracle.h"
#include "tests/geometry/degenerate_cases.h"
#include "tests/geometry/solids.h"

namespace exitance {
namespace {

struct Scene {
  std::vector<Polygon> polygons;
  std::vector<Role> roles;
};

/// The source is polygon 0.
Scene scene_of(const PointCase& question) {
  Scene scene{{question.source}, {Role::unoccluding}};
  for (const Obstacle& occluder : question.occluders) {
    for (const Polygon& face : occluder.faces) {
      scene.polygons.push_back(face);
      scene.roles.push_back(occluder.solid ? Role::solid_face : Role::sheet);
    }
  }
  return scene;
}

struct KernelAnswer {
  long double F = 0, error = 0, visible_area = 0;
};

KernelAnswer ask_kernel(const PointCase& question) {
  const Scene scene = scene_of(question);
  const PolygonSoup soup(scene.polygons, scene.roles);
  Viewpoint viewpoint(soup);
  viewpoint.look_from({question.point, question.normal});
  KernelAnswer answer;
  for (std::uint32_t facet = soup.first_facet(0); facet < soup.first_facet(1); ++facet) {
    const PointFormFactor part = viewpoint.form_factor({facet, {}});
    if (part.side != Side::front) continue;
    answer.F += part.F;
    answer.error += part.error;
    answer.visible_area += area(viewpoint.visible_region({facet, {}}));
  }
  return answer;
}

/// A region's corners are rounded and come without a bound, so its area is held to what tells a wrong region from a
/// right one.
double area_tolerance(const PointCase& question) {
  double extent = 0, perimeter = 0;
  const auto& loop = question.source.outer;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    extent = std::max({extent, std::abs(loop[i].x), std::abs(loop[i].y), std::abs(loop[i].z)});
    perimeter += norm(loop[(i + 1) % loop.size()] - loop[i]);
  }
  return 1e-11 * perimeter * extent + 1e-6 * norm(area_vector(question.source));
}

std::string family_of(const PointCase& question) {
  return question.name.substr(0, question.name.find('/'));
}

std::vector<std::string> families() {
  std::vector<std::string> names;
  for (const PointCase& question : degenerate_cases()) names.push_back(family_of(question));
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

class DegenerateFamily : public testing::TestWithParam<std::string> {};

TEST_P(DegenerateFamily, AgreesWithTheOracle) {
  for (const PointCase& question : degenerate_cases()) {
    if (family_of(question) != GetParam()) continue;
    const OracleAnswer truth =
        oracle_form_factor({question.point, question.normal, question.source, question.occluders});
    const KernelAnswer answer = ask_kernel(question);
    const long double error = std::abs(answer.F - truth.F);
    EXPECT_LE(error, 1e-12L) << question.name << ": " << answer.F << " instead of " << truth.F;
    EXPECT_LE(error, answer.error) << question.name << ": the bound does not hold";
    EXPECT_LE(answer.error, 1e-11L) << question.name << ": the bound is no help";
    EXPECT_LE(std::abs(answer.visible_area - truth.visible_area), area_tolerance(question))
        << question.name << ": area " << answer.visible_area << " instead of " << truth.visible_area;
  }
}

INSTANTIATE_TEST_SUITE_P(VisibleRegion, DegenerateFamily, testing::ValuesIn(families()),
                         [](const auto& family) { return family.param; });

// Of a source nothing is there where nothing rises above the horizon, be it that corners touch it.
TEST(VisibleRegion, OfASourceThatOnlyTouchesTheHorizonIsNone) {
  const Polygon source{{{2, -1, 0}, {2, 1, 0}, {3, 0, -1}}, {}};
  const PolygonSoup soup(std::vector<Polygon>{source});
  View view(soup);
  const std::vector<const Vec3*> corners{&soup.vertices()[0], &soup.vertices()[1], &soup.vertices()[2]};
  for (const double level : {-0.5, 0.0, 0.5}) {
    view.look_from({{0, 0, level}, {0, 0, 1}});
    const std::vector<int> horizon{view.horizon(0), view.horizon(1), view.horizon(2)};
    VisibleRegion<double> region(view);
    EXPECT_EQ(region.set_source(0, view.side(0), corners, horizon, nullptr), level < 0) << level;
  }
}

// A solid around a corner of the source's cone, outside of no side of it alone, hides nothing; moved towards the middle
// it hides a part.
TEST(VisibleRegion, ASolidAroundACornerHidesNothing) {
  for (const bool turn : {false, true}) {
    const auto placed = [&](const Vec3& v) { return turn ? Vec3{3 * v.x - 4 * v.z, 5 * v.y, 4 * v.x + 3 * v.z} : v; };
    for (const double moved : {0.0, -4.0}) {
      std::vector<Polygon> polygons = prism({{6, -24}, {24, -24}, {24, 24}, {-24, 24}, {-24, 6}, {6, 6}}, 8, 16);
      for (Polygon& face : polygons) {
        for (Vec3& v : face.outer) v = v + Vec3{moved, moved, 0};
      }
      const auto source = static_cast<std::uint32_t>(polygons.size());
      polygons.push_back({{{-8, -8, 32}, {-8, 8, 32}, {8, 8, 32}, {8, -8, 32}}, {}});
      for (Polygon& polygon : polygons) std::ranges::transform(polygon.outer, polygon.outer.begin(), placed);
      const PolygonSoup soup(polygons);
      ASSERT_EQ(soup.shells().size(), 1u);
      View view(soup);
      view.look_from({{0, 0, 0}, placed({0, 0, 1})});
      std::vector<const Vec3*> corners;
      for (const Vec3& v : polygons[source].outer) corners.push_back(&v);
      const std::uint32_t facet = soup.first_facet(source);
      VisibleRegion<double> region(view);
      ASSERT_TRUE(region.set_source(facet, view.side(facet), corners, std::vector<int>{1, 1, 1, 1}, nullptr));
      ASSERT_TRUE(region.has_silhouette(0));
      using Effect = VisibleRegion<double>::Effect;
      EXPECT_EQ(region.add({kNone, 0}), moved == 0 ? Effect::none : Effect::part) << turn;
    }
  }
}

}  // namespace
}  // namespace exitance
