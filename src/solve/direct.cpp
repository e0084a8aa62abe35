#include "src/solve/direct.h"

// GCC 12 takes the AVX-512 intrinsics' undefined registers for uninitialised variables (its bug 105593).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <Eigen/LU>

namespace exitance {

void solve_direct(const RadiositySystem& s, std::span<double> B) {
  const auto n = static_cast<Eigen::Index>(s.patches());
  for (std::size_t b = 0; b < s.bands; ++b) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd E(n);
    for (std::size_t p = 0; p < s.patches(); ++p) {
      const auto row = static_cast<Eigen::Index>(p);
      const auto columns = s.F.row_columns(p);
      for (std::size_t k = 0; k < columns.size(); ++k) A(row, columns[k]) -= s.rho[p * s.bands + b] * s.F.row(p)[k];
      E[row] = s.E[p * s.bands + b];
    }
    const Eigen::VectorXd x = A.partialPivLu().solve(E);
    for (std::size_t p = 0; p < s.patches(); ++p) B[p * s.bands + b] = x[static_cast<Eigen::Index>(p)];
  }
}

}  // namespace exitance
