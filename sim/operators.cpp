#include "sim/operators.h"

#include <Eigen/Dense>

#include "sim/rheology.h"

namespace sim {
using Index = std::ptrdiff_t;

namespace {

// Whether even the crudest bound on the smallest eigenvalue lies above `floor`.
template <int D>
bool plainly_invertible(const Tensor<D>& moment, double floor) {
  double bound = moment(0, 0) - moment.row(0).cwiseAbs().sum() + std::abs(moment(0, 0));
  for (int a = 1; a < D; ++a) bound = std::min(bound, moment(a, a) + std::abs(moment(a, a)) - moment.row(a).cwiseAbs().sum());
  return bound > floor;
}

}  // namespace

template <int D>
Tensor<D> floored_inverse(const Tensor<D>& moment, double floor) {
  if (plainly_invertible<D>(moment, floor)) return moment.inverse();  // most particles are well surrounded
  Eigen::SelfAdjointEigenSolver<Tensor<D>> solver;
  solver.computeDirect(moment);
  const Vector<D> values = solver.eigenvalues().cwiseMax(floor).cwiseInverse();
  return solver.eigenvectors() * values.asDiagonal() * solver.eigenvectors().transpose();
}

namespace {

// mu/rho of a fluid body at a shear rate, m²/s.
template <int D>
double kinematic_viscosity(const Scene<D>& scene, std::int32_t body, double rate) {
  return viscosity(scene.description.bodies[body].fluid.rheology, rate, scene.description.scheme.viscosity_limit) / scene.density[body];
}

// The jump of velocity from a particle to one of a port. Across a port whose pressure is given blood goes freely: where it met the port's
// mean flow it would seem to pile up there, be pushed out by the pressure of that, and pile up the more.
template <int D>
Padded<D> jump_to_port(const Port<D>& port, const Padded<D>& jump) {
  if (!gives_pressure(port)) return jump;
  const Vector<D> all = jump.template head<D>();
  return pad<D>(Vector<D>(all - all.dot(port.normal) * port.normal));
}

// What is summed over the neighbours of a particle, in one pass: the moments d/n0 w r r^T / |r|² of those with and without a pressure, and
// the velocity's d/n0 w (v_j - v_i) r^T / |r|².
template <int D>
struct LinkSums {
  DyadSum<D> with_pressure, without, jump;
  bool all_with_pressure = true;
};

template <int D>
LinkSums<D> sum_links(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, Index i) {
  LinkSums<D> sums;
  const double factor = scene.lattice.gradient_factor(), least = scene.lattice.closest() * scene.lattice.closest();
  const std::int32_t first_fluid = static_cast<std::int32_t>(scene.first_fluid);
  const Padded<D> here = work.position[i], velocity = work.velocity[i];
  double kinematic = -1;
  for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
    const double w = work.link_weight[k];
    if (w == 0) continue;
    const std::int32_t j = work.neighbors.index[k];
    const Padded<D> r = scene.space.difference(here, work.position[j]);
    const double c = factor * w / std::max(r.squaredNorm(), least);
    const Padded<D> scaled = c * r;
    if (j >= first_fluid) {
      const bool port = state.kind[j] == Kind::port;
      const Padded<D> jump = work.velocity[j] - velocity;
      sums.jump.add(port ? jump_to_port<D>(scene.description.ports[state.port[j]], jump) : jump, scaled);
      if (!port || gives_pressure(scene.description.ports[state.port[j]])) {
        sums.with_pressure.add(r, scaled);
        continue;
      }
    } else {
      const double t = fluid_fraction<D>(scene, work, r.template head<D>(), j);
      const Vector<D> jump =
          resolved_jump<D>(scene, state.body[i], work.boundary_velocity[j] - state.velocity[i], work.boundary_normal[j], kinematic);
      sums.jump.add(pad<D>(jump) / t, scaled);
    }
    sums.without.add(r, scaled);
    sums.all_with_pressure = false;
  }
  return sums;
}

// The weight of the free surface, half a spacing ahead of particle i, as a sample of its pressure, times that distance, 1/m: what balances
// the fluid behind, so that d/n0 sum w r/|r|² over all samples has no part along the outward direction, as inside, and the particle's own
// pressure does not push it. With the weight of the neighbours that are missing there instead, each projection over an uneven arrangement
// makes the shortest waves of a surface grow. 0 away from it.
template <int D>
double surface_sample(const Scene<D>& scene, const Workspace<D>& work, Index i) {
  if (work.surface[i] != 1 || work.surface_outward[i].isZero()) return 0;
  const Padded<D> outward = pad<D>(Vector<D>(work.surface_outward[i].normalized()));
  const double least = scene.lattice.closest() * scene.lattice.closest();
  double behind = 0;
  for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
    const std::int32_t j = work.neighbors.index[k];
    if (work.link_weight[k] == 0 || j < scene.first_fluid) continue;
    const Padded<D> r = scene.space.difference(work.position[i], work.position[j]);
    behind -= work.link_weight[k] / std::max(r.squaredNorm(), least) * r.dot(outward);
  }
  return scene.lattice.gradient_factor() * std::max(behind, 0.0);
}

// The inverse moment matrices of particle i.
template <int D>
void invert_moments(const Scene<D>& scene, Workspace<D>& work, Index i, const LinkSums<D>& sums) {
  constexpr double least_velocity = 0.3, least_pressure = 0.1;
  if (work.number_density[i] < 0.6 || (scene.sheet && work.support[i] < 0.3)) {  // isolated
    work.velocity_inverse[i] = work.pressure_inverse[i] = Tensor<D>::Identity();
    return;
  }
  Tensor<D> fluid = sums.with_pressure.tensor();
  work.velocity_inverse[i] = floored_inverse<D>(fluid + sums.without.tensor(), least_velocity);
  bool same = sums.all_with_pressure && plainly_invertible<D>(fluid, least_velocity);
  if (const double weight = work.surface_sample[i]; weight > 0) {  // the surface is a sample of the pressure (see pressure_gradients)
    const Vector<D> outward = work.surface_outward[i].normalized();
    fluid += weight * 0.5 * scene.lattice.spacing * outward * outward.transpose();
    same = false;
  }
  work.pressure_inverse[i] = same ? work.velocity_inverse[i] : floored_inverse<D>(fluid, least_pressure);
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
  work.velocity_inverse.resize(n), work.pressure_inverse.resize(n);
  work.velocity_gradient.resize(n), work.gradient_columns.resize(n);
  work.surface_sample.resize(n);
  work.velocity.resize(n);
#pragma omp parallel for schedule(static)
  for (Index i = 0; i < n; ++i) work.velocity[i] = pad<D>(state.velocity[i]);
#pragma omp parallel for schedule(dynamic, 256)
  for (Index i = scene.first_fluid; i < n; ++i) {
    const LinkSums<D> sums = sum_links(scene, state, work, i);
    work.surface_sample[i] = surface_sample(scene, work, i);
    invert_moments(scene, work, i, sums);
    work.velocity_gradient[i] = sums.jump.tensor() * work.velocity_inverse[i];
    for (int d = 0; d < D; ++d) work.gradient_columns[i].column[d] = pad<D>(work.velocity_gradient[i].col(d));
  }
}

#define INSTANTIATE(D)                                                                                             \
  template Tensor<D> floored_inverse<D>(const Tensor<D>&, double);                                                 \
  template Vector<D> resolved_jump<D>(const Scene<D>&, std::int32_t, const Vector<D>&, const Vector<D>&, double&); \
  template void velocity_gradients(const Scene<D>&, const State<D>&, Workspace<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
