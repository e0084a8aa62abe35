#pragma once
// Radiosity systems made of random numbers, and their solutions in 50 decimal digits.

#include <Eigen/LU>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cstdint>
#include <random>
#include <vector>

#include "src/solve/radiosity_system.h"

namespace exitance {

class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : bits_(seed) {}
  double below(double limit) { return static_cast<double>(bits_() >> 11) * 0x1p-53 * limit; }

 private:
  std::mt19937_64 bits_;
};

inline FormFactorMatrix dense_matrix(std::size_t n, const std::vector<double>& F) {
  FormFactorMatrix matrix;
  matrix.columns = static_cast<std::uint32_t>(n);
  for (std::size_t i = 0; i < F.size() / n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (F[i * n + j] == 0) continue;
      matrix.column.push_back(static_cast<std::uint32_t>(j));
      matrix.F.push_back(F[i * n + j]);
      matrix.F_error.push_back(0);
    }
    matrix.row_first.push_back(matrix.F.size());
  }
  return matrix;
}

/// Reciprocal form factors A_i F_ij = A_j F_ji of n patches; rows sum to `closed` (1: a closed enclosure). Some pairs
/// do not see each other. Reflectances below max_rho, one patch at it; a few patches emit.
inline RadiositySystem random_enclosure(std::size_t n, std::uint32_t bands, double max_rho, double closed,
                                        std::uint64_t seed) {
  RandomNumbers random(seed);
  std::vector<double> exchange(n * n);  // A_i F_ij, symmetric
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const double value = random.below(1);
      exchange[i * n + j] = exchange[j * n + i] = value < 0.3 && j != i + 1 ? 0 : value;
    }
  }
  RadiositySystem system;
  system.bands = bands;
  std::vector<double> F(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < n; ++j) sum += exchange[i * n + j];
    system.area.push_back(sum / closed);
    for (std::size_t j = 0; j < n; ++j) F[i * n + j] = exchange[i * n + j] / sum * closed;
  }
  system.F = dense_matrix(n, F);
  for (std::size_t i = 0; i < n * bands; ++i) {
    system.rho.push_back(i / bands == n / 2 ? max_rho : random.below(max_rho));
    system.E.push_back(i / bands % 5 == 0 ? random.below(100) : 0.0);
  }
  return system;
}

/// One element a patch: the element rows are the system's own.
inline Discretisation one_element_each(const RadiositySystem& system) {
  Discretisation d;
  d.bands = system.bands;
  for (std::uint32_t p = 1; p <= system.patches(); ++p) d.element_first.push_back(p);
  d.element_area = system.area;
  d.rho = system.rho;
  d.E = system.E;
  return d;
}

using Precise = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

/// B* of the system as it stands, in 50 digits.
inline std::vector<Precise> true_solution(const RadiositySystem& s) {
  const auto n = static_cast<Eigen::Index>(s.patches());
  std::vector<Precise> B(s.E.size());
  for (std::size_t b = 0; b < s.bands; ++b) {
    Eigen::Matrix<Precise, Eigen::Dynamic, Eigen::Dynamic> A(n, n);
    Eigen::Matrix<Precise, Eigen::Dynamic, 1> E(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto p = static_cast<std::size_t>(i);
      for (Eigen::Index j = 0; j < n; ++j) A(i, j) = i == j ? 1 : 0;
      for (std::size_t k = 0; k < s.F.row(p).size(); ++k) {
        A(i, s.F.row_columns(p)[k]) -= Precise(s.rho[p * s.bands + b]) * Precise(s.F.row(p)[k]);
      }
      E(i) = s.E[p * s.bands + b];
    }
    const Eigen::Matrix<Precise, Eigen::Dynamic, 1> x = A.partialPivLu().solve(E);
    for (Eigen::Index i = 0; i < n; ++i) B[static_cast<std::size_t>(i) * s.bands + b] = x(i);
  }
  return B;
}

/// ‖B − B*‖∞ relative to max |B|, worst band.
inline double true_error(const RadiositySystem& s, const std::vector<double>& B, const std::vector<Precise>& truth) {
  double worst = 0;
  for (std::size_t b = 0; b < s.bands; ++b) {
    Precise error = 0, largest = 0;
    for (std::size_t i = b; i < B.size(); i += s.bands) {
      error = std::max<Precise>(error, abs(Precise(B[i]) - truth[i]));
      largest = std::max<Precise>(largest, abs(Precise(B[i])));
    }
    if (error > 0) worst = std::max(worst, static_cast<double>(error / largest));
  }
  return worst;
}

}  // namespace exitance
