#include "sim/solid_stress.h"

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>
#include <string>

#include "sim/solid_cell.h"
#include "sim/stress.h"

namespace sim {

namespace {

// Weights a_j of a linear least-squares fit through a row's neighbourhood (itself first, then its links) for the value at an offset; links
// to clamp points and held rows have none.
template <int D>
std::vector<double> linear_weights(const SolidElasticity<D>& solid, std::size_t i, const Vector<D>& offset) {
  constexpr int size = D + 1;
  const SolidFit& fit = solid.fits[solid.fit_begin[i]];
  using Row = Eigen::Matrix<double, size, 1>;
  const auto row_of = [&](const Vector<D>& r) {
    Row row;
    row << 1, r / solid.spacing;
    return row;
  };
  const auto weight_of = [&](std::int64_t l) {
    const std::int32_t j = solid.neighbor[l];
    return j < 0 || solid.fit_begin[j] == solid.fit_begin[j + 1] ? 0.0 : solid.weight[l];
  };
  Eigen::Matrix<double, size, size> moment = Eigen::Matrix<double, size, size>::Zero();
  const double own = 2;  // the particle itself counts like two near neighbours
  moment(0, 0) = own;
  for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l)
    moment += weight_of(l) * row_of(solid.offset[l]) * row_of(solid.offset[l]).transpose();
  const Row coefficients = moment.completeOrthogonalDecomposition().solve(row_of(offset));
  std::vector<double> weights{own * coefficients(0)};
  for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l)
    weights.push_back(weight_of(l) * coefficients.dot(row_of(solid.offset[l])));
  return weights;
}

template <int D>
double smoothed(const SolidElasticity<D>& solid, std::size_t i, const std::vector<double>& field) {
  const std::vector<double> weights = linear_weights<D>(solid, i, Vector<D>::Zero());
  const SolidFit& fit = solid.fits[solid.fit_begin[i]];
  double value = weights[0] * field[i];
  for (std::int64_t l = 0; l < fit.count; ++l)
    if (const std::int32_t j = solid.neighbor[fit.first + l]; j >= 0) value += weights[l + 1] * field[j];
  return value;
}

// sigma with the volumetric strain of the term (lambda - lambda_h) theta replaced by a given one.
template <int D>
Eigen::Matrix3d stress_with(const ElasticLawPoint<D>& law, const Tensor<D>& f, double theta) {
  if (law.plane_stress) return cauchy_stress<D>(law, f);
  ElasticLawPoint<D> soft = law;
  soft.moduli.lame_lambda = plane_stress_lambda(law.moduli);
  const Eigen::Matrix3d embedded = embed_deformation(f);
  const Eigen::Matrix3d p = (law.moduli.lame_lambda - soft.moduli.lame_lambda) * theta * volumetric_strain_gradient<3>(law.law, embedded);
  return cauchy_stress<D>(soft, f) + (law.law == ElasticLaw::linear ? p : cauchy_from_piola(p, embedded));
}

// Two layers cannot show how the strain across the sheet varies through it: that part is such that it makes no stress across. The stress
// lambda_h (theta - mean) n n^T is what it takes away (numerics-elastic.md 3(ii), stress recovery of two layers).
template <int D>
Eigen::Matrix3d unresolved_across(const SolidElasticity<D>& solid, std::size_t i, const Tensor<D>& f, double deviation) {
  const ElasticLawPoint<D>& law = solid.law[i];
  const bool linear = law.law == ElasticLaw::linear;
  const Vector<D> rest_normal = (solid.rest[solid.partner[i]] - solid.rest[i]).normalized();
  const Vector<D> turned = linear ? rest_normal : Vector<D>(cofactor<D>(f) * rest_normal);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  normal.head<D>() = turned.normalized();
  return plane_stress_lambda(law.moduli) * deviation / (linear ? 1 : std::max(f.determinant(), 1e-3)) * normal * normal.transpose();
}

}  // namespace

template <int D>
void solid_stress(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, SolidWork<D>& work,
                  std::vector<Eigen::Matrix3d>& cauchy) {
  const auto n = static_cast<std::int64_t>(solid.size());
  solid_derivatives<D>(solid, position, work);
  cauchy.assign(n, Eigen::Matrix3d::Zero());
  std::vector<double> theta(n, 0);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) theta[i] = volumetric_strain<D>(solid.law[i].law, deformation_gradient<D>(work.derivatives[i]));
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    if (solid.fit_begin[i] == solid.fit_begin[i + 1]) continue;
    const Tensor<D> f = deformation_gradient<D>(work.derivatives[i]);
    const bool shared = shares_volume(solid, i);
    const double used = shared ? (theta[i] + theta[solid.partner[i]]) / 2 : smoothed<D>(solid, i, theta);
    cauchy[i] = stress_with<D>(solid.law[i], f, used);
    if (shared) cauchy[i] -= unresolved_across<D>(solid, i, f, theta[i] - used);
  }
}

template <int D>
SolidPoint<D> locate_in_solid(const SolidElasticity<D>& solid, std::int32_t body, const Vector<D>& rest_point) {
  SolidPoint<D> point;
  double nearest = 1e300, nearest_held = 1e300;
  for (std::size_t i = 0; i < solid.size(); ++i) {
    if (body >= 0 && solid.body[i] != body) continue;
    const double distance = (rest_point - solid.rest[i]).squaredNorm();
    if (solid.fit_begin[i] == solid.fit_begin[i + 1]) {
      nearest_held = std::min(nearest_held, distance);
    } else if (distance < nearest) {
      nearest = distance;
      point.row = static_cast<std::int32_t>(i);
      point.offset = rest_point - solid.rest[i];
    }
  }
  if (nearest == 1e300 && nearest_held == 1e300) throw std::invalid_argument("no elastic particle of body " + std::to_string(body));
  point.held = nearest_held < nearest * (1 - 1e-9);
  if (nearest > 4 * solid.spacing * solid.spacing && point.held) point.row = -1;
  return point;
}

template <int D>
Vector<D> displacement_at(const SolidElasticity<D>& solid, const SolidPoint<D>& point, std::span<const Vector<D>> position,
                          const SolidWork<D>& work) {
  if (point.row < 0 || point.held) return Vector<D>::Zero();
  return position[point.row] - solid.rest[point.row] + work.derivatives[point.row] * monomials<D>(point.offset);
}

template <int D>
Vector<D> interpolate_at(const SolidElasticity<D>& solid, const SolidPoint<D>& point, std::span<const Vector<D>> field) {
  if (point.row < 0 || point.held) return Vector<D>::Zero();
  const FitRow<D> m = monomials<D>(point.offset);
  Vector<D> value = field[point.row];
  for (std::int64_t f = solid.fit_begin[point.row]; f < solid.fit_begin[point.row + 1]; ++f)
    for (std::int64_t l = solid.fits[f].first; l < solid.fits[f].first + solid.fits[f].count; ++l) {
      const std::int32_t j = solid.neighbor[l];
      const Vector<D> difference = j < 0 ? Vector<D>(-field[point.row]) : Vector<D>(field[j] - field[point.row]);
      for (int k = 0; k < D; ++k)
        if (solid.fits[f].components >> k & 1) value(k) += m.dot(solid.shape[l]) * difference(k);
    }
  return value;
}

template <int D>
Eigen::Matrix3d stress_at(const SolidElasticity<D>& solid, const SolidPoint<D>& point, std::span<const Eigen::Matrix3d> cauchy) {
  if (point.row < 0) return Eigen::Matrix3d::Zero();
  const std::vector<double> weights = linear_weights<D>(solid, point.row, point.offset);
  const SolidFit& fit = solid.fits[solid.fit_begin[point.row]];
  Eigen::Matrix3d value = weights[0] * cauchy[point.row];
  for (std::int64_t l = 0; l < fit.count; ++l)
    if (const std::int32_t j = solid.neighbor[fit.first + l]; j >= 0) value += weights[l + 1] * cauchy[j];
  return value;
}

#define SIM_INSTANTIATE(D)                                                                                                                 \
  template void solid_stress<D>(const SolidElasticity<D>&, std::span<const Vector<D>>, SolidWork<D>&, std::vector<Eigen::Matrix3d>&);      \
  template SolidPoint<D> locate_in_solid<D>(const SolidElasticity<D>&, std::int32_t, const Vector<D>&);                                    \
  template Vector<D> displacement_at<D>(const SolidElasticity<D>&, const SolidPoint<D>&, std::span<const Vector<D>>, const SolidWork<D>&); \
  template Vector<D> interpolate_at<D>(const SolidElasticity<D>&, const SolidPoint<D>&, std::span<const Vector<D>>);                       \
  template Eigen::Matrix3d stress_at<D>(const SolidElasticity<D>&, const SolidPoint<D>&, std::span<const Eigen::Matrix3d>);
SIM_INSTANTIATE(2)
SIM_INSTANTIATE(3)
#undef SIM_INSTANTIATE

}  // namespace sim
