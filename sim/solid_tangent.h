// Consistent tangent stiffness of the solids: derivative of minus the internal forces, and what is factorised from it.
#pragma once

#include <Eigen/Sparse>
#include <memory>
#include <span>
#include <vector>

#include "sim/solid.h"

namespace sim {

// Degrees of freedom (row, axis) that are free, and which of them meet in the tangent. Built once.
template <int D>
struct SolidPattern {
  std::vector<std::int32_t> dof;  // row * D + axis -> number, or -1 where held
  std::int32_t dofs = 0;
  std::vector<std::int64_t> node_begin;  // n + 1: rows that a particle's energy depends on, itself first
  std::vector<std::int32_t> node;
  Eigen::SparseMatrix<double> lower;  // pattern of the lower triangle, values 0
};
template <int D>
SolidPattern<D> solid_pattern(const SolidElasticity<D>& solid);

// K = -d(solid_forces)/d(position), N/m, lower triangle, into `lower` (which has the pattern's structure).
template <int D>
void assemble_tangent(const SolidElasticity<D>& solid, const SolidPattern<D>& pattern, std::span<const Vector<D>> position,
                      SolidWork<D>& work, Eigen::SparseMatrix<double>& lower);

// Adds coefficient * value_i to the diagonal (masses, shifts); value has one number a row.
template <int D>
void add_to_diagonal(const SolidPattern<D>& pattern, std::span<const double> value, double coefficient, Eigen::SparseMatrix<double>& lower);

// Between per-row vectors and the vector of free degrees of freedom.
template <int D>
Eigen::VectorXd gather(const SolidPattern<D>& pattern, std::span<const Vector<D>> rows);
template <int D>
void scatter_add(const SolidPattern<D>& pattern, const Eigen::VectorXd& values, double scale, std::span<Vector<D>> rows);

// A symmetric system: sparse LDL^T where its fill is affordable, otherwise conjugate gradients with an incomplete factor. The ordering is
// kept between factorisations of the same pattern.
class SymmetricSolver {
 public:
  // tolerance: relative residual of the iteration; best_effort: accept what max_iterations give (0 = plenty) instead of throwing.
  explicit SymmetricSolver(double tolerance = 1e-10, int max_iterations = 0, bool best_effort = false);
  ~SymmetricSolver();
  SymmetricSolver(SymmetricSolver&&) noexcept;
  SymmetricSolver& operator=(SymmetricSolver&&) noexcept;

  // lower triangle; false where the matrix could not be factorised (a zero pivot).
  bool factorise(const Eigen::SparseMatrix<double>& lower);
  bool positive_definite() const;  // of the last factorised matrix (true for the iterative solver)
  bool direct() const;
  // Throws std::runtime_error where the iteration does not get to its tolerance.
  Eigen::VectorXd solve(const Eigen::VectorXd& rhs) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace sim
