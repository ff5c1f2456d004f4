#include "sim/paper_elasticity.h"

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>

#include "sim/solid_neighbors.h"

namespace sim {

namespace {

// Eq (14) in the continuous form r_e / r - 1.
double weight_of(double distance, double radius) { return distance > 0 && distance < radius ? radius / distance - 1 : 0; }

// n0 and Lambda of the full lattice, Eqs (15) and (19).
template <int D>
void lattice_constants(PaperElasticity<D>& e) {
  const int reach = static_cast<int>(std::ceil(e.radius / e.spacing));
  double sum = 0, second = 0;
  const int width = 2 * reach + 1;
  for (int cell = 0; cell < static_cast<int>(std::pow(width, D) + 0.5); ++cell) {
    double squared = 0;
    for (int k = 0, rest = cell; k < D; ++k, rest /= width) squared += std::pow(rest % width - reach, 2);
    const double distance = e.spacing * std::sqrt(squared), w = weight_of(distance, e.radius);
    sum += w;
    second += w * distance * distance;
  }
  e.full_density = sum;
  e.laplacian_lambda = second / sum;
}

template <int D>
void link_rows(PaperElasticity<D>& e, const std::vector<std::int32_t>& body) {
  const NeighborTable near = points_within<D>(e.rest, e.rest, e.radius);
  e.begin.assign(1, 0);
  for (std::size_t i = 0; i < e.size(); ++i) {
    for (const std::int32_t j : near.of(i)) {
      if (static_cast<std::size_t>(j) == i || body[j] != body[i]) continue;
      e.neighbor.push_back(j);
      e.offset.push_back(e.rest[j] - e.rest[i]);
      e.weight.push_back(weight_of(e.offset.back().norm(), e.radius));
    }
    e.begin.push_back(static_cast<std::int64_t>(e.neighbor.size()));
  }
}

// F of a row; where the rest neighbours lie in one plane (or line) the missing direction follows its normal.
template <int D>
Tensor<D> fitted_deformation(const PaperElasticity<D>& e, std::span<const Vector<D>> position, std::size_t i) {
  Tensor<D> moment = Tensor<D>::Zero(), mixed = Tensor<D>::Zero();
  for (std::int64_t p = e.begin[i]; p < e.begin[i + 1]; ++p) {
    moment += e.weight[p] * e.offset[p] * e.offset[p].transpose();
    mixed += e.weight[p] * (position[e.neighbor[p]] - position[i]) * e.offset[p].transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Tensor<D>> axes(moment);
  const Vector<D> values = axes.eigenvalues();
  if (values(0) > 1e-6 * values(D - 1)) return mixed * moment.inverse();
  if (D == 3 && !(values(1) > 1e-6 * values(2))) return Tensor<D>::Identity();  // a thread: no rotation defined
  if (!(values(D - 1) > 0)) return Tensor<D>::Identity();
  Tensor<D> inverse = Tensor<D>::Zero();
  for (int k = 1; k < D; ++k) inverse += axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose() / values(k);
  const Tensor<D> in_plane = mixed * inverse;
  const Vector<D> normal = axes.eigenvectors().col(0);
  Vector<D> turned;
  if constexpr (D == 3) {
    const Vector<D> t1 = axes.eigenvectors().col(1), t2 = axes.eigenvectors().col(2);
    const double hand = t1.cross(t2).dot(normal) > 0 ? 1 : -1;
    turned = hand * (in_plane * t1).cross(in_plane * t2).normalized();
  } else {
    const Vector<D> t = axes.eigenvectors().col(1), a = in_plane * t;
    const double hand = t(0) * normal(1) - t(1) * normal(0) > 0 ? 1 : -1;
    turned = hand * Vector<D>(-a(1), a(0)).normalized();
  }
  return in_plane + turned * normal.transpose();
}

// u_ij = r_ij - (R_i + R_j) r0_ij / 2  (Eq 24)
template <int D>
Vector<D> pair_displacement(const PaperElasticity<D>& e, std::span<const Vector<D>> position, std::span<const Tensor<D>> rotation,
                            std::size_t i, std::int64_t p) {
  const std::int32_t j = e.neighbor[p];
  return position[j] - position[i] - 0.5 * (rotation[i] + rotation[j]) * e.offset[p];
}

// A_B and A_L: the coefficients of Eqs (21) and (22) within Eq (23). A pair of different materials takes their mean.
template <int D>
std::pair<double, double> coefficients(const PaperElasticity<D>& e, std::size_t i, std::size_t j) {
  const double lambda = (e.moduli[i].lame_lambda + e.moduli[j].lame_lambda) / 2;
  const double g = (e.moduli[i].shear_modulus + e.moduli[j].shear_modulus) / 2;
  return {2 * D * (lambda + g) / e.full_density, 2 * D * g / (e.laplacian_lambda * e.full_density)};
}

// [rho/dt^2 I + K] of one outer iteration, with frozen directions.
template <int D>
struct FrozenOperator {
  const PaperElasticity<D>& e;
  double step;
  std::vector<Tensor<D>> pair, diagonal, inverse;

  FrozenOperator(const PaperElasticity<D>& elasticity, std::span<const Vector<D>> position, double dt) : e(elasticity), step(dt) {
    pair.resize(e.neighbor.size());
    diagonal.resize(e.size());
    inverse.resize(e.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(e.size()); ++i) {
      diagonal[i] = e.density[i] / (step * step) * Tensor<D>::Identity();
      for (std::int64_t p = e.begin[i]; p < e.begin[i + 1]; ++p) {
        const auto [bulk, shear] = coefficients(e, i, e.neighbor[p]);
        const Vector<D> n = (position[e.neighbor[p]] - position[i]).normalized();
        pair[p] = e.weight[p] * (bulk / e.offset[p].squaredNorm() * n * n.transpose() + shear * Tensor<D>::Identity());
        diagonal[i] += pair[p];
      }
      for (int k = 0; k < D; ++k)
        if (e.fixed[i] >> k & 1) {
          diagonal[i].row(k).setZero();
          diagonal[i].col(k).setZero();
          diagonal[i](k, k) = 1;
        }
      inverse[i] = diagonal[i].inverse();
    }
  }

  void apply(const std::vector<Vector<D>>& x, std::vector<Vector<D>>& y) const {
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(e.size()); ++i) {
      y[i] = diagonal[i] * x[i];
      for (std::int64_t p = e.begin[i]; p < e.begin[i + 1]; ++p) y[i] -= pair[p] * x[e.neighbor[p]];
      hold(i, y[i]);
    }
  }
  void hold(std::size_t i, Vector<D>& v) const {
    for (int k = 0; k < D; ++k)
      if (e.fixed[i] >> k & 1) v(k) = 0;
  }
};

template <int D>
double dot(const std::vector<Vector<D>>& a, const std::vector<Vector<D>>& b) {
  double sum = 0;  // in row order: the same for any number of threads
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

// Conjugate gradients with block Jacobi, to a relative residual of 1e-4 (numerics-elastic.md 3(i)). Returns the iterations.
template <int D>
int solve(const FrozenOperator<D>& op, std::vector<Vector<D>> residual, std::vector<Vector<D>>& x) {
  const std::size_t n = residual.size();
  x.assign(n, Vector<D>::Zero());
  std::vector<Vector<D>> z(n), direction, image(n);
  const auto precondition = [&] {
    for (std::size_t i = 0; i < n; ++i) z[i] = op.inverse[i] * residual[i];
  };
  precondition();
  direction = z;
  double rz = dot<D>(residual, z);
  const double start = dot<D>(residual, residual);
  for (int iteration = 0; iteration < 2000; ++iteration) {
    if (!(dot<D>(residual, residual) > 1e-8 * start)) return iteration;
    op.apply(direction, image);
    const double alpha = rz / dot<D>(direction, image);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += alpha * direction[i];
      residual[i] -= alpha * image[i];
    }
    precondition();
    const double next = dot<D>(residual, z);
    for (std::size_t i = 0; i < n; ++i) direction[i] = z[i] + next / rz * direction[i];
    rz = next;
  }
  return 2000;
}

}  // namespace

template <int D>
PaperElasticity<D> build_paper_elasticity(const SceneDescription<D>& scene) {
  PaperElasticity<D> e;
  const auto& particles = scene.particles;
  e.spacing = scene.spacing;
  e.radius = scene.scheme.elastic_kernel_radius * scene.spacing;
  std::vector<std::int32_t> body;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (particles.kind[i] != Kind::elastic && particles.kind[i] != Kind::shell) break;
    const ElasticMaterial& material = scene.bodies[particles.body[i]].elastic;
    const double scale = i < particles.stiffness_scale.size() ? particles.stiffness_scale[i] : 1;
    e.rest.push_back(particles.position[i]);
    e.density.push_back(material.density);
    e.moduli.push_back(lame_moduli(scale * material.youngs_modulus, material.poisson_ratio));
    e.fixed.push_back(i < particles.fixed.size() ? particles.fixed[i] : 0);
    body.push_back(particles.body[i]);
  }
  if (e.rest.empty()) return e;
  lattice_constants(e);
  link_rows(e, body);
  return e;
}

template <int D>
void paper_rotations(const PaperElasticity<D>& e, std::span<const Vector<D>> position, std::span<Tensor<D>> rotation) {
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(e.size()); ++i)
    rotation[i] = polar_rotation<D>(fitted_deformation<D>(e, position, i));
}

template <int D>
void paper_elastic_force(const PaperElasticity<D>& e, std::span<const Vector<D>> position, std::span<const Tensor<D>> rotation,
                         std::span<Vector<D>> force) {
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(e.size()); ++i) {
    force[i].setZero();
    for (std::int64_t p = e.begin[i]; p < e.begin[i + 1]; ++p) {
      const auto [bulk, shear] = coefficients(e, i, e.neighbor[p]);
      const Vector<D> u = pair_displacement<D>(e, position, rotation, i, p);
      const Vector<D> n = (position[e.neighbor[p]] - position[i]).normalized();
      force[i] += e.weight[p] * (bulk / e.offset[p].squaredNorm() * n * n.dot(u) + shear * u);
    }
  }
}

template <int D>
PaperStepReport paper_elastic_step(const PaperElasticity<D>& e, std::span<const Vector<D>> external, double step, int outer_limit,
                                   std::span<Vector<D>> position, std::span<Vector<D>> velocity) {
  PaperStepReport report;
  const std::size_t n = e.size();
  const std::vector<Vector<D>> before(position.begin(), position.begin() + static_cast<std::ptrdiff_t>(n));
  std::vector<Tensor<D>> rotation(n);
  std::vector<Vector<D>> rhs(n), change;
  for (int outer = 0; outer < outer_limit && !report.converged; ++outer) {
    paper_rotations<D>(e, position, rotation);
    paper_elastic_force<D>(e, position, rotation, rhs);
    const FrozenOperator<D> op(e, position, step);
    for (std::size_t i = 0; i < n; ++i) {
      // 2 d^t - d^(t-1) - d = step v^t - (x - x^t)
      rhs[i] += e.density[i] / (step * step) * (step * velocity[i] - (position[i] - before[i]));
      if (!external.empty()) rhs[i] += external[i];
      op.hold(i, rhs[i]);
    }
    report.inner_iterations += solve<D>(op, rhs, change);
    report.change = 0;
    for (std::size_t i = 0; i < n; ++i) {
      position[i] += change[i];
      report.change = std::max(report.change, change[i].template lpNorm<Eigen::Infinity>());
    }
    ++report.outer_iterations;
    report.converged = report.change < 1e-6 * e.spacing;
    if (!std::isfinite(report.change)) break;
  }
  for (std::size_t i = 0; i < n; ++i) velocity[i] = (position[i] - before[i]) / step;
  return report;
}

template <int D>
void paper_stress(const PaperElasticity<D>& e, std::span<const Vector<D>> position, std::vector<Eigen::Matrix3d>& cauchy) {
  std::vector<Tensor<D>> rotation(e.size());
  paper_rotations<D>(e, position, rotation);
  cauchy.assign(e.size(), Eigen::Matrix3d::Zero());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(e.size()); ++i) {
    Tensor<D> gradient = Tensor<D>::Zero();  // Eq (16)
    for (std::int64_t p = e.begin[i]; p < e.begin[i + 1]; ++p) {
      const Vector<D> u = rotation[i].transpose() * pair_displacement<D>(e, position, rotation, i, p);
      gradient += D / e.full_density * e.weight[p] / e.offset[p].squaredNorm() * u * e.offset[p].transpose();
    }
    const Tensor<D> strain = 0.5 * (gradient + gradient.transpose());  // Eq (4)
    const double lambda = e.moduli[i].lame_lambda, g = e.moduli[i].shear_modulus;
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity(), local = lambda * strain.trace() * Eigen::Matrix3d::Identity();
    local.topLeftCorner<D, D>() += 2 * g * strain;  // Eq (3); in 2-D plane strain, zz included
    turn.topLeftCorner<D, D>() = rotation[i];
    cauchy[i] = turn * local * turn.transpose();
  }
}

LameModuli paper_effective_moduli(const LameModuli& m, int dimension) {
  // (21) is (lap u + 2 grad div u)/(d + 2), (22) with (24) is (lap u + grad div u)/2.
  const double bulk = 1.0 / (dimension + 2);
  const double g = (m.lame_lambda + m.shear_modulus) * bulk + m.shear_modulus / 2;
  const double sum = 2 * bulk * (m.lame_lambda + m.shear_modulus) + m.shear_modulus / 2;  // lambda_eff + G_eff
  return {sum - g, g};
}

#define SIM_INSTANTIATE(D)                                                                                                                 \
  template PaperElasticity<D> build_paper_elasticity<D>(const SceneDescription<D>&);                                                       \
  template void paper_rotations<D>(const PaperElasticity<D>&, std::span<const Vector<D>>, std::span<Tensor<D>>);                           \
  template void paper_elastic_force<D>(const PaperElasticity<D>&, std::span<const Vector<D>>, std::span<const Tensor<D>>,                  \
                                       std::span<Vector<D>>);                                                                              \
  template PaperStepReport paper_elastic_step<D>(const PaperElasticity<D>&, std::span<const Vector<D>>, double, int, std::span<Vector<D>>, \
                                                 std::span<Vector<D>>);                                                                    \
  template void paper_stress<D>(const PaperElasticity<D>&, std::span<const Vector<D>>, std::vector<Eigen::Matrix3d>&);
SIM_INSTANTIATE(2)
SIM_INSTANTIATE(3)
#undef SIM_INSTANTIATE

}  // namespace sim
