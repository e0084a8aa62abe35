// What the sieve tells at a glance, against the exact tests: those of long double, which ask no sieve.

#include "geometry/sieve.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/visible_region.h"
#include "tests/geometry/degenerate_cases.h"

namespace exitance {
namespace {

/// Of one facet after the other, what it does to the source.
template <class Real>
std::vector<typename VisibleRegion<Real>::Effect> effects(View& view, const PolygonSoup& soup, std::uint32_t source,
                                                          int facing) {
  VisibleRegion<Real> region(view);
  std::vector<const Vec3*> corners;
  std::vector<int> horizon;
  for (const Corner& c : soup.corners(soup.facets()[source])) {
    corners.push_back(&soup.vertices()[c.vertex]);
    horizon.push_back(view.horizon(c.vertex));
  }
  std::vector<typename VisibleRegion<Real>::Effect> effects;
  for (std::uint32_t f = 0; f < soup.facets().size(); ++f) {
    if (!region.set_source(source, facing, corners, horizon, nullptr)) break;
    const bool is_missed = std::is_same_v<Real, double> && region.misses(f);
    effects.push_back(is_missed ? VisibleRegion<Real>::Effect::none : region.add({f, kNone}));
  }
  return effects;
}

TEST(Sieve, HoldsBackWhatHidesNothing) {
  std::size_t facets = 0, idle = 0, held_back = 0, back = 0, between = 0, inside = 0;
  for (const PointCase& question : degenerate_cases()) {
    std::vector<Polygon> polygons{question.source};
    std::vector<Role> roles{Role::unoccluding};
    for (const Obstacle& occluder : question.occluders) {
      for (const Polygon& face : occluder.faces) {
        polygons.push_back(face);
        roles.push_back(occluder.solid ? Role::solid_face : Role::sheet);
      }
    }
    const PolygonSoup soup(polygons, roles);
    View view(soup);
    view.look_from({question.point, question.normal});
    for (std::uint32_t source = soup.first_facet(0); source < soup.first_facet(1); ++source) {
      const int facing = view.side(source);
      if (facing == 0) continue;
      const auto by_sieve = effects<double>(view, soup, source, facing);
      const auto exact = effects<long double>(view, soup, source, facing);
      ASSERT_EQ(by_sieve.size(), exact.size());
      for (std::size_t f = 0; f < exact.size(); ++f) {
        EXPECT_EQ(static_cast<int>(by_sieve[f]), static_cast<int>(exact[f])) << question.name << ", facet " << f;
      }
      // How often it says something, of facets that might be asked about.
      VisibleRegion<double> region(view);
      std::vector<const Vec3*> corners;
      std::vector<int> horizon;
      for (const Corner& c : soup.corners(soup.facets()[source])) {
        corners.push_back(&soup.vertices()[c.vertex]);
        horizon.push_back(view.horizon(c.vertex));
      }
      if (!region.set_source(source, facing, corners, horizon, nullptr)) continue;
      Sieve sieve;
      sieve.set(view.receiver(), soup.facets()[source].plane, facing, region.source(), soup.vertices());
      for (std::uint32_t f = 0; f < exact.size(); ++f) {
        if (f == source) continue;
        if (sieve.glance(soup.first_corners(f)) == Sieve::Glance::back) {
          ++back;
          EXPECT_LT(view.side(f), 0) << question.name << ", facet " << f;
        }
        if (view.facing(f) == 0) continue;
        ++facets;
        const bool hides = exact[f] != VisibleRegion<long double>::Effect::none;
        idle += !hides;
        const auto verdict = sieve.judge(soup.facets()[f].plane, soup.first_corners(f), view.facing(f));
        held_back += !hides && verdict == Sieve::Verdict::held_back;
        between += verdict == Sieve::Verdict::between;
        inside += verdict == Sieve::Verdict::inside;
      }
    }
  }
  EXPECT_GT(held_back, idle / 3) << "of " << idle << " that hide nothing";
  EXPECT_GT(between, facets / 8);
  EXPECT_GT(inside, 0u);
  EXPECT_GT(back, 0u);
}

}  // namespace
}  // namespace exitance
