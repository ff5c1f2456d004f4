// Equilibrium of shells: Newton's method. The tangent is assembled from each particle's own 15 x 15 (2-D: 4 x 4) second derivative;
// follower loads enter by a GMRES iteration on differences of the full residual, preconditioned by the factorised tangent.
#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "sim/shell_kernel.h"

namespace sim {

using namespace shell_kernel;

namespace {

template <int D>
using LocalHessian = Eigen::Matrix<double, terms<D> * D, terms<D> * D>;
using SparseMatrix = Eigen::SparseMatrix<double>;
using Solver = Eigen::SimplicialLDLT<SparseMatrix>;

// Second derivative of one particle's energy by its fitted terms, by central differences of the first.
template <int D>
LocalHessian<D> local_hessian(const ShellElasticity<D>& shells, std::int32_t i, const Kinematics<D>& k) {
  constexpr int linear = D - 1;
  LocalHessian<D> hessian;
  const double spacing = shells.bodies[shells.body[i]].spacing;
  for (int t = 0; t < terms<D>; ++t)
    for (int c = 0; c < D; ++c) {
      const double h = t < linear ? 1e-6 : 1e-6 / spacing;
      std::array<Padded<D>, terms<D>> plus, minus;
      for (double sign : {1.0, -1.0}) {
        Kinematics<D> moved = k;
        moved.value[t][c] += sign * h;
        complete(shells, i, moved);
        energy_derivatives(shells, i, moved, sign > 0 ? plus : minus);
      }
      for (int u = 0; u < terms<D>; ++u) hessian.template block<D, 1>(u * D, t * D + c) = (plus[u] - minus[u]).template head<D>() / (2 * h);
    }
  return 0.5 * (hessian + hessian.transpose());
}

// Free components numbered; -1 where held.
template <int D>
std::vector<std::int32_t> number_unknowns(const ShellElasticity<D>& shells, std::int32_t& count) {
  std::vector<std::int32_t> number(shells.size() * D, -1);
  count = 0;
  for (std::size_t i = 0; i < shells.size(); ++i)
    for (int c = 0; c < D; ++c)
      if (!(shells.fixed[i] >> c & 1)) number[i * D + c] = count++;
  return number;
}

template <int D>
SparseMatrix tangent(const ShellElasticity<D>& shells, const std::vector<Padded<D>>& x, const std::vector<std::int32_t>& number,
                     std::int32_t unknowns) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(shells.size()); ++i) {
    if (idle(shells, i)) continue;
    const Kinematics<D> k = kinematics(shells, x.data(), i);
    const LocalHessian<D> hessian = local_hessian(shells, i, k);
    const std::int32_t first = shells.start[i], count = shells.start[i + 1] - first;
    // Rows of the map from positions to terms: the neighbours' fits, and for i minus their sum.
    Eigen::MatrixXd map(terms<D>, count + 1);
    for (std::int32_t p = 0; p < count; ++p)
      for (int t = 0; t < terms<D>; ++t) map(t, p) = shells.fit[static_cast<std::size_t>(first + p) * terms<D> + t];
    map.col(count) = -map.leftCols(count).rowwise().sum();
    Eigen::MatrixXd half(terms<D> * D, (count + 1) * D);  // hessian * map
    for (std::int32_t q = 0; q <= count; ++q) {
      Eigen::Matrix<double, terms<D> * D, D> column = Eigen::Matrix<double, terms<D> * D, D>::Zero();
      for (int t = 0; t < terms<D>; ++t) column += hessian.template middleCols<D>(t * D) * map(t, q);
      half.middleCols(q * D, D) = column;
    }
    for (std::int32_t p = 0; p <= count; ++p) {
      const std::int32_t row = p < count ? shells.neighbor[first + p] : i;
      for (std::int32_t q = 0; q <= count; ++q) {
        const std::int32_t column = q < count ? shells.neighbor[first + q] : i;
        Tensor<D> block = Tensor<D>::Zero();
        for (int t = 0; t < terms<D>; ++t) block += map(t, p) * half.template block<D, D>(t * D, q * D);
        for (int a = 0; a < D; ++a)
          for (int b = 0; b < D; ++b) {
            const std::int32_t r = number[row * D + a], c = number[column * D + b];
            if (r >= 0 && c >= 0 && r >= c) entries.emplace_back(r, c, block(a, b));
          }
      }
    }
  }
  SparseMatrix matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Factorises K + mu M with the smallest mu (0 first) that leaves it positive definite.
template <int D>
bool factorise(const ShellElasticity<D>& shells, const std::vector<std::int32_t>& number, const SparseMatrix& matrix, Solver& solver,
               double& shift) {
  SparseMatrix shifted = matrix;
  double stiffness_per_mass = 0;
  Eigen::VectorXd mass(matrix.rows());
  for (std::size_t i = 0; i < number.size(); ++i)
    if (number[i] >= 0) mass[number[i]] = shells.mass[i / D];
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) stiffness_per_mass = std::max(stiffness_per_mass, matrix.coeff(r, r) / mass[r]);
  for (int attempt = 0; attempt < 12; ++attempt) {
    if (shift > 0)
      for (Eigen::Index r = 0; r < matrix.rows(); ++r) shifted.coeffRef(r, r) = matrix.coeff(r, r) + shift * mass[r];
    solver.compute(shifted);
    if (solver.info() == Eigen::Success && solver.vectorD().minCoeff() > 0) return true;
    shift = shift > 0 ? 8 * shift : 1e-8 * stiffness_per_mass;
  }
  return false;
}

template <int D>
class Equilibrium {
 public:
  Equilibrium(const ShellElasticity<D>& shells, const ShellLoad<D>& load, std::span<Vector<D>> position)
      : shells_(shells),
        load_(load),
        position_(position),
        number_(number_unknowns(shells, unknowns_)),
        still_(shells.size(), Vector<D>::Zero()),
        force_(shells.size()) {}

  ShellStaticReport solve(double tolerance, int iterations);

 private:
  // Out-of-balance force of the free components; `scale` = largest elastic or load force.
  Eigen::VectorXd imbalance(const Eigen::VectorXd& displacement, double& scale) {
    std::vector<Vector<D>> x(position_.begin(), position_.end());
    for (std::size_t i = 0; i < number_.size(); ++i)
      if (number_[i] >= 0) x[i / D][static_cast<int>(i % D)] += displacement[number_[i]];
    shell_forces<D>(shells_, x, still_, force_);
    std::vector<Vector<D>> load(shells_.size(), Vector<D>::Zero());
    load_(x, load);
    Eigen::VectorXd result(unknowns_);
    scale = 0;
    for (std::size_t i = 0; i < number_.size(); ++i) {
      const int c = static_cast<int>(i % D);
      if (number_[i] >= 0) result[number_[i]] = force_[i / D][c] + load[i / D][c];
      scale = std::max(scale, std::abs(load[i / D][c]));
    }
    return result;
  }
  Eigen::VectorXd newton_step(const Solver& solver, const Eigen::VectorXd& r, double shift);
  void move(const Eigen::VectorXd& displacement) {
    for (std::size_t i = 0; i < number_.size(); ++i)
      if (number_[i] >= 0) position_[i / D][static_cast<int>(i % D)] += displacement[number_[i]];
  }

  const ShellElasticity<D>& shells_;
  const ShellLoad<D>& load_;
  std::span<Vector<D>> position_;
  std::int32_t unknowns_ = 0;
  std::vector<std::int32_t> number_;
  std::vector<Vector<D>> still_, force_;
};

// GMRES on the true residual's derivative (differences), preconditioned by the factorised tangent.
template <int D>
Eigen::VectorXd Equilibrium<D>::newton_step(const Solver& solver, const Eigen::VectorXd& r, double shift) {
  Eigen::VectorXd first = solver.solve(r);
  if (shift > 0) return first;
  constexpr int size = 12;
  double scale = 0;
  const double spacing = shells_.bodies.front().spacing, beta = first.norm();
  if (!(beta > 0)) return first;
  Eigen::MatrixXd basis(unknowns_, size + 1), hessenberg = Eigen::MatrixXd::Zero(size + 1, size);
  basis.col(0) = first / beta;
  Eigen::VectorXd coefficients;
  int used = 0;
  for (int k = 0; k < size; ++k) {
    const double h = 1e-6 * spacing / basis.col(k).cwiseAbs().maxCoeff();
    Eigen::VectorXd image = solver.solve((imbalance(-h * basis.col(k), scale) - imbalance(h * basis.col(k), scale)) / (2 * h));
    for (int j = 0; j <= k; ++j) {
      hessenberg(j, k) = basis.col(j).dot(image);
      image -= hessenberg(j, k) * basis.col(j);
    }
    hessenberg(k + 1, k) = image.norm();
    used = k + 1;
    Eigen::VectorXd target = Eigen::VectorXd::Zero(used + 1);
    target[0] = beta;
    const Eigen::MatrixXd h_used = hessenberg.topLeftCorner(used + 1, used);
    coefficients = h_used.colPivHouseholderQr().solve(target);
    if ((h_used * coefficients - target).norm() < 1e-3 * beta || hessenberg(k + 1, k) < 1e-12 * beta) break;
    if (k + 1 <= size) basis.col(k + 1) = image / hessenberg(k + 1, k);
  }
  return basis.leftCols(used) * coefficients;
}

template <int D>
ShellStaticReport Equilibrium<D>::solve(double tolerance, int iterations) {
  ShellStaticReport report;
  const double spacing = shells_.bodies.front().spacing;
  double scale = 0, shift = 0;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(unknowns_);
  Eigen::VectorXd r = imbalance(none, scale);
  for (report.iterations = 0; report.iterations < iterations; ++report.iterations) {
    report.residual = scale > 0 ? r.cwiseAbs().maxCoeff() / scale : 0;
    if (report.residual <= tolerance) {
      report.converged = true;
      return report;
    }
    std::vector<Padded<D>> x(shells_.size());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = pad<D>(position_[i]);
    Solver solver;
    shift = shift > 1e-3 ? shift * 0.1 : 0;
    if (!factorise(shells_, number_, tangent(shells_, x, number_, unknowns_), solver, shift)) break;
    Eigen::VectorXd step = newton_step(solver, r, shift);
    if (!step.allFinite()) break;
    const double largest = step.cwiseAbs().maxCoeff();
    const bool cut = largest > 2 * spacing;
    if (cut) step *= 2 * spacing / largest;
    // Matthies & Strang: shorten until the step's work |dx . r| has fallen; a step cut to two spacings need only not overshoot.
    const double allowed = cut ? 1.3 : 0.9;
    const double work = std::abs(step.dot(r));
    double factor = 1;
    Eigen::VectorXd next = imbalance(step, scale);
    while (factor > 1e-3 && !(std::abs(step.dot(next)) <= allowed * work)) next = imbalance((factor *= 0.5) * step, scale);
    move(factor * step);
    r = next;
  }
  report.message = "no equilibrium found within " + std::to_string(report.iterations) + " iterations: largest imbalance " +
                   std::to_string(report.residual) + " of the largest load; the sheet may be overloaded (buckling, or no equilibrium)";
  return report;
}

}  // namespace

template <int D>
ShellStaticReport solve_shell_equilibrium(const ShellElasticity<D>& shells, const ShellLoad<D>& load, std::span<Vector<D>> position,
                                          double tolerance, int iterations) {
  if (shells.empty()) return {true, 0, 0, ""};
  return Equilibrium<D>(shells, load, position).solve(tolerance, iterations);
}

template ShellStaticReport solve_shell_equilibrium<2>(const ShellElasticity<2>&, const ShellLoad<2>&, std::span<Vector<2>>, double, int);
template ShellStaticReport solve_shell_equilibrium<3>(const ShellElasticity<3>&, const ShellLoad<3>&, std::span<Vector<3>>, double, int);

}  // namespace sim
