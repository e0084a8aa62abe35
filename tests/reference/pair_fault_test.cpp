// Why form factors are wrong.

#include "src/reference/pair_fault.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/contour_form_factor.h"
#include "src/form_factor/pair_run.h"

namespace exitance {
namespace {

Surface square(double x0, double x1, double y0, double y1, double z, bool up) {
  Surface surface;
  surface.polygon.outer = {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
  if (!up) std::swap(surface.polygon.outer[1], surface.polygon.outer[3]);
  return surface;
}

/// A floor, 0, and a ceiling, 1, each unit squares a metre apart; 0.3 m above the floor a sheet, 2 and 3, hides a
/// part. On a second floor, 4, lies a rug, 5.
Scene squares_scene() {
  Scene scene;
  scene.bands = 1;
  scene.materials = {{"grey", {0.5}, {1}}};
  scene.objects = {{"object", ""}};
  scene.surfaces = {square(0, 1, 0, 1, 0, true),           square(0, 1, 0, 1, 1, false),
                    square(0.1, 0.6, 0.2, 0.7, 0.3, true), square(0.1, 0.6, 0.2, 0.7, 0.3, false),
                    square(3, 4, 0, 1, 0, true),           square(3.2, 3.8, 0.2, 0.8, 0, true)};
  return scene;
}

struct Squares {
  double unoccluded(std::uint32_t i, std::uint32_t j) const {
    return unobstructed_exchange(exchange.pieces(i)[0].radiator, exchange.pieces(j)[0].radiator).integral /
           exchange.area(i);
  }

  Scene scene = squares_scene();
  PolygonSoup soup = make_soup(scene);
  PatchMesh mesh = make_patch_mesh(scene, soup, {});
  ExchangeScene exchange{soup, mesh};
};

class PairFault : public testing::Test {
 protected:
  PairFault() {
    const PairRun run = run_pairs(squares.exchange, {.pairs = {.tolerance = 1e-8}}, nullptr);
    truth = truth_of(run.rows, static_cast<std::uint32_t>(squares.exchange.size()));
    EXPECT_EQ(kind(0, 1), PairClass::partial);
    EXPECT_EQ(kind(0, 3), PairClass::open);
    EXPECT_EQ(kind(0, 2), PairClass::facing_away);
  }
  PairClass kind(std::uint32_t i, std::uint32_t j) const { return truth.kind[i * truth.patches() + j]; }
  double F(std::uint32_t i, std::uint32_t j) const {
    for (std::size_t k = 0; k < truth.F.row(i).size(); ++k) {
      if (truth.F.row_columns(i)[k] == j) return truth.F.row(i)[k];
    }
    return 0;
  }
  /// What is wrong when a contender says `value`.
  Fault fault(const decltype(Contender::how)& how, std::uint32_t i, std::uint32_t j, double value) const {
    const Contender contender{"contender", how};
    return FaultFinder(contender, squares.mesh, squares.exchange).find({i, j, value, F(i, j), 0}, kind(i, j));
  }
  /// What is wrong of what it really says.
  Fault fault(const RayOptions& options, std::uint32_t i, std::uint32_t j) const {
    const Contender contender{"rays", options};
    const FormFactorMatrix made = run(contender, squares.mesh, squares.exchange, {}, {}).F;
    double value = 0;
    for (std::size_t k = 0; k < made.row(i).size(); ++k) {
      if (made.row_columns(i)[k] == j) value = made.row(i)[k];
    }
    EXPECT_NE(value, F(i, j));
    return fault(options, i, j, value);
  }

  const Squares squares;
  MatrixTruth truth;
};

TEST_F(PairFault, OfRaysThatAreCast) {
  EXPECT_EQ(fault(RayOptions{.rays = 16}, 0, 1), Fault::sampling);
  EXPECT_EQ(fault(RayOptions{.rays = 4096}, 0, 1), Fault::sampling);
  EXPECT_EQ(fault(RayOptions{.rays = 4096, .estimator = Estimator::hemisphere}, 0, 1), Fault::sampling);
  EXPECT_EQ(fault(RayOptions{.rays = 4096, .estimator = Estimator::fraction}, 0, 1), Fault::unweighted);
  EXPECT_EQ(fault(RayOptions{.estimator = Estimator::centre}, 0, 1), Fault::missed_gap);
  EXPECT_EQ(fault(RayOptions{.rays = 64, .offset = 0}, 0, 3), Fault::self_intersection);
  // So far off their surfaces that they start beyond the sheet; half of it is not.
  EXPECT_EQ(fault(RayOptions{.rays = 4096, .offset = 0.16}, 0, 1), Fault::offset);
}

TEST_F(PairFault, OfRaysByWhatTheySay) {
  const RayOptions rays{.rays = 256};
  EXPECT_EQ(fault(rays, 0, 2, 0.1), Fault::seen_from_behind);
  EXPECT_EQ(fault(rays, 0, 1, 0), Fault::missed_gap);
  EXPECT_EQ(fault(rays, 0, 1, squares.unoccluded(0, 1)), Fault::missed_occluder);
  const Contender contender{"rays", rays};
  const FaultFinder finder(contender, squares.mesh, squares.exchange);
  EXPECT_EQ(finder.find({2, 0, 0.1, 0, 0}, PairClass::blocked), Fault::leak);
  const RayOptions hemisphere{.rays = 4096, .estimator = Estimator::hemisphere};
  EXPECT_EQ(fault(hemisphere, 0, 1, F(0, 1) + 0.1), Fault::unknown);
  EXPECT_EQ(fault(hemisphere, 0, 1, 0), Fault::missed_gap);
}

TEST_F(PairFault, OfOtherContenders) {
  const std::filesystem::path file = "matrix.csv";
  EXPECT_EQ(fault(file, 0, 1, 0), Fault::missed_gap);
  EXPECT_EQ(fault(file, 0, 1, squares.unoccluded(0, 1)), Fault::missed_occluder);
  EXPECT_EQ(fault(file, 0, 1, F(0, 1) / 2), Fault::unknown);
  EXPECT_EQ(fault(file, 4, 1, 1), Fault::contact) << "the rug lies on it";
  EXPECT_EQ(fault(PairOptions{}, 0, 1, 0), Fault::integration);
}

TEST_F(PairFault, IsNoneWithinTheErrorOfTheTruth) {
  const Contender contender{"file", std::filesystem::path("matrix.csv")};
  const FaultFinder finder(contender, squares.mesh, squares.exchange);
  EXPECT_EQ(finder.find({0, 1, 0.1 + 1e-9, 0.1, 2e-9}, PairClass::partial), Fault::none_known);
  EXPECT_EQ(finder.find({0, 1, 0.1 + 3e-9, 0.1, 2e-9}, PairClass::partial), Fault::unknown);
}

TEST_F(PairFault, IsTheSameEveryTime) {
  const RayOptions rays{.rays = 64};
  for (int again = 0; again < 3; ++again) EXPECT_EQ(fault(rays, 0, 1), fault(rays, 0, 1));
}

}  // namespace
}  // namespace exitance
