#include "sim/solid_static.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <sstream>

namespace sim {

namespace {

template <int D>
class Equilibrium {
 public:
  Equilibrium(const SolidElasticity<D>& solid, const SolidPattern<D>& pattern, const StaticProblem<D>& problem)
      : solid_(solid), pattern_(pattern), problem_(problem), internal_(solid.size()), external_(solid.size()), trial_(solid.size()) {
    for (const Load<D>& load : problem.loads) follower_ = follower_ || follows_surface(load) || load.acceleration;
  }

  bool follower() const { return follower_; }

  // R = f_int + f_ext on the free degrees of freedom; remembers the size of the forces that should balance.
  Eigen::VectorXd residual(std::span<const Vector<D>> position, double factor) {
    solid_forces<D>(solid_, position, work_, internal_);
    loads(position, factor);
    const Eigen::VectorXd inside = gather<D>(pattern_, internal_), outside = gather<D>(pattern_, external_);
    scale_ = outside.norm();
    return inside + outside;
  }
  double scale() const { return scale_; }

  // (K - d f_ext/dx) v: K assembled, the loads' part by a difference.
  Eigen::VectorXd apply(const Eigen::SparseMatrix<double>& lower, std::span<const Vector<D>> position, double factor,
                        const Eigen::VectorXd& v) {
    Eigen::VectorXd result = lower.selfadjointView<Eigen::Lower>() * v;
    const double size = v.template lpNorm<Eigen::Infinity>();
    if (!follower_ || size == 0) return result;
    const double step = 1e-5 * solid_.spacing / size;
    const auto displaced = [&](double scale) {
      std::copy_n(position.begin(), trial_.size(), trial_.begin());
      scatter_add<D>(pattern_, v, scale, trial_);
      solid_derivatives<D>(solid_, trial_, work_);
      loads(trial_, factor);
      return gather<D>(pattern_, external_);
    };
    const Eigen::VectorXd plus = displaced(step);
    return result - (plus - displaced(-step)) / (2 * step);
  }

  void tangent(std::span<const Vector<D>> position, Eigen::SparseMatrix<double>& lower) {
    assemble_tangent<D>(solid_, pattern_, position, work_, lower);
  }

 private:
  void loads(std::span<const Vector<D>> position, double factor) {
    std::fill(external_.begin(), external_.end(), Vector<D>::Zero());
    external_loads<D>(solid_, problem_.loads, problem_.gravity, factor, position, work_, external_, factor);
  }

  const SolidElasticity<D>& solid_;
  const SolidPattern<D>& pattern_;
  const StaticProblem<D>& problem_;
  SolidWork<D> work_;
  std::vector<Vector<D>> internal_, external_, trial_;
  double scale_ = 0;
  bool follower_ = false;
};

// GMRES (Saad & Schultz 1986) with right preconditioning: solves apply(x) = rhs to a relative residual of 1e-6.
template <class Apply>
Eigen::VectorXd gmres(const SymmetricSolver& preconditioner, const Eigen::VectorXd& rhs, Apply&& apply) {
  constexpr int directions = 40;
  const double norm = rhs.norm();
  if (norm == 0) return rhs;
  std::vector<Eigen::VectorXd> basis{rhs / norm}, conditioned;
  Eigen::MatrixXd hessenberg = Eigen::MatrixXd::Zero(directions + 1, directions);
  Eigen::VectorXd y;
  for (int k = 0; k < directions; ++k) {
    conditioned.push_back(preconditioner.solve(basis[k]));
    Eigen::VectorXd w = apply(conditioned[k]);
    for (int j = 0; j <= k; ++j) {
      hessenberg(j, k) = w.dot(basis[j]);
      w -= hessenberg(j, k) * basis[j];
    }
    hessenberg(k + 1, k) = w.norm();
    Eigen::VectorXd target = Eigen::VectorXd::Zero(k + 2);
    target(0) = norm;
    const Eigen::MatrixXd h = hessenberg.topLeftCorner(k + 2, k + 1);
    y = h.colPivHouseholderQr().solve(target);
    if ((target - h * y).norm() < 1e-6 * norm || hessenberg(k + 1, k) < 1e-14 * norm) break;
    basis.push_back(w / hessenberg(k + 1, k));
  }
  Eigen::VectorXd x = Eigen::VectorXd::Zero(rhs.size());
  for (Eigen::Index k = 0; k < y.size(); ++k) x += y(k) * conditioned[k];
  return x;
}

// Factorises K, shifted along its diagonal where it is not positive definite (past a limit point Newton would climb instead of descend).
bool factorise_definite(Eigen::SparseMatrix<double>& lower, SymmetricSolver& solver, StaticReport& report) {
  double shift = 0;
  for (int attempt = 0; attempt < 8; ++attempt) {
    ++report.factorisations;
    if (solver.factorise(lower) && solver.positive_definite()) return true;
    const double next = shift == 0 ? 1e-6 : 10 * shift;
    for (Eigen::Index c = 0; c < lower.cols(); ++c) {
      double& diagonal = lower.valuePtr()[lower.outerIndexPtr()[c]];
      diagonal += (next - shift) * std::max(std::abs(diagonal), 1e-300);
    }
    shift = next;
  }
  return false;
}

// Newton's method at one load factor. False where it does not converge.
template <int D>
bool newton(Equilibrium<D>& equilibrium, const SolidElasticity<D>& solid, const SolidPattern<D>& pattern, const StaticProblem<D>& problem,
            double factor, SymmetricSolver& solver, Eigen::SparseMatrix<double>& lower, std::vector<Vector<D>>& position,
            StaticReport& report) {
  double extent = 0;
  for (const auto& x : solid.rest) extent = std::max(extent, x.template lpNorm<Eigen::Infinity>());
  Eigen::VectorXd r = equilibrium.residual(position, factor);
  std::vector<Vector<D>> trial;
  for (int iteration = 0; iteration < problem.newton_iterations; ++iteration) {
    if (!r.allFinite()) return false;
    report.residual = r.norm() / std::max(equilibrium.scale(), 1e-300);
    if (r.norm() <= problem.tolerance * equilibrium.scale()) return true;
    ++report.newton_iterations;
    equilibrium.tangent(position, lower);
    if (!factorise_definite(lower, solver, report)) return false;
    Eigen::VectorXd step = equilibrium.follower()
                               ? gmres(solver, r, [&](const Eigen::VectorXd& v) { return equilibrium.apply(lower, position, factor, v); })
                               : solver.solve(r);
    if (!step.allFinite()) return false;
    const double slope = std::abs(r.dot(step));
    double scale = 1, best = 1e300, best_scale = 1;
    for (int search = 0; search < 6; ++search) {
      trial = position;
      scatter_add<D>(pattern, step, scale, trial);
      const Eigen::VectorXd next = equilibrium.residual(trial, factor);
      const double reached = next.allFinite() ? std::abs(next.dot(step)) : 1e300;
      if (reached < best) {
        best = reached;
        best_scale = scale;
        r = next;
      }
      if (best <= 0.8 * slope) break;
      scale /= 2;
    }
    if (best >= 1e300) return false;
    scatter_add<D>(pattern, step, best_scale, position);
    // Round-off of positions: a step of this size changes nothing that could be stored.
    const double rounding = std::max(4e-15 * extent, 1e-11 * solid.spacing);
    if (step.template lpNorm<Eigen::Infinity>() < rounding) return true;
  }
  return false;
}

template <int D>
std::string overload_message(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, double reached, double wanted,
                             double residual) {
  SolidWork<D> work;
  solid_derivatives<D>(solid, position, work);
  double largest = 0;
  std::size_t where = 0;
  for (std::size_t i = 0; i < solid.size(); ++i) {
    const Tensor<D> f = Tensor<D>::Identity() + work.derivatives[i].template leftCols<D>();
    const double strain = 0.5 * (f.transpose() * f - Tensor<D>::Identity()).norm();
    if (strain > largest) largest = strain, where = i;
  }
  std::ostringstream text;
  text.precision(4);
  text << "overloaded: no equilibrium found beyond load factor " << reached << " of " << wanted << " (body " << solid.body[where]
       << ", largest strain " << largest << " at (" << solid.rest[where].transpose() << ") m, residual " << residual
       << "); lower the load, stiffen the material, or hold the body better";
  return text.str();
}

}  // namespace

template <int D>
StaticReport solve_static(const SolidElasticity<D>& solid, const SolidPattern<D>& pattern, const StaticProblem<D>& problem, double from,
                          double to, std::span<Vector<D>> position) {
  StaticReport report;
  Equilibrium<D> equilibrium(solid, pattern, problem);
  SymmetricSolver solver;
  Eigen::SparseMatrix<double> lower;
  double reached = from, step = to - from;
  std::vector<Vector<D>> previous(position.begin(), position.begin() + static_cast<std::ptrdiff_t>(solid.size()));
  std::vector<Vector<D>> current = previous, trial;
  double previous_factor = from;
  while (reached < to) {
    const double target = reached + step > to - 1e-9 * std::abs(to) ? to : reached + step;
    trial = current;
    if (reached > previous_factor)  // continue along the last increment
      for (std::size_t i = 0; i < trial.size(); ++i)
        trial[i] += (target - reached) / (reached - previous_factor) * (current[i] - previous[i]);
    const int before = report.newton_iterations;
    if (newton(equilibrium, solid, pattern, problem, target, solver, lower, trial, report)) {
      ++report.load_steps;
      previous = current;
      previous_factor = reached;
      current = trial;
      reached = target;
      if (report.newton_iterations - before <= 6) step *= 2;
      continue;
    }
    step = (target - reached) / 4;
    if (step < problem.smallest_step * (to - from)) {
      std::copy(current.begin(), current.end(), position.begin());
      throw Overloaded(overload_message<D>(solid, current, reached, to, report.residual));
    }
  }
  std::copy(current.begin(), current.end(), position.begin());
  return report;
}

template StaticReport solve_static<2>(const SolidElasticity<2>&, const SolidPattern<2>&, const StaticProblem<2>&, double, double,
                                      std::span<Vector<2>>);
template StaticReport solve_static<3>(const SolidElasticity<3>&, const SolidPattern<3>&, const StaticProblem<3>&, double, double,
                                      std::span<Vector<3>>);

}  // namespace sim
