#include "src/solve/krylov.h"

// GCC 12 takes the AVX-512 intrinsics' undefined registers for uninitialised variables (its bug 105593).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <cmath>
#include <limits>

namespace exitance {
namespace {
class RadiosityOperator;
}
}  // namespace exitance

// Eigen's way to take an operator for a matrix (its documentation, "Matrix-free solvers").
namespace Eigen::internal {
template <>
struct traits<exitance::RadiosityOperator> : traits<SparseMatrix<double>> {};
}  // namespace Eigen::internal

namespace exitance {
namespace {

// x → x − ρ F x of one band.
class RadiosityOperator : public Eigen::EigenBase<RadiosityOperator> {
 public:
  using Scalar = double;
  using RealScalar = double;
  using StorageIndex = int;
  enum { ColsAtCompileTime = Eigen::Dynamic, MaxColsAtCompileTime = Eigen::Dynamic, IsRowMajor = false };

  RadiosityOperator(const RadiositySystem& system, std::size_t band) : system_(system), band_(band) {}

  Eigen::Index rows() const { return static_cast<Eigen::Index>(system_.patches()); }
  Eigen::Index cols() const { return rows(); }

  template <typename Rhs>
  Eigen::Product<RadiosityOperator, Rhs, Eigen::AliasFreeProduct> operator*(const Eigen::MatrixBase<Rhs>& x) const {
    return {*this, x.derived()};
  }

  Eigen::VectorXd apply(const Eigen::VectorXd& x) const {
    const std::vector<double> H = irradiance(system_.F, {x.data(), system_.patches()}, 1);
    Eigen::VectorXd result = x;
    for (std::size_t p = 0; p < H.size(); ++p) {
      result[static_cast<Eigen::Index>(p)] -= system_.rho[p * system_.bands + band_] * H[p];
    }
    return result;
  }

 private:
  const RadiositySystem& system_;
  std::size_t band_;
};

}  // namespace
}  // namespace exitance

namespace Eigen::internal {
template <typename Rhs>
struct generic_product_impl<exitance::RadiosityOperator, Rhs, SparseShape, DenseShape, GemvProduct>
    : generic_product_impl_base<exitance::RadiosityOperator, Rhs,
                                generic_product_impl<exitance::RadiosityOperator, Rhs>> {
  template <typename Destination>
  static void scaleAndAddTo(Destination& to, const exitance::RadiosityOperator& A, const Rhs& x, double alpha) {
    to.noalias() += alpha * A.apply(x);
  }
};
}  // namespace Eigen::internal

namespace exitance {
namespace {
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
}

std::uint64_t solve_krylov(const RadiositySystem& s, std::span<const double> contraction, double tolerance,
                           std::uint64_t max_iterations, std::span<double> B) {
  using Strided = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  const auto n = static_cast<Eigen::Index>(s.patches());
  std::uint64_t steps = 0;
  for (std::uint32_t b = 0; b < s.bands; ++b) {
    const Eigen::InnerStride<> stride(s.bands);
    const Eigen::VectorXd E = Strided(s.E.data() + b, n, stride);
    Eigen::VectorXd x = Strided(B.data() + b, n, stride);
    const double norm = E.norm();
    if (norm == 0) {
      x.setZero();
    } else {
      const RadiosityOperator A(s, b);
      Eigen::BiCGSTAB<RadiosityOperator, Eigen::IdentityPreconditioner> solver(A);
      double max_E = 0;
      for (const double e : E) max_E = std::max(max_E, std::abs(e));
      solver.setTolerance(std::max(tolerance / 2 * (1 - contraction[b]) * max_E / norm, kEpsilon));
      solver.setMaxIterations(static_cast<Eigen::Index>(max_iterations));
      const Eigen::VectorXd found = solver.solveWithGuess(E, x);
      if (found.allFinite()) x = found;
      steps = std::max(steps, static_cast<std::uint64_t>(solver.iterations()));
    }
    for (Eigen::Index p = 0; p < n; ++p) B[static_cast<std::size_t>(p) * s.bands + b] = x[p];
  }
  return steps;
}

}  // namespace exitance
