// Least squares for the second derivatives of a field at a particle: what makes the Laplacian exact for quadratic fields on any
// arrangement.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <numeric>

#include "sim/particles.h"

namespace sim {

template <int D>
constexpr int quadratic_terms = D == 2 ? 5 : 9;

// Monomials of a quadratic Taylor expansion, x in units of l0: x_a, x_a²/2, x_a x_b; filled up with zeros to whole registers.
using Monomials = Eigen::Matrix<double, 12, 1>;
template <int D>
Monomials quadratic_monomials(const Vector<D>& x) {
  Monomials m;
  if constexpr (D == 2)
    m << x[0], x[1], 0.5 * x[0] * x[0], 0.5 * x[1] * x[1], x[0] * x[1], 0, 0, 0, 0, 0, 0, 0;
  else
    m << x[0], x[1], x[2], 0.5 * x[0] * x[0], 0.5 * x[1] * x[1], 0.5 * x[2] * x[2], x[0] * x[1], x[0] * x[2], x[1] * x[2], 0, 0, 0;
  return m;
}

// l0² times the Laplacian at a particle as sum_k weight(x_k, w_k) (f_k - f_i), x_k in units of l0: add all samples, solve, ask for the
// weights.
template <int D>
class LaplacianFit {
 public:
  LaplacianFit() { row_.fill(Monomials::Zero()); }
  void add(const Vector<D>& x, double w) {
    const Monomials m = quadratic_monomials<D>(x);
    for (int a = 0; a < terms; ++a) row_[a] += (w * m[a]) * m;
  }
  // For sum_ab form_ab d²f/dx_a dx_b, by default the Laplacian. False where the samples are too few or too one-sided to tell: where a pivot
  // falls below 1e-4 of the largest.
  bool solve(const Tensor<D>& form = Tensor<D>::Identity()) {
    Monomials wanted = Monomials::Zero();
    int k = D;
    for (int a = 0; a < D; ++a) wanted[k++] = form(a, a);
    for (int a = 0; a < D; ++a)
      for (int b = a + 1; b < D; ++b) wanted[k++] = 2 * form(a, b);
    return solve_for(wanted);
  }
  double weight(const Vector<D>& x, double w) const { return w * solution_.dot(quadratic_monomials<D>(x)); }

 private:
  static constexpr int terms = quadratic_terms<D>;

  // L D L^T in the order of falling diagonals.
  bool solve_for(const Monomials& wanted) {
    std::array<int, terms> order;
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return row_[a][a] > row_[b][b]; });
    std::array<Monomials, terms> a;  // upper triangle, and the right-hand side behind it
    for (int i = 0; i < terms; ++i) {
      for (int j = 0; j < terms; ++j) a[i][j] = row_[order[i]][order[j]];
      for (int j = terms; j < a[i].size(); ++j) a[i][j] = 0;
      a[i][terms] = wanted[order[i]];
    }
    double least = a[0][0], largest = a[0][0];
    for (int k = 0; k < terms; ++k) {
      const double pivot = a[k][k];
      least = std::min(least, pivot), largest = std::max(largest, pivot);
      if (!(least > 1e-4 * largest)) return false;
      const double inverse = 1 / pivot;
      for (int i = k + 1; i < terms; ++i) a[i] -= (a[k][i] * inverse) * a[k];
    }
    solution_.setZero();
    std::array<double, terms> solution;
    for (int k = terms; k-- > 0;) {
      double rest = a[k][terms];
      for (int j = k + 1; j < terms; ++j) rest -= a[k][j] * solution[j];
      solution[k] = rest / a[k][k];
      solution_[order[k]] = solution[k];
    }
    return true;
  }

  std::array<Monomials, terms> row_;  // sum of w m m^T
  Monomials solution_ = Monomials::Zero();
};

}  // namespace sim
