// GCC 12 warns of its own AVX-512 header when Eigen is inlined here.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include "sim/point_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sim {
namespace {

// Wendland C2, with a floor so that far samples still count where there are no others.
double sample_weight(double distance, double radius) {
  const double q = std::min(1.0, distance / radius);
  return std::pow(1 - q, 4) * (4 * q + 1) + 1e-6;
}

template <int D>
Eigen::VectorXd basis(const Vector<D>& x, bool quadratic) {
  constexpr int second = D * (D + 1) / 2;
  Eigen::VectorXd row(1 + D + (quadratic ? second : 0));
  row[0] = 1;
  row.segment<D>(1) = x;
  int k = 1 + D;
  for (int a = 0; quadratic && a < D; ++a)
    for (int b = a; b < D; ++b) row[k++] = x[a] * x[b];
  return row;
}

}  // namespace

// Minimal-norm least squares: min sum s_k (f_k - c . b(x_k))^2, value c_0; written as weights on f.
template <int D>
std::vector<double> fit_weights(std::span<const Vector<D>> offset, double radius, bool quadratic) {
  if (offset.empty()) return {};
  const Eigen::Index terms = basis<D>(Vector<D>::Zero(), quadratic).size();
  Eigen::MatrixXd moment = Eigen::MatrixXd::Zero(terms, terms);
  for (const Vector<D>& x : offset) {
    const Eigen::VectorXd row = basis<D>(x / radius, quadratic);
    moment += sample_weight(x.norm(), radius) * row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(moment);
  const double largest = eigen.eigenvalues()[terms - 1];
  Eigen::VectorXd first_row = Eigen::VectorXd::Zero(terms);  // of the pseudo-inverse
  for (Eigen::Index k = 0; k < terms; ++k)
    if (eigen.eigenvalues()[k] > 1e-6 * largest)
      first_row += eigen.eigenvectors()(0, k) / eigen.eigenvalues()[k] * eigen.eigenvectors().col(k);
  std::vector<double> weights;
  double sum = 0;
  for (const Vector<D>& x : offset) {
    weights.push_back(sample_weight(x.norm(), radius) * first_row.dot(basis<D>(x / radius, quadratic)));
    sum += weights.back();
  }
  for (double& weight : weights) weight = sum > 0.1 ? weight / sum : 1.0 / static_cast<double>(offset.size());
  return weights;
}

template std::vector<double> fit_weights<2>(std::span<const Vector<2>>, double, bool);
template std::vector<double> fit_weights<3>(std::span<const Vector<3>>, double, bool);

}  // namespace sim
