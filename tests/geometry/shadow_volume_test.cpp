#include "geometry/shadow_volume.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <span>

#include "geometry/viewpoint.h"

namespace exitance {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double between(double a, double b) { return a + (b - a) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits_() % n); }
  Vec3 in_box(double r) { return {between(-r, r), between(-r, r), between(-r, r)}; }

 private:
  std::mt19937_64 bits_;
};

using Faces = std::vector<Polygon>;

void add_box(Faces& faces, const Vec3& a, const Vec3& b) {
  const auto add = [&](std::vector<Vec3> loop) { faces.push_back({std::move(loop), {}}); };
  add({{a.x, a.y, a.z}, {a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, a.y, a.z}});
  add({{a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z}});
  add({{a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z}});
  add({{a.x, b.y, a.z}, {a.x, b.y, b.z}, {b.x, b.y, b.z}, {b.x, b.y, a.z}});
  add({{a.x, a.y, a.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}, {a.x, b.y, a.z}});
  add({{b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {b.x, a.y, b.z}});
}

/// Of some kinds: convex, a sheet, concave, in several parts, needles.
Faces object_of_kind(std::uint32_t kind, Random& random) {
  Faces faces;
  switch (kind) {
    case 0:
      add_box(faces, {-0.25, -0.25, 0.75}, {0.25, 0.25, 1.25});
      break;
    case 1:  // no solid
      faces.push_back({{{-0.5, -0.25, 1}, {0.5, -0.25, 1}, {0.5, 0.25, 1}, {-0.5, 0.25, 1}}, {}});
      break;
    case 2: {  // an L in one piece, concave
      const std::vector<Vec3> top = {{-0.5, -0.5, 1.25}, {0.5, -0.5, 1.25}, {0.5, 0, 1.25},
                                     {0, 0, 1.25},       {0, 0.5, 1.25},    {-0.5, 0.5, 1.25}};
      std::vector<Vec3> bottom(top.rbegin(), top.rend());
      for (Vec3& v : bottom) v.z = 1;
      for (std::size_t k = 0; k < top.size(); ++k) {
        const Vec3 p = top[k], q = top[(k + 1) % top.size()];
        faces.push_back({{{p.x, p.y, 1}, {q.x, q.y, 1}, q, p}, {}});
      }
      faces.push_back({top, {}});
      faces.push_back({bottom, {}});
      break;
    }
    case 3:  // parts that touch and parts that don't
      add_box(faces, {-0.5, -0.5, 0.5}, {-0.25, 0.5, 1});
      add_box(faces, {-0.25, -0.25, 0.5}, {0, 0.25, 0.75});
      add_box(faces, {0.25, 0, 1.25}, {0.5, 0.25, 1.5});
      break;
    case 4:  // hides all from some
      add_box(faces, {-1, -0.75, 0.5}, {1, 0.75, 1});
      break;
    default:  // needles
      for (int k = 0; k < 3; ++k) {
        const Vec3 at = random.in_box(0.4) + Vec3{0, 0, 1};
        faces.push_back({{at, at + Vec3{1, 0.001, 0}, at + Vec3{0.5, 1e-6, 0.25}}, {}});
      }
  }
  return faces;
}

Vec3 turned(const Vec3& v, int way) {
  if (way == 0) return v;
  const double c = 0.8, s = 0.6;
  const Vec3 w{c * v.x - s * v.y, s * v.x + c * v.y, v.z};
  if (way == 1) return w;
  return {w.x, 0.28 * w.y - 0.96 * w.z, 0.96 * w.y + 0.28 * w.z};
}

/// A shooter over a floor, an object between and a screen beside, with and without the object.
struct Stage {
  Faces with, without;
  std::uint32_t first = 0, last = 0;  // polygons of the object
};

Stage stage_of(std::uint32_t kind, int way, Random& random) {
  Stage stage;
  stage.without.push_back({{{-0.5, -0.5, 2}, {-0.5, 0.5, 2}, {0.5, 0.5, 2}, {0.5, -0.5, 2}}, {}});  // shines down
  stage.without.push_back({{{-6, -5, 0}, {6, -5, 0}, {0, 8, 0}}, {}});
  stage.without.push_back({{{0.75, -0.5, 0.25}, {1, -0.5, 1}, {1, 0.5, 1}, {0.75, 0.5, 0.25}}, {}});
  stage.with = stage.without;
  stage.first = static_cast<std::uint32_t>(stage.with.size());
  for (const Polygon& face : object_of_kind(kind, random)) stage.with.push_back(face);
  stage.last = static_cast<std::uint32_t>(stage.with.size());
  for (Faces* faces : {&stage.with, &stage.without}) {
    for (Polygon& face : *faces) {
      for (Vec3& v : face.outer) v = turned(v, way);
    }
  }
  return stage;
}

// Brute force: no point whose form factor changes is outside, nothing is seen from the umbra, and what changes lies in
// the region that is searched. Points lie on a lattice (in planes of faces and their edges) and anywhere.
TEST(ShadowVolume, NeverMissesASamplePointAndTellsTheUmbra) {
  Random random(1);
  std::array<std::size_t, 3> counts{};
  std::size_t idle = 0, changed = 0;
  for (std::uint32_t kind = 0; kind < 6; ++kind) {
    for (int way = 0; way < 3; ++way) {
      const Stage stage = stage_of(kind, way, random);
      const PolygonSoup with(stage.with), without(stage.without);
      ShadowCaster caster(with, with.first_facet(stage.first), with.first_facet(stage.last));
      ShadowVolume volume(caster);
      volume.set_shooter({0, {}});
      Viewpoint view(with), free_view(without);
      ASSERT_EQ(with.first_facet(1) + 1, with.first_facet(2)) << "a triangle is not bent";
      for (int k = 0; k < 300; ++k) {
        const bool lattice = k % 3 == 0;
        const Vec3 at{lattice ? 0.25 * (random.below(15) - 7.0) : random.between(-1.9, 1.9),
                      lattice ? 0.25 * (random.below(15) - 7.0) : random.between(-1.9, 1.9), 0};
        const Receiver receiver{turned(at, way), turned({0, 0, 1}, way), with.first_facet(1)};
        view.look_from(receiver);
        free_view.look_from(receiver);
        const PointFormFactor seen = view.form_factor({0, {}}), free = free_view.form_factor({0, {}});
        const Shade shade = volume.at(receiver);
        ++counts[static_cast<std::size_t>(shade)];
        const bool differs = std::fabs(seen.F - free.F) > seen.error + free.error;
        changed += differs;
        if (shade == Shade::outside) {
          EXPECT_FALSE(differs) << kind << ' ' << way << ": " << free.F << " to " << seen.F << " at " << at.x << ' '
                                << at.y;
        } else {
          idle += !differs && free.F > free.error;
        }
        if (shade == Shade::umbra) {
          EXPECT_LE(seen.F, seen.error) << kind << ' ' << way;
        }
        if (differs) {
          for (const HalfSpace& h : volume.region()) EXPECT_GE(dot(h.normal, receiver.point), h.offset);
        }
      }
    }
  }
  EXPECT_GT(changed, 300u);
  EXPECT_GT(counts[0], 300u);
  EXPECT_GT(counts[2], 20u);
  EXPECT_LT(static_cast<double>(idle), 0.1 * static_cast<double>(changed))
      << "few that did not change are found: " << idle << " beside " << changed;
}

/// Screens of a kind under a small object: two boxes and a sheet that touch, overlap or leave gaps.
Faces screens_of(Random& random) {
  Faces faces;
  const double gap = random.below(3) == 0 ? 0.05 : 0, shift = 0.125 * (random.below(3) - 1.0);
  add_box(faces, {-0.75, -0.75, 0.5}, {shift - gap, 0.75, 0.6});
  add_box(faces, {shift, -0.75, 0.5}, {0.75, 0.125, 0.6 + 0.1 * random.below(2)});
  faces.push_back(
      {{{shift - 0.25, 0.125, 0.55}, {0.75, 0.125, 0.55}, {0.75, 0.75, 0.7}, {shift - 0.25, 0.75, 0.7}}, {}});
  return faces;
}

// Brute force: where screens hide together what the object would hide no form factor changes, and they are found where
// none of them does so alone.
TEST(ShadowVolume, ScreensHideTogetherWhatTheObjectWould) {
  Random random(3);
  std::size_t together = 0, alone = 0, changed = 0, idle = 0;
  for (int k = 0; k < 90; ++k) {
    const int way = k % 3;
    Faces without;
    without.push_back({{{-0.5, -0.5, 2}, {-0.5, 0.5, 2}, {0.5, 0.5, 2}, {0.5, -0.5, 2}}, {}});  // shines down
    without.push_back({{{-6, -5, 0}, {6, -5, 0}, {0, 8, 0}}, {}});
    for (const Polygon& face : screens_of(random)) without.push_back(face);
    Faces with = without;
    const auto first = static_cast<std::uint32_t>(with.size());
    const Vec3 low{random.between(-0.75, 0.5), random.between(-0.75, 0.5), k % 2 == 0 ? 0.75 : 0.125};
    add_box(with, low, low + Vec3{0.25, 0.25, 0.25});
    for (Faces* faces : {&with, &without}) {
      for (Polygon& face : *faces) {
        for (Vec3& v : face.outer) v = turned(v, way);
      }
    }
    const PolygonSoup soup(with), free_soup(without);
    std::vector<std::uint32_t> screens;
    for (std::uint32_t f = soup.first_facet(2); f < soup.first_facet(first); ++f) {
      const std::uint32_t shell = soup.facets()[f].shell;
      const bool is_solid = shell != kNone && soup.shells()[shell].convex;
      screens.push_back(is_solid ? static_cast<std::uint32_t>(soup.facets().size()) + shell : f);
    }
    screens.erase(std::unique(screens.begin(), screens.end()), screens.end());
    ShadowCaster caster(soup, soup.first_facet(first), static_cast<std::uint32_t>(soup.facets().size()));
    ShadowVolume volume(caster);
    volume.set_shooter({0, {}});
    Viewpoint view(soup), free_view(free_soup);
    for (int i = 0; i < 120; ++i) {
      const Vec3 at = i % 3 == 0 ? Vec3{0.25 * (random.below(9) - 4.0), 0.25 * (random.below(9) - 4.0), 0}
                                 : Vec3{random.between(-1.5, 1.5), random.between(-1.5, 1.5), 0};
      const Receiver receiver{turned(at, way), turned({0, 0, 1}, way), soup.first_facet(1)};
      view.look_from(receiver);
      free_view.look_from(receiver);
      const PointFormFactor seen = view.form_factor({0, {}}), free = free_view.form_factor({0, {}});
      const bool differs = std::fabs(seen.F - free.F) > seen.error + free.error;
      changed += differs;
      const bool enters = volume.at(receiver) != Shade::outside;
      if (volume.at(receiver, screens) == Shade::outside) {
        EXPECT_FALSE(differs) << k << ": " << free.F << " to " << seen.F << " at " << at.x << ' ' << at.y;
        const bool by_one = std::ranges::any_of(screens, [&](const std::uint32_t& s) {
          return volume.at(receiver, {&s, 1}) == Shade::outside;
        });
        alone += enters && by_one;
        together += !by_one;
      } else {
        idle += !differs;
      }
    }
  }
  EXPECT_GT(changed, 100u);
  EXPECT_GT(alone, 100u);
  EXPECT_GT(together, 100u);
  EXPECT_LE(idle, 2u) << "screens in front of the shooter are told exactly";
}

// Of polygons: outside where no sample point's form factor changes, umbra where none sees anything.
TEST(ShadowVolume, ClassifiesPolygonsAsTheirPointsSay) {
  Random random(2);
  std::array<std::size_t, 3> counts{};
  for (std::uint32_t kind = 0; kind < 6; ++kind) {
    Stage stage = stage_of(kind, 0, random);
    for (int k = 0; k < 25; ++k) {  // squares on the floor, some meeting at the shadow's lines
      const double x = 0.5 * (random.below(16) - 8.0), y = 0.5 * (random.below(16) - 8.0), s = k % 2 ? 0.25 : 0.1;
      stage.with.push_back({{{x, y, -0.5}, {x + s, y, -0.5}, {x + s, y + s, -0.5}, {x, y + s, -0.5}}, {}});
    }
    stage.with.erase(stage.with.begin() + 1);  // no floor
    --stage.first;
    --stage.last;
    Faces without(stage.with);
    without.erase(without.begin() + stage.first, without.begin() + stage.last);
    const PolygonSoup with(stage.with), free(without);
    ShadowCaster caster(with, with.first_facet(stage.first), with.first_facet(stage.last));
    ShadowVolume volume(caster);
    volume.set_shooter({0, {}});
    Viewpoint view(with), free_view(free);
    for (std::uint32_t p = stage.last; p < stage.with.size(); ++p) {
      const std::uint32_t facet = with.first_facet(p);
      const Shade shade = volume.of({facet, {}});
      ++counts[static_cast<std::size_t>(shade)];
      const auto& loop = stage.with[p].outer;
      for (int i = 0; i < 20; ++i) {
        const Vec3 at =
            loop[0] + random.between(0, 1) * (loop[1] - loop[0]) + random.between(0, 1) * (loop[3] - loop[0]);
        const Vec3 normal{0, 0, 1};
        view.look_from({at, normal, facet});
        free_view.look_from({at, normal, free.first_facet(p - (stage.last - stage.first))});
        const PointFormFactor seen = view.form_factor({0, {}}), unhidden = free_view.form_factor({0, {}});
        if (shade == Shade::outside) {
          EXPECT_NEAR(seen.F, unhidden.F, seen.error + unhidden.error);
        }
        if (shade == Shade::umbra) {
          EXPECT_LE(seen.F, seen.error);
        }
      }
    }
  }
  EXPECT_GT(counts[0], 10u);
  EXPECT_GT(counts[1], 10u);
}

// A sheet or a box before the object or behind it, as seen from the floor: what it hides the object cannot take.
TEST(ShadowVolume, WhatAScreenHidesTakesNothing) {
  Random random(3);
  std::size_t screened = 0, changed = 0;
  for (int kind = 0; kind < 4; ++kind) {
    for (int way = 0; way < 3; ++way) {
      const double z = kind % 2 == 0 ? 0.5 : 1.5;
      Faces faces = {{{{-0.5, -0.5, 2}, {-0.5, 0.5, 2}, {0.5, 0.5, 2}, {0.5, -0.5, 2}}, {}},
                     {{{-6, -5, 0}, {6, -5, 0}, {0, 8, 0}}, {}}};
      if (kind < 2) {
        faces.push_back({{{-0.75, -0.75, z}, {0.75, -0.75, z}, {0, 1.25, z}}, {}});
      } else {
        add_box(faces, {-0.5, -0.5, z - 0.125}, {0.5, 0.5, z + 0.125});
      }
      const auto object = static_cast<std::uint32_t>(faces.size());
      faces.push_back({{{-0.25, -0.25, 1}, {0.25, -0.25, 1}, {0, 0.25, 1}}, {}});
      for (Polygon& face : faces) {
        for (Vec3& v : face.outer) v = turned(v, way);
      }
      const std::span<const Polygon> all = faces;
      const PolygonSoup with(all), without(all.first(object));
      ShadowCaster caster(with, with.first_facet(object), with.first_facet(object + 1));
      ShadowVolume volume(caster);
      volume.set_shooter({0, {}});
      ASSERT_EQ(with.shells().size(), kind < 2 ? 0u : 1u);
      const std::uint32_t screen =
          kind < 2 ? with.first_facet(2) : static_cast<std::uint32_t>(with.facets().size());  // the first shell's item
      Viewpoint view(with), free_view(without);
      for (int k = 0; k < 400; ++k) {
        const Receiver receiver{turned({random.between(-1, 1), random.between(-1, 1), 0}, way), turned({0, 0, 1}, way),
                                with.first_facet(1)};
        view.look_from(receiver);
        free_view.look_from(receiver);
        const PointFormFactor seen = view.form_factor({0, {}}), free = free_view.form_factor({0, {}});
        const bool differs = std::fabs(seen.F - free.F) > seen.error + free.error;
        const bool is_outside = volume.at(receiver, {&screen, 1}) == Shade::outside;
        EXPECT_FALSE(differs && is_outside) << kind << ' ' << way << ": " << free.F << " to " << seen.F;
        screened += is_outside && volume.at(receiver) != Shade::outside;
        changed += differs;
      }
    }
  }
  EXPECT_GT(screened, 200u);
  EXPECT_GT(changed, 200u);
}

TEST(ShadowVolume, ARugOnTheShooterCoversItForAll) {
  Faces faces = {{{{-1, -1, 2}, {-1, 1, 2}, {1, 1, 2}, {1, -1, 2}}, {}},
                 {{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}}, {}},
                 {{{-0.5, -0.5, 2}, {-0.5, 0.5, 2}, {0.5, 0.5, 2}, {0.5, -0.5, 2}}, {}}};
  const PolygonSoup soup(faces);
  ShadowCaster caster(soup, 2, 3);
  ShadowVolume volume(caster);
  volume.set_shooter({0, {}});
  EXPECT_TRUE(volume.covers_shooter());
  EXPECT_EQ(volume.at({{1.5, 1.5, 0}, {0, 0, 1}, 1}), Shade::penumbra);
  EXPECT_EQ(volume.of({1, {}}), Shade::penumbra);
}

TEST(ShadowVolume, ARugOnTheReceiverTakesAllOfAPointUnderIt) {
  Faces faces = {{{{-1, -1, 2}, {-1, 1, 2}, {1, 1, 2}, {1, -1, 2}}, {}},
                 {{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}}, {}},
                 {{{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}}, {}}};
  const PolygonSoup soup(faces);
  ShadowCaster caster(soup, 2, 3);
  ShadowVolume volume(caster);
  volume.set_shooter({0, {}});
  EXPECT_EQ(volume.at({{0.25, 0.25, 0}, {0, 0, 1}, 1}), Shade::penumbra);
  EXPECT_EQ(volume.at({{1.5, 0.25, 0}, {0, 0, 1}, 1}), Shade::outside);
}

TEST(ShadowVolume, NothingBehindTheShooterIsShaded) {
  Faces faces = {{{{-1, -1, 2}, {-1, 1, 2}, {1, 1, 2}, {1, -1, 2}}, {}},
                 {{{-2, -2, 4}, {-2, 2, 4}, {2, 2, 4}, {2, -2, 4}}, {}}};
  add_box(faces, {-0.25, -0.25, 2.5}, {0.25, 0.25, 3});
  const PolygonSoup soup(faces);
  ShadowCaster caster(soup, 2, 8);
  ShadowVolume volume(caster);
  volume.set_shooter({0, {}});
  EXPECT_EQ(volume.at({{0, 0, 4}, {0, 0, -1}, 1}), Shade::outside);
  EXPECT_EQ(volume.of({1, {}}), Shade::outside);
}

}  // namespace
}  // namespace exitance
