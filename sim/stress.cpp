#include "sim/stress.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sim {

Eigen::Matrix3d embed_deformation(const Eigen::Matrix2d& f, double across) {
  Eigen::Matrix3d embedded = Eigen::Matrix3d::Zero();
  embedded.topLeftCorner<2, 2>() = f;
  embedded(2, 2) = across;
  return embedded;
}
Eigen::Matrix3d embed_deformation(const Eigen::Matrix3d& f, double) { return f; }

Eigen::Matrix3d cauchy_from_piola(const Eigen::Matrix3d& p, const Eigen::Matrix3d& f) {
  const Eigen::Matrix3d kirchhoff = p * f.transpose();
  // An inverted or collapsed cell has no Cauchy stress; a floor keeps the picture finite.
  return 0.5 * (kirchhoff + kirchhoff.transpose()) / std::max(f.determinant(), 1e-3);
}

template <int D>
Eigen::Matrix3d cauchy_stress(const ElasticLawPoint<D>& point, const Tensor<D>& f) {
  ElasticLawPoint<3> solid;
  solid.law = point.law;
  solid.moduli = point.moduli;
  solid.fibre_modulus = point.fibre_modulus;
  solid.fibre_stiffening = point.fibre_stiffening;
  solid.fibre_limit = point.fibre_limit;
  double across = 1;
  if constexpr (D == 2) {
    across = thickness_stretch(point, f);
    solid.fibre << point.fibre, 0;
  } else {
    solid.fibre = point.fibre;
  }
  const Eigen::Matrix3d embedded = embed_deformation(f, across);
  const Eigen::Matrix3d p = first_piola_kirchhoff<3>(solid, embedded);
  if (point.law == ElasticLaw::linear) return 0.5 * (p + p.transpose());
  return cauchy_from_piola(p, embedded);
}

double von_mises(const Eigen::Matrix3d& cauchy) {
  const Eigen::Matrix3d deviator = cauchy - cauchy.trace() / 3 * Eigen::Matrix3d::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

Eigen::Vector3d principal_stresses(const Eigen::Matrix3d& cauchy) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(cauchy, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().reverse();
}

template Eigen::Matrix3d cauchy_stress<2>(const ElasticLawPoint<2>&, const Tensor<2>&);
template Eigen::Matrix3d cauchy_stress<3>(const ElasticLawPoint<3>&, const Tensor<3>&);

}  // namespace sim
