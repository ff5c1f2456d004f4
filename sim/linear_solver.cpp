#include "sim/linear_solver.h"

#include <algorithm>
#include <cmath>

#include "sim/multigrid.h"
#include "sim/parallel.h"

namespace sim {
namespace {

using Index = std::ptrdiff_t;
double dot(std::span<const double> a, std::span<const double> b) {
  return ordered_sum(a.size(), [&](std::size_t i) { return a[i] * b[i]; });
}

}  // namespace

void multiply(const SymmetricMatrix& m, std::span<const double> x, std::span<double> y) {
  const Index n = static_cast<Index>(m.rows());
#pragma omp parallel for schedule(static) if (n > 2000)
  for (Index i = 0; i < n; ++i) {
    double s = m.diagonal[i] * x[i];
    for (std::int64_t k = m.start[i]; k < m.start[i + 1]; ++k) s += m.value[k] * x[m.column[k]];
    y[i] = s;
  }
}

SolveReport conjugate_gradient(const SymmetricMatrix& matrix, std::span<const double> b, std::span<double> x, double tolerance,
                               int max_iterations, Multigrid* multigrid, ConjugateGradientScratch& s,
                               const std::function<void(std::span<const double>, std::span<double>)>& add_to_product) {
  const std::size_t n = matrix.rows();
  s.r.resize(n), s.z.resize(n), s.p.resize(n), s.q.resize(n);
  SolveReport report;
  const double norm_b = std::sqrt(dot(b, b));
  if (!(norm_b > 0)) {
    std::fill(x.begin(), x.end(), 0.0);
    report.converged = norm_b == 0;
    return report;
  }
  const Index rows = static_cast<Index>(n);
  auto precondition = [&] {
    if (multigrid) return apply_multigrid(*multigrid, s.r, s.z);
#pragma omp parallel for schedule(static) if (rows > 8000)
    for (Index i = 0; i < rows; ++i) s.z[i] = matrix.diagonal[i] > 0 ? s.r[i] / matrix.diagonal[i] : 0;
  };
  multiply(matrix, x, s.q);
  if (add_to_product) add_to_product(x, s.q);
  for (std::size_t i = 0; i < n; ++i) s.r[i] = b[i] - s.q[i];
  double norm_r = std::sqrt(dot(s.r, s.r));
  double rho_old = 0;
  while (norm_r > tolerance * norm_b && report.iterations < max_iterations) {
    precondition();
    const double rho = dot(s.r, s.z);
    const double beta = report.iterations == 0 ? 0 : rho / rho_old;
#pragma omp parallel for schedule(static) if (rows > 8000)
    for (Index i = 0; i < rows; ++i) s.p[i] = s.z[i] + beta * s.p[i];
    multiply(matrix, s.p, s.q);
    if (add_to_product) add_to_product(s.p, s.q);
    const double curvature = dot(s.p, s.q);
    if (!(curvature > 0) || !(rho > 0)) break;
    const double alpha = rho / curvature;
    const double square = ordered_sum(n, [&](std::size_t i) {
      x[i] += alpha * s.p[i];
      s.r[i] -= alpha * s.q[i];
      return s.r[i] * s.r[i];
    });
    rho_old = rho;
    norm_r = std::sqrt(square);
    ++report.iterations;
  }
  report.residual = norm_r / norm_b;
  report.converged = norm_r <= tolerance * norm_b;
  return report;
}

template <int D>
SolveReport conjugate_gradient(const SymmetricMatrix& matrix, std::span<const Eigen::Matrix<double, D, 1>> b,
                               std::span<Eigen::Matrix<double, D, 1>> x, double tolerance, int max_iterations, VectorScratch<D>& s) {
  using Row = Eigen::Matrix<double, D, 1>;
  using Numbers = Eigen::Array<double, D, 1>;  // one a right-hand side
  const std::size_t n = matrix.rows();
  const Index rows = static_cast<Index>(n);
  const Numbers zero = Numbers::Zero();
  s.r.resize(n), s.p.resize(n), s.q.resize(n);
  const auto product = [&](std::span<const Row> from, std::span<Row> to) {
#pragma omp parallel for schedule(static) if (rows > 2000)
    for (Index i = 0; i < rows; ++i) {
      Row sum = matrix.diagonal[i] * from[i];
      for (std::int64_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) sum += matrix.value[k] * from[matrix.column[k]];
      to[i] = sum;
    }
  };
  const auto preconditioned = [&](std::size_t i) { return Row(s.r[i] / matrix.diagonal[i]); };
  product(x, s.q);
  const Numbers size = ordered_total(n, zero, [&](std::size_t i) { return Numbers(b[i].array().square()); }).sqrt();
  Numbers residual = ordered_total(n, zero, [&](std::size_t i) {
                       s.r[i] = b[i] - s.q[i];
                       return Numbers(s.r[i].array().square());
                     }).sqrt();
  Numbers rho_old = zero;
  SolveReport report;
  for (int step = 0; step < max_iterations && (residual > tolerance * size).any(); ++step) {
    const Numbers rho = ordered_total(n, zero, [&](std::size_t i) { return Numbers(s.r[i].array() * preconditioned(i).array()); });
    const Numbers beta = step == 0 ? zero : Numbers((rho_old > 0).select(rho / rho_old, zero));
#pragma omp parallel for schedule(static) if (rows > 2000)
    for (Index i = 0; i < rows; ++i)
      s.p[i] = step == 0 ? preconditioned(static_cast<std::size_t>(i))
                         : Row(preconditioned(static_cast<std::size_t>(i)) + (beta * s.p[i].array()).matrix());
    product(s.p, s.q);
    const Numbers curvature = ordered_total(n, zero, [&](std::size_t i) { return Numbers(s.p[i].array() * s.q[i].array()); });
    const Numbers alpha = (curvature > 0).select(rho / curvature, zero);  // 0: that side is solved to the last bit
    residual = ordered_total(n, zero, [&](std::size_t i) {
                 x[i].array() += alpha * s.p[i].array();
                 s.r[i].array() -= alpha * s.q[i].array();
                 return Numbers(s.r[i].array().square());
               }).sqrt();
    report.iterations += D;
    if ((alpha == 0).all()) break;
    rho_old = rho;
  }
  report.residual = (size > 0).select(residual / size, zero).maxCoeff();
  report.converged = (residual <= tolerance * size).all();
  return report;
}

template SolveReport conjugate_gradient<2>(const SymmetricMatrix&, std::span<const Eigen::Vector2d>, std::span<Eigen::Vector2d>, double,
                                           int, VectorScratch<2>&);
template SolveReport conjugate_gradient<3>(const SymmetricMatrix&, std::span<const Eigen::Vector3d>, std::span<Eigen::Vector3d>, double,
                                           int, VectorScratch<3>&);

}  // namespace sim
