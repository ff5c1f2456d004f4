// Stress recovery of shells at the mid-surface and both faces.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sim/shell_kernel.h"

namespace sim {

using namespace shell_kernel;

namespace {

constexpr double smallest_metric = 0.04;

// Metric at height z above the mid-surface: C - 2 z kappa, eigenvalues kept positive.
SheetTensor metric_at(const SheetTensor& metric, const SheetTensor& curvature, double z) {
  SheetTensor c = metric - curvature * (2 * z);
  const double half = 0.5 * c.trace(), smallest = half - std::sqrt(std::max(0.0, half * half - c.determinant()));
  const double lift = std::max(0.0, smallest_metric - smallest);
  return {c.xx + lift, c.yy + lift, c.xy};
}

Eigen::Matrix2d matrix(const SheetTensor& t) { return (Eigen::Matrix2d() << t.xx, t.xy, t.xy, t.yy).finished(); }

Eigen::Matrix2d square_root(const SheetTensor& c) {
  const double s = std::sqrt(c.determinant());
  return (matrix(c) + s * Eigen::Matrix2d::Identity()) / std::sqrt(c.trace() + 2 * s);
}

// Orthonormal directions into which U maps the rest tangents: [a1 a2] U^-1 (U of the mid-surface), as columns of 3-vectors.
Eigen::Matrix<double, 3, 2> rotated_tangents(const Kinematics<3>& k) {
  Eigen::Matrix<double, 3, 2> a;
  a << k.value[0].head<3>(), k.value[1].head<3>();
  return a * square_root(metric_at(k.metric, {}, 0)).inverse();
}
Eigen::Matrix<double, 3, 2> rotated_tangents(const Kinematics<2>& k) {
  Eigen::Matrix<double, 3, 2> a = Eigen::Matrix<double, 3, 2>::Zero();
  a.col(0).head<2>() = k.value[0].normalized();
  a(2, 1) = 1;
  return a;
}

// sigma = F S F^T / J with F = U in the rotated tangents, J = sqrt(det C) lambda_3.
Eigen::Matrix2d sheet_cauchy(const SheetMaterial& material, SheetTensor c, const Eigen::Vector2d& fibre, double scale) {
  const SheetTensor s = sheet_stress(material, c, fibre);
  if (material.narrow) c.yy = thickness_metric(material, c);
  const double j = std::sqrt(c.determinant() * thickness_metric(material, c));
  if (material.law == ElasticLaw::linear) return matrix(s) * scale;
  const Eigen::Matrix2d u = square_root(c);
  return u * matrix(s) * u * (scale / j);
}

}  // namespace

template <int D>
void shell_stress(const ShellElasticity<D>& shells, std::span<const Vector<D>> position, Face face, std::span<Eigen::Matrix3d> stress) {
  std::vector<Padded<D>> x(shells.size());
  for (std::size_t i = 0; i < shells.size(); ++i) x[i] = pad<D>(position[i]);
  const auto rows = static_cast<std::int32_t>(shells.size());
#pragma omp parallel for schedule(static) if (rows > 200)
  for (std::int32_t i = 0; i < rows; ++i) {
    const Kinematics<D> k = kinematics(shells, x.data(), i);
    const ShellBody& body = shells.bodies[shells.body[i]];
    const double z = face == Face::middle ? 0 : face == Face::plus ? 0.5 * body.bending_thickness : -0.5 * body.bending_thickness;
    const Eigen::Matrix<double, 3, 2> q = rotated_tangents(k);
    // At a clamp the moment is the weighted curvature's (the row shares its cell's bending with the held row).
    stress[i] = q *
                sheet_cauchy(body.material, metric_at(k.metric, k.curvature, z * shells.bending_weight[i]), shells.fibre[i],
                             shells.stiffness_scale[i]) *
                q.transpose();
  }
}

template <int D>
void shell_largest_strain(const ShellElasticity<D>& shells, std::span<const Vector<D>> position, std::span<double> strain, StrainOf where) {
  std::vector<Padded<D>> x(shells.size());
  for (std::size_t i = 0; i < shells.size(); ++i) x[i] = pad<D>(position[i]);
  const auto rows = static_cast<std::int32_t>(shells.size());
#pragma omp parallel for schedule(static) if (rows > 200)
  for (std::int32_t i = 0; i < rows; ++i) {
    const Kinematics<D> k = kinematics(shells, x.data(), i);
    strain[i] = 0;
    const double reach = where == StrainOf::middle ? 0.0 : 0.5 * shells.bodies[shells.body[i]].bending_thickness;
    for (double height : {-reach, reach}) {
      const Eigen::Matrix2d u = square_root(metric_at(k.metric, k.curvature, height));
      const double mean = 0.5 * u.trace(), radius = std::sqrt(std::max(0.0, mean * mean - u.determinant()));
      strain[i] = std::max({strain[i], std::abs(mean + radius - 1), std::abs(mean - radius - 1)});
    }
  }
}

#define CUSP_INSTANTIATE(D)                                                                                               \
  template void shell_stress<D>(const ShellElasticity<D>&, std::span<const Vector<D>>, Face, std::span<Eigen::Matrix3d>); \
  template void shell_largest_strain<D>(const ShellElasticity<D>&, std::span<const Vector<D>>, std::span<double>, StrainOf);
CUSP_INSTANTIATE(2)
CUSP_INSTANTIATE(3)
#undef CUSP_INSTANTIATE

}  // namespace sim
