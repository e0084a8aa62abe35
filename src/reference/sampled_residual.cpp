#include "src/reference/sampled_residual.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/form_factor/area_cell.h"
#include "src/form_factor/point_rows.h"
#include "src/reference/patch_polynomials.h"
#include "src/reference/solution_record.h"
#include "src/visibility/exact_visibility.h"

namespace exitance {
namespace {

/// Of the Gauss rule at whose points of an element straight light is gathered.
constexpr int kOrder = 8;
/// Share of an element that spots are taken to be of which the points see nothing but that their mean is wrong. Chosen
/// on the scenes of experiments/reference_convergence: box on floor, closed Cornell box, furnished room.
constexpr double kSpot = 1.0 / 256;
/// Points that are held at a time; between blocks it is asked whether to stop.
constexpr std::size_t kBlock = 256;

/// Point k of a sequence that fills the square evenly (Roberts 2018, R2: steps by powers of the plastic number's
/// inverse), on a cell, with the area that it stands for where a cell has one point.
WeightedPoint scattered_point(const AreaCell& cell, std::uint32_t k) {
  const double s = std::fmod(0.5 + k * 0.7548776662466927, 1.0), t = std::fmod(0.5 + k * 0.5698402909980532, 1.0);
  const SidePoint low = first_side(cell, s), high = opposite_side(cell, s);
  const Vec3 across = high.at - low.at, along = low.along + t * (high.along - low.along);
  return {low.at + t * across, norm(cross(along, across))};
}

/// A block of receivers, and what they stand for. Patches of the mesh are what they look at.
struct Samples {
  PatchMesh mesh;  ///< its elements are points; `patch` of each is the element that it lies on
  std::vector<double> weight;

  void clear() {
    mesh.elements = {};
    weight.clear();
  }
  void add(const Element& element, std::uint32_t number, const WeightedPoint& x) {
    mesh.elements.push_back({.patch = number, .facet = element.facet, .sample = x.point, .normal = element.normal});
    weight.push_back(x.weight);
  }
};

class Residual {
 public:
  Residual(const MeshSolution& solution, const PolygonSoup& soup, const Contacts& contacts,
           const std::function<bool()>& stop)
      : solution_(solution),
        soup_(soup),
        contacts_(contacts),
        stop_(stop),
        polynomials_(solution.mesh, solution.degree),
        straight_H_(irradiance(solution.system.F, solution.system.E, solution.system.bands)) {}

  std::optional<std::vector<double>> squares(std::span<const std::uint32_t> patches) const {
    auto straight = straight_squares(patches);
    if (!straight) return {};
    const auto other = other_squares(patches);
    if (!other) return {};
    for (std::size_t k = 0; k < patches.size(); ++k) {
      const double norm = std::sqrt((*straight)[k]) + std::sqrt((*other)[k]);
      (*straight)[k] = norm * norm;
    }
    return straight;
  }

 private:
  using Squares = std::optional<std::vector<double>>;
  using PointsOf = std::function<std::vector<WeightedPoint>(std::uint32_t element)>;

  /// Of light that comes straight from emitters: these are whole facets, as their exitance is constant.
  Squares straight_squares(std::span<const std::uint32_t> patches) const {
    const PatchMesh& mesh = solution_.mesh;
    const RadiositySystem& system = solution_.system;
    Samples samples;
    std::vector<double> E;
    std::vector<std::uint8_t> known(soup_.facets().size());
    for (std::uint32_t e = 0; e < mesh.elements.size(); ++e) {
      const std::uint32_t facet = mesh.elements[e].facet;
      const std::span<const double> of_element(&system.E[e * std::size_t{system.bands}], system.bands);
      if (std::exchange(known[facet], 1) || std::ranges::all_of(of_element, [](double v) { return v == 0; })) continue;
      samples.mesh.patches.push_back(
          {.piece_first = static_cast<std::uint32_t>(samples.mesh.pieces.size()), .piece_count = 1});
      samples.mesh.pieces.push_back({.facet = facet});
      E.insert(E.end(), of_element.begin(), of_element.end());
    }
    const auto points_of = [&](std::uint32_t e) {
      std::vector<WeightedPoint> points;
      gauss_points(cell_of(e), kOrder, points);
      return points;
    };
    std::vector<double> means(straight_H_.size());
    for (std::size_t i = 0; i < means.size(); ++i) means[i] = system.rho[i] * straight_H_[i];
    return squares(samples, points_of, E, means, kSpot, patches);
  }

  Squares other_squares(std::span<const std::uint32_t> patches) const {
    const PatchMesh& mesh = solution_.mesh;
    const RadiositySystem& system = solution_.system;
    Samples samples;
    samples.mesh.points = mesh.points;
    samples.mesh.pieces = mesh.pieces;
    for (const Element& e : mesh.elements)
      samples.mesh.patches.push_back({.piece_first = e.piece_first, .piece_count = e.piece_count});
    const auto points_of = [&](std::uint32_t e) { return std::vector{scattered_point(cell_of(e), e)}; };
    std::vector<double> means(straight_H_.size()), shot(straight_H_.size());
    for (std::size_t i = 0; i < means.size(); ++i) {
      means[i] = solution_.B[i] - system.E[i] - system.rho[i] * straight_H_[i];
      shot[i] = solution_.shot[i] - system.E[i];
    }
    return squares(samples, points_of, shot, means, 0, patches);
  }

  /// ∫ (ρ H − what polynomials make of the means)² dA over patches, and what there is in spots of which only the means
  /// of the samples tell. samples: what is looked at, points_of: from where; shot: by patch of the samples and band;
  /// means: by element and band.
  Squares squares(Samples& samples, const PointsOf& points_of, std::span<const double> shot,
                  std::span<const double> means, double spot, std::span<const std::uint32_t> patches) const {
    const PatchMesh& mesh = solution_.mesh;
    const std::uint32_t bands = solution_.system.bands;
    const std::size_t n = mesh.elements.size();
    const std::vector<double> Y = luminance(means, bands, n), coefficients = polynomials_.fit(Y, 1);
    std::vector<double> square(mesh.patches.size()), missed(n), terms(polynomials_.terms()), gathered;
    const ExactVisibility visibility(samples.mesh, soup_, contacts_);
    const std::vector<std::uint32_t> elements = elements_of(patches);
    for (std::size_t next = 0; next < elements.size();) {
      if (stop_ && stop_()) return {};
      samples.clear();
      for (; next < elements.size() && samples.weight.size() < kBlock; ++next) {
        const std::uint32_t e = elements[next];
        for (const WeightedPoint& x : points_of(e)) samples.add(mesh.elements[e], e, x);
      }
      const std::size_t count = samples.weight.size();
      gathered = irradiance(point_rows(visibility, 0, count).F, shot, bands);
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t e = samples.mesh.elements[k].patch;
        for (std::size_t b = 0; b < bands; ++b) gathered[k * bands + b] *= solution_.system.rho[e * bands + b];
      }
      const std::vector<double> Y_gathered = luminance(gathered, bands, count);
      for (std::size_t k = 0; k < count; ++k) {
        const Element& x = samples.mesh.elements[k];
        const std::uint32_t e = x.patch, p = mesh.elements[e].patch;
        polynomials_.terms_at(p, x.sample, terms);
        double value = Y[e] - polynomials_.mean(e, coefficients, 1, 0);
        for (std::size_t t = 0; t < terms.size(); ++t) value += terms[t] * coefficients[p * terms.size() + t];
        const double apart = Y_gathered[k] - value;
        square[p] += samples.weight[k] * apart * apart;
        missed[e] += samples.weight[k] * (Y_gathered[k] - Y[e]);
      }
    }
    std::vector<double> result;
    for (const std::uint32_t p : patches) {
      double sum = square[p];
      const Patch& patch = mesh.patches[p];
      for (std::uint32_t e = patch.element_first; spot > 0 && e < patch.element_first + patch.element_count; ++e)
        sum += missed[e] * missed[e] / (spot * mesh.elements[e].area);
      result.push_back(sum);
    }
    return result;
  }

  std::vector<std::uint32_t> elements_of(std::span<const std::uint32_t> patches) const {
    std::vector<std::uint32_t> elements;
    for (const std::uint32_t p : patches) {
      const Patch& patch = solution_.mesh.patches[p];
      for (std::uint32_t e = patch.element_first; e < patch.element_first + patch.element_count; ++e)
        elements.push_back(e);
    }
    return elements;
  }

  AreaCell cell_of(std::uint32_t element) const {
    const PatchMesh& mesh = solution_.mesh;
    return cells_of(mesh.loop(mesh.elements[element])).front();
  }

  const MeshSolution& solution_;
  const PolygonSoup& soup_;
  const Contacts& contacts_;
  const std::function<bool()>& stop_;
  PatchPolynomials polynomials_;
  std::vector<double> straight_H_;  // by element and band: what comes straight from emitters
};

}  // namespace

std::optional<std::vector<double>> SampledResidual::squares(const MeshSolution& solution,
                                                            std::span<const std::uint32_t> patches,
                                                            const std::function<bool()>& stop) const {
  return Residual(solution, soup_, contacts_, stop).squares(patches);
}

}  // namespace exitance
