#include "sim/operators.h"

#include <Eigen/Dense>

#include "sim/rheology.h"

namespace sim {
using Index = std::ptrdiff_t;

template <int D>
Tensor<D> floored_inverse(const Tensor<D>& moment, double floor) {
  // Most particles are well surrounded: the plain inverse serves when even the crudest bound on the smallest eigenvalue is met.
  double bound = moment(0, 0) - moment.row(0).cwiseAbs().sum() + std::abs(moment(0, 0));
  for (int a = 1; a < D; ++a) bound = std::min(bound, moment(a, a) + std::abs(moment(a, a)) - moment.row(a).cwiseAbs().sum());
  if (bound > floor) return moment.inverse();
  Eigen::SelfAdjointEigenSolver<Tensor<D>> solver;
  solver.computeDirect(moment);
  const Vector<D> values = solver.eigenvalues().cwiseMax(floor).cwiseInverse();
  return solver.eigenvectors() * values.asDiagonal() * solver.eigenvectors().transpose();
}

template <int D>
void moment_matrices(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  work.velocity_inverse.resize(n);
  work.pressure_inverse.resize(n);
  const double factor = scene.lattice.gradient_factor();
  const double least = scene.lattice.closest() * scene.lattice.closest();
#pragma omp parallel for schedule(dynamic, 256)
  for (Index i = scene.first_fluid; i < n; ++i) {
    DyadSum<D> with_pressure, all;
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const double w = work.link_weight[k];
      if (w == 0) continue;
      const std::int32_t j = work.neighbors.index[k];
      const Padded<D> r = scene.space.difference(work.position[i], work.position[j]);
      const double c = factor * w / std::max(r.squaredNorm(), least);
      const bool port = j >= scene.first_fluid && state.kind[j] == Kind::port;
      const bool has_pressure = j >= scene.first_fluid && (!port || gives_pressure(scene.description.ports[state.port[j]]));
      all.add(c * r, r);
      with_pressure.add((has_pressure ? c : 0.0) * r, r);
    }
    Tensor<D> fluid = with_pressure.tensor();
    const bool isolated = work.number_density[i] < 0.6 || (scene.sheet && work.support[i] < 0.3);
    work.velocity_inverse[i] = isolated ? Tensor<D>::Identity().eval() : floored_inverse<D>(all.tensor(), 0.3);
    if (work.surface[i] == 1) {  // the surface, half a spacing ahead, is a sample of the pressure (see pressure_gradients)
      const double ahead = work.surface_outward[i].norm();
      const double missing = scene.lattice.number_density * std::max(1 - work.number_density[i], 0.0);
      if (ahead > 0) fluid += 0.25 * factor * missing / (ahead * ahead) * work.surface_outward[i] * work.surface_outward[i].transpose();
    }
    work.pressure_inverse[i] = isolated ? Tensor<D>::Identity().eval() : floored_inverse<D>(fluid, 0.1);
  }
}

namespace {

// mu/rho of a fluid body at a shear rate, m²/s.
template <int D>
double kinematic_viscosity(const Scene<D>& scene, std::int32_t body, double rate) {
  return viscosity(scene.description.bodies[body].fluid.rheology, rate, scene.description.scheme.viscosity_limit) / scene.density[body];
}

}  // namespace

template <int D>
Vector<D> resolved_jump(const Scene<D>& scene, std::int32_t body, const Vector<D>& jump, const Vector<D>& normal, double& kinematic) {
  constexpr double resolved_cell = 20;  // -, cell Reynolds number up to which a boundary layer of one spacing is resolved
  const double l0 = scene.description.spacing;
  const Vector<D> slip = jump - jump.dot(normal) * normal;
  const double speed = slip.norm(), cell = speed * l0;
  if (kinematic < 0) kinematic = kinematic_viscosity(scene, body, speed / l0);
  return cell > resolved_cell * kinematic ? Vector<D>(jump - (1 - resolved_cell * kinematic / cell) * slip) : jump;
}

template <int D>
void velocity_gradients(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  work.velocity_gradient.resize(n);
  const double factor = scene.lattice.gradient_factor();
  const double least = scene.lattice.closest() * scene.lattice.closest();
  work.velocity.resize(n);
  work.gradient_columns.resize(n);
#pragma omp parallel for schedule(static)
  for (Index i = 0; i < n; ++i) work.velocity[i] = pad<D>(state.velocity[i]);
#pragma omp parallel for schedule(dynamic, 256)
  for (Index i = scene.first_fluid; i < n; ++i) {
    DyadSum<D> sum;
    double kinematic = -1;  // asked for only beside a boundary
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const double w = work.link_weight[k];
      if (w == 0) continue;
      const std::int32_t j = work.neighbors.index[k];
      const Padded<D> r = scene.space.difference(work.position[i], work.position[j]);
      const double c = factor * w / std::max(r.squaredNorm(), least);
      if (j >= scene.first_fluid) {
        sum.add(c * (work.velocity[j] - work.velocity[i]), r);
      } else {
        const double t = fluid_fraction<D>(scene, work, r.template head<D>(), j);
        const Vector<D> jump =
            resolved_jump<D>(scene, state.body[i], work.boundary_velocity[j] - state.velocity[i], work.boundary_normal[j], kinematic);
        sum.add(pad<D>(c / t * jump), r);
      }
    }
    work.velocity_gradient[i] = sum.tensor() * work.velocity_inverse[i];
    for (int d = 0; d < D; ++d) work.gradient_columns[i].column[d] = pad<D>(work.velocity_gradient[i].col(d));
  }
}

#define INSTANTIATE(D)                                                                                             \
  template Tensor<D> floored_inverse<D>(const Tensor<D>&, double);                                                 \
  template void moment_matrices(const Scene<D>&, const State<D>&, Workspace<D>&);                                  \
  template Vector<D> resolved_jump<D>(const Scene<D>&, std::int32_t, const Vector<D>&, const Vector<D>&, double&); \
  template void velocity_gradients(const Scene<D>&, const State<D>&, Workspace<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
