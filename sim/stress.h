// Stress of an elastic particle as it is shown: Cauchy tensor, von Mises and principal values. Pure functions.
#pragma once

#include <Eigen/Core>

#include "sim/elastic_law.h"

namespace sim {

// Cauchy stress sigma = P F^T / J as a full 3x3 tensor, Pa. D = 2: the zz entry is the law's stress across the plane (plane strain) or 0
// (plane stress). The linear law's stress is sigma = lambda tr(eps) I + 2 G eps itself (paper Eq 3).
template <int D>
Eigen::Matrix3d cauchy_stress(const ElasticLawPoint<D>& point, const Tensor<D>& deformation_gradient);

// Same where the first Piola-Kirchhoff stress is known (3x3, with F as 3x3).
Eigen::Matrix3d cauchy_from_piola(const Eigen::Matrix3d& first_piola_kirchhoff, const Eigen::Matrix3d& deformation_gradient);

// sqrt(3/2 s:s) with s the deviator of sigma, Pa, >= 0.
double von_mises(const Eigen::Matrix3d& cauchy);

// Principal stresses, Pa, largest first.
Eigen::Vector3d principal_stresses(const Eigen::Matrix3d& cauchy);

// The D x D deformation gradient within 3 x 3: plane strain (F_zz = 1) or with the given stretch across.
Eigen::Matrix3d embed_deformation(const Eigen::Matrix2d& deformation_gradient, double across = 1);
Eigen::Matrix3d embed_deformation(const Eigen::Matrix3d& deformation_gradient, double across = 1);

}  // namespace sim
