// Aggregation multigrid as a preconditioner of conjugate gradients (numerics-fluid §3): single precision, deterministic, symmetric.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/linear_solver.h"

namespace sim {

// One level. Its rows are cut into blocks of fixed size; Gauss-Seidel runs inside a block, blocks see each other's old values, so that
// blocks can be swept at once and the result does not depend on the thread count. Entries of row i, by where their column lies:
// [start[i], lower[i]) in the block before i, [lower[i], upper[i]) in the block after i, [upper[i], start[i + 1]) in other blocks.
struct MultigridLevel {
  std::vector<std::int64_t> start, lower, upper;
  std::vector<std::int32_t> column;
  std::vector<float> value, diagonal, inverse_diagonal;
  // The next coarser level gathers rows into aggregates; prolongation is piecewise constant.
  std::vector<std::int32_t> aggregate;             // row -> row of the coarser level
  std::vector<std::int32_t> member_start, member;  // row of the coarser level -> rows
  std::vector<float> x, b, r;                      // scratch
};
struct Multigrid {
  std::vector<MultigridLevel> levels;  // [0] is the finest, a float copy of the matrix
  std::vector<double> coarse_inverse;  // dense inverse of the coarsest level (row major); empty where that level is too large for it
};

// Greedy aggregates over strong links (at least half the row's strongest) of `matrix`, or of the sum of `matrix` and `further` (same rows).
// Off-diagonal entries may be in any order. What `multigrid` held is replaced, its room used again.
void build_multigrid(Multigrid& multigrid, const SymmetricMatrix& matrix, const SymmetricMatrix* further = nullptr);
// z = M r: one V-cycle, a Gauss-Seidel sweep forward before and backward after, coarse corrections over-relaxed by 1.5; symmetric.
void apply_multigrid(Multigrid& multigrid, std::span<const double> r, std::span<double> z);

}  // namespace sim
