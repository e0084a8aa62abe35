// What gathering at points misses is what a solution is off by, where that is known.

#include "src/reference/sampled_residual.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <functional>
#include <numeric>

#include "src/form_factor/pair_rows.h"
#include "src/reference/refined_mesh.h"
#include "tests/reference/pointwise_error.h"
#include "tests/reference/small_shadow.h"

namespace exitance {
namespace {

constexpr std::uint32_t kDegree = 3;

/// Light that is reflected once: of a floor below an emitter, with all else black, all there is.
class OneReflection {
 public:
  explicit OneReflection(const Scene& scene)
      : soup_(make_soup(scene)), refined_(scene, soup_, {.elements_per_edge = 4}) {
    system_.bands = 1;
    for (const Element& element : mesh().elements) {
      const Material& material = scene.materials[scene.surfaces[mesh().patches[element.patch].surface].material];
      system_.area.push_back(element.area);
      system_.rho.push_back(material.rho[0]);
      system_.E.push_back(material.E[0]);
    }
    const ExchangeScene exchange(soup_, mesh(), ExchangeScene::Unit::element);
    std::vector<std::uint32_t> rows(exchange.size());
    std::iota(rows.begin(), rows.end(), 0u);
    PairStatistics statistics;
    const PairRows pairs = pair_rows(exchange, rows, {.tolerance = 1e-9}, statistics);
    system_.F = matrix_of(std::span(&pairs, 1), static_cast<std::uint32_t>(exchange.size()));
    B_ = irradiance(system_.F, system_.E, 1);
    for (std::size_t i = 0; i < B_.size(); ++i) B_[i] = system_.E[i] + system_.rho[i] * B_[i];
  }

  const PatchMesh& mesh() const { return refined_.mesh(); }

  /// What the solution is off by, squared, where the floor's true B is known.
  double missed(const std::function<double(const Vec3&)>& B_on_floor) const {
    const auto truth = [&](std::uint32_t surface, const Vec3& p) {
      return surface == 0 ? B_on_floor(p) : surface == 1 ? 1 : 0;
    };
    return squares_of(mesh(), kDegree, B_, truth, 6).first;
  }

  std::optional<std::vector<double>> squares(const std::function<bool()>& stop = {}) const {
    std::vector<std::uint32_t> patches(mesh().patches.size());
    std::iota(patches.begin(), patches.end(), 0u);
    return SampledResidual(soup_).squares({mesh(), system_, kDegree, B_, B_}, patches, stop);
  }

 private:
  PolygonSoup soup_;
  RefinedMesh refined_;
  RadiositySystem system_;
  std::vector<double> B_;
};

TEST(SampledResidual, IsWhatASolutionIsOffByWhereItsPointsSeeIt) {
  for (const double edge : {0.5, 0.65}) {
    const OneReflection solution(half_shadow(edge));
    const double missed = solution.missed([&](const Vec3& p) { return half_shadow_B(edge, p.x, p.y); });
    const auto squares = solution.squares();
    ASSERT_TRUE(squares);
    EXPECT_NEAR((*squares)[0], missed, 0.05 * missed) << edge;
    EXPECT_NEAR((*squares)[1], 0, 1e-20);
    EXPECT_NEAR((*squares)[2], 0, 1e-20);
  }
}

/// The sheet is smaller than the distance between points: of some, none sees its shadow.
TEST(SampledResidual, IsHardlyLessInSpotsThatItsPointsDoNotSee) {
  for (int k = 0; k < 8; ++k) {
    const SmallSheet sheet{0.6 + 0.004 * k, 0.3, 0.02, 0.003};
    const OneReflection solution(small_shadow(sheet));
    const double missed = solution.missed([&](const Vec3& p) { return small_shadow_B(sheet, p.x, p.y); });
    const auto squares = solution.squares();
    ASSERT_TRUE(squares);
    EXPECT_GE((*squares)[0], missed / (1.5 * 1.5)) << sheet.x;
    EXPECT_LE((*squares)[0], 30 * missed) << sheet.x;
  }
}

TEST(SampledResidual, AnyNumberOfThreadsGivesTheSameBits) {
  const OneReflection solution(half_shadow(0.65));
  const auto squares_by = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return solution.squares();
  };
  EXPECT_EQ(squares_by(1), squares_by(3));
}

TEST(SampledResidual, EndsWhenItIsTold) {
  EXPECT_FALSE(OneReflection(half_shadow(0.5)).squares([] { return true; }));
}

}  // namespace
}  // namespace exitance
