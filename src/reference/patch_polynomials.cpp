#include "src/reference/patch_polynomials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

// GCC 12 takes the AVX-512 intrinsics' undefined registers for uninitialised variables (its bug 105593).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <Eigen/QR>

#include "src/form_factor/area_cell.h"

namespace exitance {
namespace {

/// Exact for the product of two polynomials of the highest degree on triangles and parallelograms, and on any
/// quadrilateral.
constexpr int kOrder = 4;

Vec3 frame_axis(const Vec3& direction, const Vec3& centre, std::span<const Vec3> loop) {
  double reach = 0;
  for (const Vec3& v : loop) reach = std::max(reach, std::fabs(dot(direction, v - centre)));
  return reach > 0 ? (1 / reach) * direction : Vec3{};
}

}  // namespace

std::uint32_t PatchPolynomials::degree_of_grid(std::uint32_t n) {
  return std::min(n - 1, kHighestDegree);
}

PatchPolynomials::PatchPolynomials(const PatchMesh& mesh, std::uint32_t degree) : mesh_(&mesh), degree_(degree) {
  if (degree > kHighestDegree) throw std::invalid_argument("PatchPolynomials: the degree is too high");
  const auto count = static_cast<Eigen::Index>(terms());
  std::vector<double> at_point(terms());
  std::vector<WeightedPoint> points;
  for (std::uint32_t p = 0; p < mesh.patches.size(); ++p) {
    const Patch& patch = mesh.patches[p];
    const auto n = static_cast<Eigen::Index>(patch.element_count);
    if (n < count) throw std::invalid_argument("PatchPolynomials: a patch has too few elements for the degree");
    Frame frame;
    if (degree > 0) {
      const auto loop = mesh.loop(mesh.pieces_of(patch).front());
      for (const Vec3& v : loop) frame.centre = frame.centre + (1 / static_cast<double>(loop.size())) * v;
      const Vec3 along = normalized(loop[1] - loop[0]);
      frame.along = frame_axis(along, frame.centre, loop);
      frame.across = frame_axis(cross(mesh.elements[patch.element_first].normal, along), frame.centre, loop);
    }
    frames_.push_back(frame);

    Eigen::MatrixXd means = Eigen::MatrixXd::Zero(n, count), within = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd area(n);
    for (Eigen::Index e = 0; e < n; ++e) {
      const Element& element = mesh.elements[patch.element_first + static_cast<std::uint32_t>(e)];
      area[e] = element.area;
      if (degree == 0) {
        means(e, 0) = 1;
        continue;
      }
      const AreaCell cell = cells_of(mesh.loop(mesh.pieces_of(element).front())).front();
      gauss_points(cell, kOrder, points);
      double weights = 0;
      Eigen::MatrixXd square = Eigen::MatrixXd::Zero(count, count);
      for (const WeightedPoint& x : points) {
        terms_at(p, x.point, at_point);
        const Eigen::Map<const Eigen::RowVectorXd> row(at_point.data(), count);
        means.row(e) += x.weight * row;
        square += x.weight * row.transpose() * row;
        weights += x.weight;
      }
      means.row(e) /= weights;
      within += square - weights * means.row(e).transpose() * means.row(e);
    }
    const Eigen::VectorXd weight = area.cwiseSqrt();
    const Eigen::MatrixXd weighted = weight.asDiagonal() * means;
    const Eigen::MatrixXd fit = weighted.colPivHouseholderQr().solve(Eigen::MatrixXd(weight.asDiagonal()));
    const Eigen::MatrixXd correction = area.cwiseInverse().asDiagonal() * fit.transpose() * within;
    first_.push_back(mean_.size());
    for (Eigen::Index e = 0; e < n; ++e) {
      for (Eigen::Index t = 0; t < count; ++t) {
        mean_.push_back(means(e, t));
        correction_.push_back(correction(e, t));
      }
    }
    for (Eigen::Index t = 0; t < count; ++t) {
      for (Eigen::Index e = 0; e < n; ++e) fit_.push_back(fit(t, e));
    }
  }
}

void PatchPolynomials::terms_at(std::uint32_t patch, const Vec3& point, std::span<double> terms) const {
  const Frame& f = frames_[patch];
  const Vec3 w = point - f.centre;
  const double x = dot(f.along, w), y = dot(f.across, w);
  // 1, x, y, x², xy, y², …
  std::size_t t = 0;
  double of_x = 1;
  std::array<double, kHighestDegree + 1> power_y{1};
  for (std::uint32_t k = 1; k <= degree_; ++k) power_y[k] = power_y[k - 1] * y;
  std::array<double, kHighestDegree + 1> power_x{1};
  for (std::uint32_t k = 1; k <= degree_; ++k) power_x[k] = of_x *= x;
  for (std::uint32_t total = 0; total <= degree_; ++total) {
    for (std::uint32_t k = 0; k <= total; ++k) terms[t++] = power_x[total - k] * power_y[k];
  }
}

std::vector<double> PatchPolynomials::fit(std::span<const double> means, std::uint32_t bands) const {
  std::vector<double> coefficients(mesh_->patches.size() * terms() * bands);
  for (std::size_t p = 0; p < mesh_->patches.size(); ++p) {
    const Patch& patch = mesh_->patches[p];
    for (std::size_t t = 0; t < terms(); ++t) {
      const double* row = fit_.data() + first_[p] + t * patch.element_count;
      double* out = coefficients.data() + (p * terms() + t) * bands;
      for (std::size_t e = 0; e < patch.element_count; ++e) {
        for (std::size_t b = 0; b < bands; ++b) out[b] += row[e] * means[(patch.element_first + e) * bands + b];
      }
    }
  }
  return coefficients;
}

double PatchPolynomials::mean(std::uint32_t element, std::span<const double> coefficients, std::uint32_t bands,
                              std::uint32_t band) const {
  const std::size_t p = mesh_->elements[element].patch;
  const double* of_terms = mean_.data() + first_[p] + (element - mesh_->patches[p].element_first) * terms();
  double sum = 0;
  for (std::size_t t = 0; t < terms(); ++t) sum += of_terms[t] * coefficients[(p * terms() + t) * bands + band];
  return sum;
}

std::vector<double> PatchPolynomials::shooting_values(std::span<const double> means, std::uint32_t bands) const {
  const std::vector<double> coefficients = fit(means, bands);
  std::vector<double> values(means.begin(), means.end());
  for (std::size_t e = 0; e < mesh_->elements.size(); ++e) {
    const std::size_t p = mesh_->elements[e].patch;
    const double* of_terms = correction_.data() + first_[p] + (e - mesh_->patches[p].element_first) * terms();
    for (std::size_t t = 0; t < terms(); ++t) {
      for (std::size_t b = 0; b < bands; ++b)
        values[e * bands + b] += of_terms[t] * coefficients[(p * terms() + t) * bands + b];
    }
  }
  return values;
}

}  // namespace exitance
