#include "sim/viscosity.h"

#include "sim/operators.h"
#include "sim/quadratic_fit.h"

namespace sim {
using Index = std::ptrdiff_t;

namespace {

double pair_viscosity(double a, double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; }

// Viscosity between fluid particle i and the surface before boundary particle j, a part t of the way r: where it depends on the shear
// rate, at the mean rate |slip| / height of the layer between them, which is not the particle's own (beside a wall blood thins steeply).
template <int D>
double wall_viscosity(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, Index i, std::int32_t j, const Vector<D>& r,
                      double t) {
  if (!scene.viscosity->shear_dependent) return work.viscosity[i];
  const Vector<D>& normal = work.boundary_normal[j];
  const Vector<D> jump = state.velocity[i] - work.boundary_velocity[j];
  const double height = t * std::max(std::abs(r.dot(normal)), 0.5 * r.norm());
  const double rate = (jump - jump.dot(normal) * normal).norm() / height;
  return viscosity(scene.description.bodies[state.body[i]].fluid.rheology, rate, scene.description.scheme.viscosity_limit);
}

// Viscosity between fluid rows i and j, of link k.
template <int D>
double fluid_viscosity(const Workspace<D>& work, Index i, std::int32_t j, std::int64_t k) {
  return work.pair_viscosity.empty() ? pair_viscosity(work.viscosity[i], work.viscosity[j]) : work.pair_viscosity[k];
}

// Flux coefficient of the link i-j, number k: mu 2d/(lambda n0) w, times 1/fraction where the no-slip surface lies before the boundary
// particle.
template <int D>
double link_coefficient(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, Index i, std::int32_t j, std::int64_t k,
                        const Vector<D>& r) {
  const double factor = scene.lattice.laplacian_factor() * work.link_weight[k];
  if (j >= scene.first_fluid) return factor * fluid_viscosity(work, i, j, k);
  const double t = fluid_fraction(scene, work, r, j);
  const double grip = work.grip.empty() || state.kind[j] != Kind::wall ? 1.0 : work.grip[i];
  return grip * factor * wall_viscosity(scene, state, work, i, j, r, t) / t;
}

}  // namespace

template <int D>
void particle_viscosity(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  work.viscosity.assign(n, 0);
  const double limit = scene.description.scheme.viscosity_limit;
#pragma omp parallel for schedule(static)
  for (Index i = scene.first_fluid; i < n; ++i)
    work.viscosity[i] = viscosity(scene.description.bodies[state.body[i]].fluid.rheology, shear_rate<D>(work.velocity_gradient[i]), limit);
  work.pair_viscosity.clear();
  if (!scene.viscosity->shear_dependent || !scene.viscosity->corrected) return;
  work.pair_viscosity.resize(work.neighbors.index.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (Index i = scene.first_fluid; i < n; ++i) {
    const double own = shear_rate<D>(work.velocity_gradient[i]);
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const std::int32_t j = work.neighbors.index[k];
      if (j < scene.first_fluid || work.link_weight[k] == 0) continue;
      const double rate = 0.5 * (own + shear_rate<D>(work.velocity_gradient[j]));
      const auto at_rate = [&](Index row) { return viscosity(scene.description.bodies[state.body[row]].fluid.rheology, rate, limit); };
      work.pair_viscosity[k] = state.body[i] == state.body[j] ? at_rate(i) : pair_viscosity(at_rate(i), at_rate(j));
    }
  }
}

template <int D>
void add_laplacian_correction(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  const double l0 = scene.lattice.spacing;
#pragma omp parallel for schedule(dynamic, 128)
  for (Index i = scene.first_fluid; i < n; ++i) {
    if (state.kind[i] != Kind::fluid || work.surface[i] != 0 || work.number_density[i] < 0.8) continue;
    const std::int64_t first = work.neighbors.start[i], last = work.neighbors.start[i + 1];
    auto sample = [&](std::int32_t j, Vector<D>& r) {
      r = scene.space.difference(state.position[i], state.position[j]);
      return j >= scene.first_fluid ? 1.0 : fluid_fraction(scene, work, r, j);
    };
    LaplacianFit<D> fit;
    Vector<D> r;
    for (std::int64_t k = first; k < last; ++k) {
      if (work.link_weight[k] == 0) continue;
      const double t = sample(work.neighbors.index[k], r);
      fit.add(t / l0 * r, work.link_weight[k]);
    }
    if (!fit.solve()) continue;  // keep the MPS Laplacian
    Vector<D> sum = Vector<D>::Zero();
    for (std::int64_t k = first; k < last; ++k) {
      const double w = work.link_weight[k];
      if (w == 0) continue;
      const std::int32_t j = work.neighbors.index[k];
      const double t = sample(j, r);
      const double consistent = fit.weight(t / l0 * r, w) / (l0 * l0);
      const bool fluid = j >= scene.first_fluid;
      const double mu = fluid ? fluid_viscosity(work, i, j, k) : wall_viscosity(scene, state, work, i, j, r, t);
      const Vector<D> jump = (fluid ? state.velocity[j] : work.boundary_velocity[j]) - state.velocity[i];
      sum += (mu * consistent - link_coefficient<D>(scene, state, work, i, j, k, r)) * jump;
    }
    work.acceleration[i] += sum / scene.density[state.body[i]];
  }
}

template <int D>
SolveReport solve_viscosity(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt,
                            std::span<Vector<D>> boundary_force) {
  const Index n = static_cast<Index>(state.size()), first = scene.first_fluid;
  SymmetricMatrix& a = work.viscous_matrix;
  const Index rows = n - first;
  a.diagonal.resize(rows);
  a.start.resize(rows + 1);
  for (Index i = first; i <= n; ++i) a.start[i - first] = work.neighbors.start[i] - work.neighbors.start[first];
  a.column.resize(a.start[rows]);
  a.value.resize(a.start[rows]);
  std::vector<Vector<D>>&b = work.viscous_source, &x = work.viscous_solution;
  b.resize(rows), x.resize(rows);
  // Port rows keep their velocity: identity rows. Boundary links are known values: they move to the right-hand side (column = own row, 0).
#pragma omp parallel for schedule(dynamic, 256)
  for (Index i = first; i < n; ++i) {
    const double rho = scene.density[state.body[i]];
    double diagonal = rho / dt;
    Vector<D> source = rho / dt * state.velocity[i] + rho * work.acceleration[i];
    const bool given = state.kind[i] == Kind::port;
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const std::int32_t j = work.neighbors.index[k];
      const std::int64_t e = k - work.neighbors.start[first];
      const double w = work.link_weight[k];
      a.column[e] = static_cast<std::int32_t>(i - first);
      a.value[e] = 0;
      if (w == 0 || given) continue;
      const Vector<D> r = scene.space.difference(state.position[i], state.position[j]);
      const double c = link_coefficient<D>(scene, state, work, i, j, k, r);
      diagonal += c;
      if (j < first)
        source += c * work.boundary_velocity[j];
      else if (state.kind[j] == Kind::port)
        source += c * state.velocity[j];
      else
        a.column[e] = static_cast<std::int32_t>(j - first), a.value[e] = -c;
    }
    if (given) source = diagonal * state.velocity[i];
    a.diagonal[i - first] = diagonal;
    b[i - first] = source;
    x[i - first] = state.velocity[i] + dt * work.acceleration[i];
  }
  const SolveReport report = conjugate_gradient<D>(a, b, x, 1e-8, 400, work.viscous_scratch);
#pragma omp parallel for schedule(static)
  for (Index i = first; i < n; ++i) {
    if (state.kind[i] != Kind::fluid) continue;
    work.acceleration[i] = (x[i - first] - state.velocity[i]) / dt;
  }
  if (!boundary_force.empty()) {
    const Index solids = static_cast<Index>(boundary_force.size());
#pragma omp parallel for schedule(dynamic, 64)
    for (Index s = 0; s < solids; ++s) {
      // The drag is taken as if the particle gave way within the step: with stiff blood the plain one would throw it back and forth.
      const double mass = s < scene.elastic_count ? scene.solids->mass[s] : scene.shells->mass[s - scene.elastic_count];
      Vector<D> drag = Vector<D>::Zero();
      double coefficient = 0;
      for (std::int64_t k = work.neighbors.start[s]; k < work.neighbors.start[s + 1]; ++k) {
        const std::int32_t i = work.neighbors.index[k];
        const double w = work.link_weight[k];
        if (w == 0 || state.kind[i] != Kind::fluid) continue;
        const Vector<D> r = scene.space.difference(state.position[i], state.position[s]);
        const double c = scene.fluid_particle_volume * link_coefficient<D>(scene, state, work, i, static_cast<std::int32_t>(s), k, r);
        drag += c * (state.velocity[i] + dt * work.acceleration[i] - work.boundary_velocity[s]);
        coefficient += c;
      }
      boundary_force[s] += drag / (1 + dt * coefficient / mass);
    }
  }
  return report;
}

#define INSTANTIATE(D)                                                                     \
  template void particle_viscosity(const Scene<D>&, const State<D>&, Workspace<D>&);       \
  template void add_laplacian_correction(const Scene<D>&, const State<D>&, Workspace<D>&); \
  template SolveReport solve_viscosity(const Scene<D>&, const State<D>&, Workspace<D>&, double, std::span<Vector<D>>);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
