// The linear solver behind solid_tangent.h.
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <stdexcept>
#include <string>

#include "sim/solid_tangent.h"

namespace sim {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
constexpr double affordable_work = 4e10;  // multiplications of one factorisation; about half a minute

// Exposes the size of the factor before it is computed.
struct Cholesky : Eigen::SimplicialLDLT<Sparse, Eigen::Lower> {
  double work() const {
    const double fill = static_cast<double>(m_matrix.nonZeros());
    return m_matrix.cols() > 0 ? fill * fill / static_cast<double>(m_matrix.cols()) : 0;
  }
};
using Iteration = Eigen::ConjugateGradient<Sparse, Eigen::Lower, Eigen::IncompleteCholesky<double>>;

}  // namespace

struct SymmetricSolver::Factors {
  Cholesky cholesky;
  Iteration iteration;
  Sparse matrix;  // the iteration keeps a reference
  Eigen::Index analysed_rows = -1, analysed_entries = -1;
  bool direct = true, positive = true;
  double tolerance = 1e-10;
  int max_iterations = 0;
  bool best_effort = false;
};

SymmetricSolver::SymmetricSolver(double tolerance, int max_iterations, bool best_effort) : factors_(std::make_unique<Factors>()) {
  factors_->tolerance = tolerance;
  factors_->max_iterations = max_iterations;
  factors_->best_effort = best_effort;
}
SymmetricSolver::~SymmetricSolver() = default;
SymmetricSolver::SymmetricSolver(SymmetricSolver&&) noexcept = default;
SymmetricSolver& SymmetricSolver::operator=(SymmetricSolver&&) noexcept = default;

bool SymmetricSolver::factorise(const Sparse& lower) {
  Factors& f = *factors_;
  if (lower.rows() != f.analysed_rows || lower.nonZeros() != f.analysed_entries) {
    f.cholesky.analyzePattern(lower);
    f.direct = f.cholesky.work() < affordable_work;
    f.analysed_rows = lower.rows();
    f.analysed_entries = lower.nonZeros();
  }
  if (f.direct) {
    f.cholesky.factorize(lower);
    if (f.cholesky.info() != Eigen::Success) return false;
    f.positive = lower.rows() == 0 || f.cholesky.vectorD().minCoeff() > 0;
    return true;
  }
  f.matrix = lower;
  f.iteration.setTolerance(f.tolerance);
  f.iteration.setMaxIterations(f.max_iterations > 0 ? f.max_iterations : 20000);
  f.iteration.compute(f.matrix);
  f.positive = true;
  return f.iteration.info() == Eigen::Success;
}

bool SymmetricSolver::positive_definite() const { return factors_->positive; }
bool SymmetricSolver::direct() const { return factors_->direct; }

Eigen::VectorXd SymmetricSolver::solve(const Eigen::VectorXd& rhs) const {
  if (rhs.size() == 0) return rhs;
  if (factors_->direct) return factors_->cholesky.solve(rhs);
  Eigen::VectorXd x = factors_->iteration.solve(rhs);
  if (!factors_->best_effort && factors_->iteration.info() != Eigen::Success && factors_->iteration.error() > 1e-6)
    throw std::runtime_error("elastic solve did not converge: relative residual " + std::to_string(factors_->iteration.error()) +
                             " after " + std::to_string(factors_->iteration.iterations()) + " iterations");
  return x;
}

}  // namespace sim
