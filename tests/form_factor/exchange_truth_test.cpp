// Obstructed form factors against truth by another algorithm (exchange_truth.h). Values that take long stand in truth/,
// one file a scene; the disabled tests Write add what is missing (--gtest_also_run_disabled_tests).

#include "src/stress/exchange_truth.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <string>

#include "src/form_factor/pair_form_factor.h"
#include "src/stress/placement.h"
#include "tests/form_factor/closed_forms.h"
#include "tests/form_factor/exchange_scenes.h"
#include "tests/places.h"

namespace exitance {
namespace {

using Loop = std::vector<Vec3>;

Loop rectangle(double z, double x0, double y0, double x1, double y1) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}
Loop turned_over(Loop loop) {
  std::ranges::reverse(loop);
  return loop;
}
const Loop kFloor = rectangle(0, 0, 0, 1, 1), kCeiling = turned_over(rectangle(1, 0, 0, 1, 1)),
           kPlate = rectangle(0.75, 0.25, 0.25, 0.75, 0.75);
Loop wall(double x) {
  return {{x, 0, 0}, {x, 1, 0}, {x, 1, 1}, {x, 0, 1}};
}

/// A rotation without zeros; coordinates are rounded.
KnownPair turned(KnownPair pair) {
  const double s = 1.0 / 7;
  const auto turn = [&](Loop& loop) {
    for (Vec3& p : loop) {
      p = Vec3{0.1, 0.2, 0.3} + p.x * Vec3{2 * s, 3 * s, 6 * s} + p.y * Vec3{-6 * s, -2 * s, 3 * s} +
          p.z * Vec3{3 * s, -6 * s, 2 * s};
    }
  };
  turn(pair.receiver);
  turn(pair.source);
  for (ConvexBody& body : pair.occluders) std::ranges::for_each(body, turn);
  return pair;
}

PairFormFactor product_of(const KnownPair& pair, double tolerance, double relative = 0) {
  const PolygonSoup soup = soup_of(pair);
  const ExchangeScene scene(soup);
  PairOptions options;
  options.tolerance = tolerance;
  options.relative = relative;
  return PairIntegrator(scene).form_factor(0, 1, options);
}
double area_of(const Loop& loop) {
  return norm(area_vector(loop));
}

struct SinglePair {
  std::string name;
  KnownPair pair;
  std::optional<long double> F;  ///< in closed form
};

/// Bodies of closed boxes, from a to b.
ConvexBody box(const Vec3& a, const Vec3& b) {
  const auto corner = [&](int i) { return Vec3{i & 1 ? b.x : a.x, i & 2 ? b.y : a.y, i & 4 ? b.z : a.z}; };
  ConvexBody faces;
  for (const auto& f : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    faces.push_back({corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])});
  }
  return faces;
}

std::vector<SinglePair> single_pairs() {
  std::vector<SinglePair> pairs;
  const auto add = [&](std::string name, std::vector<ConvexBody> occluders, std::optional<long double> F = {},
                       const Loop& source = kCeiling) {
    pairs.push_back({std::move(name), {kFloor, source, std::move(occluders)}, F});
  };
  const long double half = opposite_rectangles(0.5L, 1, 1);
  add("plate of half the side", {{kPlate}}, kShapiroBlocked);
  add("duplicated", {{kPlate}, {kPlate}, {turned_over(kPlate)}}, kShapiroBlocked);
  add("abutting", {{{kPlate[0], kPlate[1], kPlate[2]}}, {{kPlate[0], kPlate[2], kPlate[3]}}}, kShapiroBlocked);
  add("partition that joins both plates", {{wall(0.5)}}, half);
  add("partition beyond both plates", {{{{0.5, -1, -1}, {0.5, 2, -1}, {0.5, 2, 2}, {0.5, -1, 2}}}}, half);
  // Between partitions every compartment sees its own part only.
  add("three partitions", {{wall(0.25)}, {wall(0.5)}, {wall(0.75)}}, opposite_rectangles(0.25L, 1, 1));
  {
    std::vector<ConvexBody> louvres;
    for (int k = 1; k < 4; ++k)
      louvres.push_back({{{k / 4., 0, .25}, {k / 4., 1, .25}, {k / 4., 1, .75}, {k / 4., 0, .75}}});
    add("louvres", louvres);
  }
  add("closed box", {box({0.25, 0.375, 0.25}, {0.625, 0.75, 0.5})});
  add("two closed boxes that abut",
      {box({0.25, 0.25, 0.25}, {0.5, 0.75, 0.5}), box({0.5, 0.25, 0.25}, {0.75, 0.75, 0.75})});
  {
    std::vector<ConvexBody> many;
    for (int k = 0; k < 5; ++k) {
      const double x = 0.125 + k % 3 * 0.25, y = 0.0625 + k % 2 * 0.5, z = 0.25 + k / 8.0;
      many.push_back({rectangle(z, x, y, x + 0.1875, y + 0.375)});
    }
    add("many plates", many);
  }
  add("hovering", {{rectangle(0x1p-12, 0.25, 0.25, 0.75, 0.75)}});
  add("slit", {{{{-1, -1, .5}, {.5, -1, .5}, {.5, 2, .5}, {-1, 2, .5}}},
               {{{.5 + 0x1p-30, -1, .5}, {2, -1, .5}, {2, 2, .5}, {.5 + 0x1p-30, 2, .5}}}});
  add("hinged, partly covered", {{rectangle(0.25, 0.25, 0.25, 0.75, 0.75)}}, {}, wall(0));
  return pairs;
}

/// Halves of two walls, and two screens that each touch one of them with an edge: events that start in the contacts
/// run beside it at first.
KnownPair screens_on_walls() {
  return {{{4, 0, 4}, {4, 4, 0}, {4, 0, 0}},
          {{4, 4, 4}, {0, 4, 4}, {0, 4, 0}},
          {{{{2, 2, 0}, {2, 3, 0}, {2, 3, 2}, {2, 2, 2}}}, {{{4, 2, 0}, {3, 2, 0}, {3, 2, 2}, {4, 2, 2}}}}};
}

/// Ceiling and wall of a room past three sides of a box that hangs from the ceiling, and a triangle beside it.
KnownPair hanging_sides() {
  return {{{0, 4, 4}, {4, 4, 4}, {4, 0, 4}, {0, 0, 4}},
          {{4, 4, 4}, {0, 4, 4}, {0, 4, 0}, {4, 4, 0}},
          {{{{2, 1, 3}, {2, 2, 3}, {3, 1, 3}}},
           {{{1.5, 0, 3}, {2.5, 0, 3}, {2.5, 0, 4}, {1.5, 0, 4}}},
           {{{2.5, 0, 3}, {2.5, 1, 3}, {2.5, 1, 4}, {2.5, 0, 4}}},
           {{{1.5, 1, 3}, {1.5, 0, 3}, {1.5, 0, 4}, {1.5, 1, 4}}}}};
}

TEST(ExchangeTruth, EventsThatStartBesideContacts) {
  for (const KnownPair& pair : {screens_on_walls(), hanging_sides()}) {
    for (const KnownPair& p : {pair, turned(pair)}) {
      const ExchangeTruth t = exchange_truth(p.receiver, p.source, p.occluders);
      const double A = area_of(p.receiver), F = static_cast<double>(t.integral) / A;
      for (const double tolerance : {1e-6, 1e-8, 1e-9, 1e-10}) {
        const PairFormFactor f = product_of(p, tolerance);
        EXPECT_LE(std::fabs(f.F - F), f.F_error + static_cast<double>(t.error) / A) << tolerance;
        EXPECT_LE(f.F_error, tolerance);
      }
    }
  }
}

/// Coordinates are as exact as at the origin; points between them are not, and errors tell.
TEST(ExchangeTruth, FarFromTheOrigin) {
  for (const KnownPair& pair : {screens_on_walls(), hanging_sides()}) {
    const ExchangeTruth t = exchange_truth(pair.receiver, pair.source, pair.occluders);
    const double A = area_of(pair.receiver), F = static_cast<double>(t.integral) / A;
    for (const double offset : {12345678.0, 1e9}) {
      KnownPair far = pair;
      const auto shift = [&](Loop& loop) {
        for (Vec3& p : loop) p = p + Vec3{offset, offset, offset};
      };
      shift(far.receiver);
      shift(far.source);
      for (ConvexBody& body : far.occluders) std::ranges::for_each(body, shift);
      for (const double tolerance : {1e-4, 1e-6}) {
        const PairFormFactor f = product_of(far, tolerance);
        EXPECT_LE(std::fabs(f.F - F), f.F_error + static_cast<double>(t.error) / A) << offset << ' ' << tolerance;
        EXPECT_LE(f.F_error, 1e-4) << offset << ' ' << tolerance;
      }
    }
  }
}

TEST(ExchangeTruth, AgreesWithClosedFormsAlongAnyAxis) {
  for (const SinglePair& p : single_pairs()) {
    if (!p.F) continue;
    for (const KnownPair& pair : {p.pair, turned(p.pair)}) {
      for (const int axis : {0, 1}) {
        const ExchangeTruth t = exchange_truth(pair.receiver, pair.source, pair.occluders, {.axis = axis});
        EXPECT_NEAR(static_cast<double>(t.integral - *p.F), 0, 2e-16) << p.name << ", axis " << axis;
      }
    }
  }
}

TEST(ExchangeTruth, AxesAgreeWithinTheirErrors) {
  for (const SinglePair& p : single_pairs()) {
    const ExchangeTruth t = exchange_truth(p.pair.receiver, p.pair.source, p.pair.occluders, {1e-13L, 0}),
                        u = exchange_truth(p.pair.source, p.pair.receiver, p.pair.occluders, {1e-13L, 1});
    EXPECT_LE(std::fabs(t.integral - u.integral), t.error + u.error + 1e-17L) << p.name;
    EXPECT_LE(t.error, 1e-12L) << p.name;
  }
}

TEST(ExchangeTruth, PartsAddUp) {
  for (const int number : {4, 7, 17}) {
    const KnownPair pair = random_pair(number);
    const Loop& s = pair.source;
    const Vec3 middle = s[0] + 0.5 * (s[1] - s[0]);
    Loop one{s[0], middle}, rest{middle, s[1]};
    one.push_back(s.back());
    rest.insert(rest.end(), s.begin() + 2, s.end());
    const auto value = [&](const Loop& source) { return exchange_truth(pair.receiver, source, pair.occluders); };
    const ExchangeTruth whole = value(s), a = value(one), b = value(rest);
    EXPECT_LE(std::fabs(whole.integral - a.integral - b.integral), whole.error + a.error + b.error + 1e-15L) << number;
  }
}

TEST(ExchangeTruth, SinglePairs) {
  for (const SinglePair& p : single_pairs()) {
    for (const KnownPair& pair : {p.pair, turned(p.pair)}) {
      const ExchangeTruth t = exchange_truth(pair.receiver, pair.source, pair.occluders);
      const double F = static_cast<double>(t.integral) / area_of(pair.receiver);
      const bool slit = p.name == "slit";  // tiny: what counts is the relative error
      const PairFormFactor f = slit ? product_of(pair, 1e-18, 1e-6) : product_of(pair, 1e-12);
      EXPECT_NEAR(f.F, F, 1e-9) << p.name;
      EXPECT_LE(std::fabs(f.F - F), f.F_error + static_cast<double>(t.error) + 1e-15 * F) << p.name;
      if (slit) {
        EXPECT_NEAR(f.F / F, 1, 1e-6);
      }
    }
  }
}

struct Entry {
  int i = 0, j = 0;
  double F = 0, error = 0;
};

std::filesystem::path file_of(const std::string& name) {
  return source_file("tests/form_factor/truth/" + name + ".csv");
}

/// Lines `i,j,kind,F,error`, after comments and a header.
std::vector<Entry> entries_of(const std::string& name) {
  std::ifstream in(file_of(name));
  std::vector<Entry> entries;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] < '0' || line[0] > '9') continue;
    std::istringstream row(line);
    Entry e;
    std::string kind;
    char comma = 0;
    row >> e.i >> comma >> e.j >> comma;
    std::getline(row, kind, ',');
    row >> e.F >> comma >> e.error;
    EXPECT_TRUE(row) << name << ": " << line;
    entries.push_back(e);
  }
  return entries;
}

std::vector<Entry> truth_of(const std::string& name) {
  const std::vector<Entry> entries = entries_of(name);
  EXPECT_GE(entries.size(), 180u) << name;
  return entries;
}

class Meshed {
 public:
  explicit Meshed(const std::string& name)
      : known_(known_scene(name)), soup_(make_soup(known_.scene)), mesh_(make_mesh()), scene_(soup_, mesh_) {}
  std::size_t size() const { return mesh_.patches.size(); }
  double area(int patch) const { return scene_.area(static_cast<std::size_t>(patch)); }
  PairIntegrator integrator() const { return PairIntegrator(scene_); }
  ExchangeTruth truth(int i, int j, int axis) const {
    return patch_truth(known_, soup_, mesh_, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j),
                       {1e-13L, axis});
  }

 private:
  PatchMesh make_mesh() const {
    MeshOptions options;
    options.patch_size = known_.patch_size;
    return make_patch_mesh(known_.scene, soup_, options);
  }
  KnownScene known_;
  PolygonSoup soup_;
  PatchMesh mesh_;
  ExchangeScene scene_;
};

class TruthOfScene : public testing::TestWithParam<const char*> {};

/// Every pair at one of the tolerances in turn; experiments/pair_time_vs_error asks each of them at ten.
TEST_P(TruthOfScene, FormFactorsAreWithinTheirErrors) {
  const std::string name = GetParam();
  const Meshed meshed(name);
  PairIntegrator integrator = meshed.integrator();
  const std::vector<Entry> entries = truth_of(name);
  constexpr std::array tolerances{1e-6, 1e-9, 1e-12};
  for (std::size_t turn = 0; turn < tolerances.size(); ++turn) {
    const double tolerance = tolerances[turn];
    std::vector<double> exaggeration;
    int beyond = 0;
    std::string worst;
    for (std::size_t k = turn; k < entries.size(); k += tolerances.size()) {
      const Entry& e = entries[k];
      PairOptions options;
      options.tolerance = tolerance;
      const PairFormFactor f =
          integrator.form_factor(static_cast<std::size_t>(e.i), static_cast<std::size_t>(e.j), options);
      const double apart = std::fabs(f.F - e.F);
      EXPECT_LE(apart, std::max(1e-9, tolerance) + e.error) << name << ' ' << e.i << ' ' << e.j;
      if (apart > f.F_error + e.error) {
        ++beyond;
        worst +=
            fmt::format("{} {}: {:.17g} ± {:.2g}, truth {:.17g} ± {:.2g}\n", e.i, e.j, f.F, f.F_error, e.F, e.error);
      }
      if (apart > std::max(10 * e.error, 1e-15)) exaggeration.push_back(f.F_error / apart);
    }
    EXPECT_EQ(beyond, 0) << "tolerance " << tolerance << "\n" << worst;
    if (exaggeration.size() >= 20) {
      std::ranges::nth_element(exaggeration,
                               exaggeration.begin() + static_cast<std::ptrdiff_t>(exaggeration.size() / 2));
      RecordProperty(fmt::format("median_exaggeration_{:g}", tolerance),
                     fmt::format("{}", exaggeration[exaggeration.size() / 2]));
    }
  }
}

TEST_P(TruthOfScene, CanBeFoundAgain) {
  const std::string name = GetParam();
  const Meshed meshed(name);
  const std::vector<Entry> entries = truth_of(name);
  for (std::size_t k = 0; k < entries.size(); k += entries.size() / 3) {
    const Entry& e = entries[k];
    const auto agrees = [&](int axis) {
      const ExchangeTruth t = meshed.truth(e.i, e.j, axis);
      const auto F = static_cast<double>(t.integral) / meshed.area(e.i);
      return std::fabs(F - e.F) <= e.error + static_cast<double>(t.error) / meshed.area(e.i) + 1e-15 * F;
    };
    // One axis may miss an event.
    EXPECT_TRUE(agrees(1) || agrees(2)) << name << ' ' << e.i << ' ' << e.j;
  }
}

constexpr const char* kScenes[] = {"box_room", "box_on_uncut_floor", "turned_cubes", "thin_plates", "sliver_fan"};
INSTANTIATE_TEST_SUITE_P(Scenes, TruthOfScene, testing::ValuesIn(kScenes),
                         [](const auto& p) { return std::string(p.param); });

TEST(RandomPairs, FormFactorsAreWithinTheirErrors) {
  const std::vector<Entry> entries = truth_of("random_pairs");
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    int beyond = 0;
    std::string list;
    for (const Entry& e : entries) {
      const PairFormFactor f = product_of(random_pair(e.i), tolerance);
      if (std::fabs(f.F - e.F) <= f.F_error + e.error) continue;
      ++beyond;
      list += fmt::format("{}: {:.17g} ± {:.2g}, truth {:.17g} ± {:.2g}\n", e.i, f.F, f.F_error, e.F, e.error);
    }
    EXPECT_LE(beyond, static_cast<int>(entries.size()) / 1000) << "tolerance " << tolerance << "\n" << list;
  }
}

/// The value along axis 0. Events that were missed would be others along axis 1: what the two differ is part of the
/// error. Where that is more than the two know of, the one that axis 2 agrees with is the value.
template <class Truth>
std::string row_of(int i, int j, const PairFormFactor& f, double area, const Truth& truth) {
  constexpr std::array names{"facing_away", "open", "blocked", "partial"};
  ExchangeTruth t = truth(0), other = truth(1);
  const auto apart = [&] { return std::fabs(t.integral - other.integral); };
  if (apart() > t.error + other.error) {
    const ExchangeTruth third = truth(2);
    if (std::fabs(other.integral - third.integral) < std::fabs(t.integral - third.integral)) t = other;
    other = third;
  }
  const long double error = 1.05L * std::max(t.error, apart());  // is written with two digits
  return fmt::format("{},{},{},{:.20g},{:.2g}\n", i, j, names[static_cast<std::size_t>(f.kind)], t.integral / area,
                     error / area);
}

std::string head(const std::string& what) {
  return "# " + what +
         "\n# Made by the disabled tests Write of exchange_truth_test.cpp from exchange_truth.h, tolerance 1e-13.\n"
         "# kind is the library's word, by which pairs were chosen.\n"
         "i,j,kind,F,error\n";
}

/// Values that are there already are kept, and every new one is written as soon as it is known: some take a minute.
TEST_P(TruthOfScene, DISABLED_Write) {
  const std::string name = GetParam();
  const Meshed meshed(name);
  PairIntegrator integrator = meshed.integrator();
  const auto coarsely = [&](int i, int j) {
    PairOptions options;
    options.tolerance = 1e-3;
    return integrator.form_factor(static_cast<std::size_t>(i), static_cast<std::size_t>(j), options);
  };
  std::array left{0, 40, 20, 140};  // of each class
  std::set<std::pair<int, int>> asked;
  if (!std::filesystem::exists(file_of(name)))
    std::ofstream(file_of(name)) << head(
        "F_ij of pairs of patches of the scene " + name +
        ", exchange_scenes.h: 40 open, 20 blocked, 140 partial ones, or as many as there are.");
  for (const Entry& e : entries_of(name)) {
    asked.emplace(std::min(e.i, e.j), std::max(e.i, e.j));
    --left[static_cast<std::size_t>(coarsely(e.i, e.j).kind)];
  }
  std::ofstream file(file_of(name), std::ios::app);
  Random random(name);
  const int last = static_cast<int>(meshed.size()) - 1;
  for (int tries = 0; tries < 100'000 && left[1] + left[2] + left[3] > 0; ++tries) {
    const int i = random.whole(0, last), j = random.whole(0, last);
    if (i == j || !asked.emplace(std::min(i, j), std::max(i, j)).second) continue;
    const PairFormFactor f = coarsely(i, j);
    int& wanted = left[static_cast<std::size_t>(f.kind)];
    if (wanted <= 0) continue;
    --wanted;
    file << row_of(i, j, f, meshed.area(i), [&](int axis) { return meshed.truth(i, j, axis); }) << std::flush;
  }
}

TEST(RandomPairs, DISABLED_Write) {
  std::string text = head("F from receiver to source of random_pair(i), exchange_scenes.h; j = 0.");
  for (int k = 0, count = 0; count < 200; ++k) {
    const KnownPair pair = random_pair(k);
    const PairFormFactor f = product_of(pair, 1e-3);
    if (f.kind != PairClass::partial && k % 10 != 0) continue;
    text += row_of(k, 0, f, area_of(pair.receiver), [&](int axis) {
      return exchange_truth(pair.receiver, pair.source, pair.occluders, {1e-13L, axis});
    });
    ++count;
  }
  std::ofstream(file_of("random_pairs")) << text;
}

}  // namespace
}  // namespace exitance
