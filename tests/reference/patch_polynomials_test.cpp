// Polynomials on patches: found again from means, and shot exactly into polynomial kernels.

#include "src/reference/patch_polynomials.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "src/form_factor/area_cell.h"
#include "src/reference/refined_mesh.h"

namespace exitance {
namespace {

double cubic(const Vec3& p) {
  const double u = p.x + 0.5 * p.y, v = p.y - p.z;
  return 2 - u + 3 * v + u * u - 4 * u * v + 0.5 * v * v + u * u * u - 2 * u * v * v + v * v * v;
}

double kernel(const Vec3& p) {
  return 1 + 2 * p.x - p.y * p.z + p.z * p.z * p.y;
}

/// Integral of f over an element, by a rule that is exact for degree 12.
template <class F>
double integral(const PatchMesh& mesh, const Element& element, const F& f) {
  std::vector<WeightedPoint> points;
  double sum = 0;
  for (const AreaCell& cell : cells_of(mesh.loop(element))) {
    gauss_points(cell, 8, points);
    for (const WeightedPoint& x : points) sum += x.weight * f(x.point);
  }
  return sum;
}

/// A tilted triangle and a tilted quadrilateral that is no parallelogram.
Scene tilted() {
  Scene scene;
  scene.bands = 1;
  scene.materials.push_back({"grey", {0.5}, {1}});
  scene.objects.push_back({"sheets", ""});
  scene.surfaces.push_back({.polygon = {{{0, 0, 0}, {1, 0, 0.5}, {0, 1, 0.25}}, {}}});
  scene.surfaces.push_back({.polygon = {{{2, 0, 0}, {3, 0, 1}, {3, 2, 1}, {2, 1, 0}}, {}}});
  return scene;
}

class PatchPolynomialsTest : public testing::Test {
 protected:
  std::vector<double> means_of(double (*f)(const Vec3&)) const {
    std::vector<double> means;
    for (const Element& e : mesh_.elements) means.push_back(integral(mesh_, e, f) / e.area);
    return means;
  }

  const Scene scene_ = tilted();
  const PolygonSoup soup_ = make_soup(scene_);
  const RefinedMesh refined_{scene_, soup_, {.elements_per_edge = 4}};
  const PatchMesh& mesh_ = refined_.mesh();
};

TEST_F(PatchPolynomialsTest, FindsACubicFromItsMeans) {
  const PatchPolynomials polynomials(mesh_, 3);
  const std::vector<double> means = means_of(cubic), coefficients = polynomials.fit(means, 1);
  std::vector<double> terms(polynomials.terms());
  for (std::uint32_t e = 0; e < mesh_.elements.size(); ++e) {
    const std::uint32_t patch = mesh_.elements[e].patch;
    polynomials.terms_at(patch, mesh_.elements[e].sample, terms);
    double value = 0;
    for (std::size_t t = 0; t < terms.size(); ++t) value += terms[t] * coefficients[patch * terms.size() + t];
    EXPECT_NEAR(value, cubic(mesh_.elements[e].sample), 1e-11);
    EXPECT_NEAR(polynomials.mean(e, coefficients, 1, 0), means[e], 1e-12);
  }
}

TEST_F(PatchPolynomialsTest, ShootingValuesIntegrateACubicAgainstACubicKernel) {
  const PatchPolynomials polynomials(mesh_, 3);
  const std::vector<double> means = means_of(cubic), shot = polynomials.shooting_values(means, 1);
  for (const Patch& patch : mesh_.patches) {
    double exact = 0, by_values = 0, by_means = 0;
    for (std::uint32_t e = patch.element_first; e < patch.element_first + patch.element_count; ++e) {
      const Element& element = mesh_.elements[e];
      const double of_kernel = integral(mesh_, element, kernel);  // a form factor's part
      exact += integral(mesh_, element, [](const Vec3& p) { return kernel(p) * cubic(p); });
      by_values += of_kernel * shot[e];
      by_means += of_kernel * means[e];
    }
    EXPECT_NEAR(by_values, exact, 1e-12 * std::fabs(exact));
    EXPECT_GT(std::fabs(by_means - exact), 1e-4 * std::fabs(exact));  // it does matter
  }
}

TEST_F(PatchPolynomialsTest, WhatIsConstantOnPatchesIsShotAsItIs) {
  const PatchPolynomials polynomials(mesh_, 3);
  std::vector<double> means;
  for (const Element& e : mesh_.elements) means.insert(means.end(), {1.0 + e.patch, 5.0});
  const std::vector<double> shot = polynomials.shooting_values(means, 2);
  for (std::size_t k = 0; k < means.size(); ++k) EXPECT_NEAR(shot[k], means[k], 1e-13);
}

TEST_F(PatchPolynomialsTest, DegreeZeroLeavesMeansAlone) {
  const std::vector<double> means = means_of(cubic);
  EXPECT_EQ(PatchPolynomials(mesh_, 0).shooting_values(means, 1), means);
}

TEST_F(PatchPolynomialsTest, RefusesADegreeThatElementsDoNotDetermine) {
  const RefinedMesh coarse(scene_, soup_, {.elements_per_edge = 2});
  EXPECT_THROW(PatchPolynomials(coarse.mesh(), 2), std::invalid_argument);
  EXPECT_THROW(PatchPolynomials(mesh_, 4), std::invalid_argument);
  EXPECT_EQ(PatchPolynomials::degree_of_grid(1), 0u);
  EXPECT_EQ(PatchPolynomials::degree_of_grid(9), 3u);
}

}  // namespace
}  // namespace exitance
