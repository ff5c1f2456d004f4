// Least squares for the second derivatives of a field at a particle: what makes the Laplacian exact for quadratic fields on any
// arrangement.
#pragma once

#include <Eigen/Dense>

#include "sim/particles.h"

namespace sim {

template <int D>
constexpr int quadratic_terms = D == 2 ? 5 : 9;

// Monomials of a quadratic Taylor expansion, x in units of l0: x_a, x_a²/2, x_a x_b.
template <int D>
Eigen::Matrix<double, quadratic_terms<D>, 1> quadratic_monomials(const Vector<D>& x) {
  Eigen::Matrix<double, quadratic_terms<D>, 1> m;
  if constexpr (D == 2)
    m << x[0], x[1], 0.5 * x[0] * x[0], 0.5 * x[1] * x[1], x[0] * x[1];
  else
    m << x[0], x[1], x[2], 0.5 * x[0] * x[0], 0.5 * x[1] * x[1], 0.5 * x[2] * x[2], x[0] * x[1], x[0] * x[2], x[1] * x[2];
  return m;
}

// l0² times the Laplacian at a particle as sum_k weight(x_k, w_k) (f_k - f_i), x_k in units of l0: add all samples, solve, ask for the
// weights.
template <int D>
class LaplacianFit {
 public:
  using Terms = Eigen::Matrix<double, quadratic_terms<D>, 1>;
  using Square = Eigen::Matrix<double, quadratic_terms<D>, quadratic_terms<D>>;
  void add(const Vector<D>& x, double w) { moment_.template selfadjointView<Eigen::Lower>().rankUpdate(quadratic_monomials<D>(x), w); }
  // For sum_ab form_ab d²f/dx_a dx_b, by default the Laplacian. False where the samples are too few or too one-sided to tell.
  bool solve(const Tensor<D>& form = Tensor<D>::Identity()) {
    Terms wanted = Terms::Zero();
    int k = D;
    for (int a = 0; a < D; ++a) wanted[k++] = form(a, a);
    for (int a = 0; a < D; ++a)
      for (int b = a + 1; b < D; ++b) wanted[k++] = 2 * form(a, b);
    const Eigen::LDLT<Square, Eigen::Lower> factor(moment_);
    const auto pivots = factor.vectorD();
    if (!(pivots.minCoeff() > 1e-4 * pivots.maxCoeff())) return false;
    solution_ = factor.solve(wanted);
    return true;
  }
  double weight(const Vector<D>& x, double w) const { return w * solution_.dot(quadratic_monomials<D>(x)); }

 private:
  Square moment_ = Square::Zero();
  Terms solution_ = Terms::Zero();
};

}  // namespace sim
