#include "sim/solid_coupling.h"

#include <cmath>
#include <utility>

#include "sim/operators.h"

namespace sim {
using Index = std::ptrdiff_t;

template <int D>
std::vector<Vector<D>> rest_surface_normals(const InitialParticles<D>& particles, std::int64_t elastic_count, double spacing) {
  std::vector<Vector<D>> normal(elastic_count, Vector<D>::Zero());
  std::vector<Index> faces;
  for (Index b = 0; b < elastic_count; ++b)
    if (particles.surface_area[b].squaredNorm() > 0) faces.push_back(b);
  const double reach = 3.2 * spacing;
#pragma omp parallel for schedule(dynamic, 64)
  for (Index b = 0; b < elastic_count; ++b) {
    if (particles.depth[b] > reach) continue;
    Vector<D> sum = Vector<D>::Zero();
    for (Index f : faces) {
      if (particles.body[f] != particles.body[b]) continue;
      const double r = (particles.position[f] - particles.position[b]).norm();
      if (r < reach) sum += std::pow(spacing / (r + 0.3 * spacing), 3) * particles.surface_area[f];
    }
    if (sum.squaredNorm() > 0) normal[b] = sum.normalized();
  }
  return normal;
}

namespace {

// g_ib of every link between a solid particle and fluid unknowns, gathered per solid row.
template <int D>
void gather_links(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(scene.elastic_count);
  const double factor = scene.fluid_particle_volume * scene.lattice.laplacian_factor();
  work.solid_link_start.assign(n + 1, 0);
  work.solid_links.clear();
  for (Index b = 0; b < n; ++b) {
    for (std::int64_t k = work.neighbors.start[b]; k < work.neighbors.start[b + 1]; ++k) {
      const std::int32_t i = work.neighbors.index[k];
      if (work.link_weight[k] == 0 || state.kind[i] != Kind::fluid || work.unknown[i] < 0) continue;
      const Vector<D> r = scene.space.difference(state.position[i], state.position[b]);
      work.solid_links.push_back({work.unknown[i], factor * work.link_weight[k] * r});
    }
    work.solid_link_start[b + 1] = static_cast<std::int64_t>(work.solid_links.size());
  }
}

template <int D>
void pressure_force(const Workspace<D>& work, std::span<const double> pressure, std::vector<Vector<D>>& force) {
  const Index n = static_cast<Index>(work.solid_link_start.size()) - 1;
  force.assign(n, Vector<D>::Zero());
  for (Index b = 0; b < n; ++b)
    for (std::int64_t k = work.solid_link_start[b]; k < work.solid_link_start[b + 1]; ++k)
      force[b] += pressure[work.solid_links[k].unknown] * work.solid_links[k].area;
}

// Gravity and the loads on the fluid at row i, m/s².
template <int D>
Vector<D> body_acceleration(const Scene<D>& scene, const State<D>& state, Index i) {
  Vector<D> sum = scene.gravity ? scene.gravity->acceleration : Vector<D>(Vector<D>::Zero());
  for (const auto& load : scene.description.loads)
    if (load.acceleration && load.body == state.body[i])
      sum += load_factor(load, state.time) * load.acceleration(state.position[i], state.time);
  return sum;
}

// A link pushes with the pressure of its fluid particle, which lies off the surface: what the body forces add on the way to it, rho g . r
// (half a spacing of water over a plate), acts besides. Without it a floating body rides half a spacing too high.
template <int D>
void add_weight_before_surface(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, std::vector<Vector<D>>& force) {
  const double factor = scene.fluid_particle_volume * scene.lattice.laplacian_factor();
  for (std::int32_t b = 0; b < static_cast<std::int32_t>(scene.elastic_count); ++b)
    for (std::int64_t k = work.neighbors.start[b]; k < work.neighbors.start[b + 1]; ++k) {
      const std::int32_t i = work.neighbors.index[k];
      if (work.link_weight[k] == 0 || state.kind[i] != Kind::fluid || work.unknown[i] < 0) continue;
      const Vector<D> r = scene.space.difference(state.position[i], state.position[b]);
      const double added = scene.density[state.body[i]] * fluid_fraction(scene, work, r, b) * r.dot(body_acceleration(scene, state, i));
      force[b] += factor * work.link_weight[k] * added * r;
    }
}

}  // namespace

template <int D>
std::int64_t predict_solids(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt) {
  const SolidElasticity<D>& solids = *scene.solids;
  const Index n = static_cast<Index>(scene.elastic_count);
  work.solid_position.assign(state.position.begin(), state.position.begin() + n);
  work.solid_velocity.assign(state.velocity.begin(), state.velocity.begin() + n);
  std::vector<Vector<D>> external(state.fluid_force.begin(), state.fluid_force.begin() + n), mean(n);
  if (!work.boundary_force.empty())
    for (Index b = 0; b < n; ++b) external[b] += work.boundary_force[b];
  if (scene.pressure) add_weight_before_surface(scene, state, work, external);
  SolidStepInput<D> input;
  input.time = state.time, input.duration = dt;
  input.external_force = external;
  input.loads = scene.description.loads;
  if (scene.gravity) input.gravity = scene.gravity->acceleration;
  input.substep_factor = scene.description.scheme.elastic_substep;
  const SolidStepReport report = advance_solids<D>(solids, input, work.solid_motion, work.solid_position, work.solid_velocity, mean);
  state.ledger.load_work += report.load_work;
  state.ledger.viscous_loss += report.damping_loss;
  if (!scene.pressure) return report.substeps;
  if (std::abs(work.solid_factor_step - dt) > 0.05 * dt || ++work.solid_factor_age > 20) {
    work.solid_operator.factorise(solids, std::span(state.position).first(n), dt * dt);
    work.solid_factor_step = dt;
    work.solid_factor_age = 0;
  }
  gather_links(scene, state, work);
  std::vector<Vector<D>> answer(n);
  work.solid_operator.solve(std::span(std::as_const(state.fluid_force)).first(n), answer);
  for (Index b = 0; b < n; ++b) work.acceleration[b] = (work.solid_velocity[b] - state.velocity[b]) / dt - answer[b];
  return report.substeps;
}

template <int D>
void apply_solid_coupling(const Scene<D>& scene, const State<D>&, Workspace<D>& work, std::span<const double> x, std::span<double> y) {
  std::vector<Vector<D>> force, answer(scene.elastic_count);
  pressure_force<D>(work, x, force);
  work.solid_operator.solve(force, answer);
  for (Index b = 0; b < static_cast<Index>(scene.elastic_count); ++b)
    for (std::int64_t k = work.solid_link_start[b]; k < work.solid_link_start[b + 1]; ++k)
      y[work.solid_links[k].unknown] += work.solid_links[k].area.dot(answer[b]);
}

template <int D>
void correct_solids(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt) {
  const Index n = static_cast<Index>(scene.elastic_count);
  std::vector<Vector<D>> force, change(n), answer(n);
  std::vector<double> pressure(work.solution.size());
  for (std::size_t u = 0; u < pressure.size(); ++u) pressure[u] = state.pressure[work.unknown_row[u]];
  pressure_force<D>(work, pressure, force);
  for (Index b = 0; b < n; ++b) change[b] = force[b] - state.fluid_force[b];
  work.solid_operator.solve(change, answer);
  for (Index b = 0; b < n; ++b) {
    const Vector<D> v = work.solid_velocity[b] + dt * answer[b];
    state.position[b] = work.solid_position[b] + dt * (v - work.solid_velocity[b]);
    state.fluid_acceleration[b] = (v - state.velocity[b]) / dt;
    state.velocity[b] = v;
    state.fluid_force[b] = force[b];
  }
}

#define INSTANTIATE(D)                                                                                                             \
  template std::vector<Vector<D>> rest_surface_normals(const InitialParticles<D>&, std::int64_t, double);                          \
  template std::int64_t predict_solids(const Scene<D>&, State<D>&, Workspace<D>&, double);                                         \
  template void apply_solid_coupling(const Scene<D>&, const State<D>&, Workspace<D>&, std::span<const double>, std::span<double>); \
  template void correct_solids(const Scene<D>&, State<D>&, Workspace<D>&, double);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
