// Symmetric positive (semi-)definite sparse systems: conjugate gradients with an aggregation multigrid or Jacobi preconditioner.
#pragma once

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

// One coarse level: unknowns of the finer level gathered into aggregates; piecewise-constant prolongation. Single precision.
struct MultigridLevel {
  std::vector<std::int32_t> aggregate;  // finer unknown -> this level's unknown; -1 = not represented
  std::vector<std::int64_t> start;
  std::vector<std::int32_t> column;
  std::vector<float> value, diagonal, inverse_diagonal;
  std::vector<float> x, b, r;  // scratch
};
struct Multigrid {
  std::vector<MultigridLevel> levels;  // [0] is the finest, a float copy of the matrix
  std::vector<double> coarse_inverse;  // dense pseudo-inverse factor of the coarsest level (row major)
};

// Aggregation multigrid: greedy aggregates over strong links (at least half the row's strongest), damped Jacobi (0.7) before and after,
// coarse corrections over-relaxed by 1.5 (numerics-fluid §3). Deterministic.
Multigrid build_multigrid(const SymmetricMatrix& matrix);
// z = M r, one V(1,1) cycle; symmetric.
void apply_multigrid(Multigrid& multigrid, std::span<const double> r, std::span<double> z);

// Scratch of the conjugate gradients, kept between calls.
struct ConjugateGradientScratch {
  std::vector<double> r, z, p, q;
};

// Solves A x = b to |r| <= tolerance |b| from the guess in x. With `multigrid` null the preconditioner is Jacobi.
// add_to_product(x, y) adds a further symmetric positive semi-definite operator: y += B x.
SolveReport conjugate_gradient(const SymmetricMatrix& matrix, std::span<const double> b, std::span<double> x, double tolerance,
                               int max_iterations, Multigrid* multigrid, ConjugateGradientScratch& scratch,
                               const std::function<void(std::span<const double>, std::span<double>)>& add_to_product = {});

}  // namespace sim
