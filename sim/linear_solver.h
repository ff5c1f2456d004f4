// Symmetric positive (semi-)definite sparse systems: conjugate gradients with an aggregation multigrid or Jacobi preconditioner.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace sim {

// Rows of a symmetric matrix: diagonal apart, off-diagonal entries in CSR. Both halves are stored.
struct SymmetricMatrix {
  std::vector<double> diagonal;
  std::vector<std::int64_t> start;  // rows + 1
  std::vector<std::int32_t> column;
  std::vector<double> value;  // off-diagonal, usually negative
  std::size_t rows() const { return diagonal.size(); }
};

// y = A x
void multiply(const SymmetricMatrix& matrix, std::span<const double> x, std::span<double> y);

struct SolveReport {
  int iterations = 0;
  double residual = 0;  // |b - A x| / |b|
  bool converged = true;
};

struct Multigrid;  // multigrid.h

// Scratch of the conjugate gradients, kept between calls.
struct ConjugateGradientScratch {
  std::vector<double> r, z, p, q;
};

// Solves A x = b to |r| <= tolerance |b| from the guess in x. With `multigrid` null the preconditioner is Jacobi.
// add_to_product(x, y) adds a further symmetric positive semi-definite operator: y += B x.
SolveReport conjugate_gradient(const SymmetricMatrix& matrix, std::span<const double> b, std::span<double> x, double tolerance,
                               int max_iterations, Multigrid* multigrid, ConjugateGradientScratch& scratch,
                               const std::function<void(std::span<const double>, std::span<double>)>& add_to_product = {});

// The same for D right-hand sides at once, each with its own step lengths, Jacobi preconditioned: the matrix is read once for all. x, b:
// one vector a row. The report holds the sum of the iterations and the largest residual.
template <int D>
struct VectorScratch {
  std::vector<Eigen::Matrix<double, D, 1>> r, p, q;
};
template <int D>
SolveReport conjugate_gradient(const SymmetricMatrix& matrix, std::span<const Eigen::Matrix<double, D, 1>> b,
                               std::span<Eigen::Matrix<double, D, 1>> x, double tolerance, int max_iterations, VectorScratch<D>& scratch);

}  // namespace sim
