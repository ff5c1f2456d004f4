#include "sim/viscosity.h"

#include <algorithm>

#include "sim/operators.h"
#include "sim/quadratic_fit.h"

namespace sim {
using Index = std::ptrdiff_t;

namespace {

double pair_viscosity(double a, double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; }

// Shear rate between fluid particle i and the surface before boundary particle j, a part t of the way r: the mean rate |slip| / height of
// the layer between them, which is not the particle's own (beside a wall blood thins steeply).
template <int D>
double wall_shear_rate(const State<D>& state, const Workspace<D>& work, Index i, std::int32_t j, const Vector<D>& r, double t) {
  const Vector<D>& normal = work.boundary_normal[j];
  const Vector<D> jump = state.velocity[i] - work.boundary_velocity[j];
  const double height = t * std::max(std::abs(r.dot(normal)), 0.5 * r.norm());
  return (jump - jump.dot(normal) * normal).norm() / height;
}

// Flux coefficient of a link over its viscosity, 2d/(lambda n0) w, times 1/fraction where the no-slip surface lies before the boundary
// particle.
template <int D>
double wall_coefficient(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, Index i, std::int32_t j, double t,
                        double w) {
  const double grip = work.grip.empty() || state.kind[j] != Kind::wall ? 1.0 : work.grip[i];
  return grip * scene.lattice.laplacian_factor() * w / t;
}

// Viscosity between fluid particle i and the surface before boundary particle j, where it depends on the shear rate at that of the layer.
template <int D>
double wall_viscosity(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, Index i, std::int32_t j, const Vector<D>& r,
                      double t) {
  if (!scene.viscosity->shear_dependent) return work.viscosity[i];
  return viscosity(scene.description.bodies[state.body[i]].fluid.rheology, wall_shear_rate(state, work, i, j, r, t),
                   scene.description.scheme.viscosity_limit);
}

// Links between fluid and boundary particles, of which the viscosities are found many at a time.
template <int D>
struct WallLinks {
  struct Link {
    Index fluid;
    std::int32_t boundary;
    double coefficient;  // complete after finish()
  };
  std::vector<Link> links;
  std::vector<double> viscosity;

  void clear() { links.clear(), viscosity.clear(); }
  void add(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, Index i, std::int32_t j, const Vector<D>& r, double w) {
    const double t = fluid_fraction(scene, work, r, j);
    links.push_back({i, j, wall_coefficient(scene, state, work, i, j, t, w)});
    viscosity.push_back(scene.viscosity->shear_dependent ? wall_shear_rate(state, work, i, j, r, t) : work.viscosity[i]);
  }
  // The coefficients mu 2d/(lambda n0) w / fraction.
  void finish(const Scene<D>& scene, const State<D>& state) {
    const auto body = [&](std::size_t k) { return state.body[links[k].fluid]; };
    for (std::size_t first = 0, last; scene.viscosity->shear_dependent && first < links.size(); first = last) {
      for (last = first + 1; last < links.size() && body(last) == body(first);) ++last;
      viscosities(scene.description.bodies[body(first)].fluid.rheology, std::span(viscosity).subspan(first, last - first),
                  scene.description.scheme.viscosity_limit);
    }
    for (std::size_t k = 0; k < links.size(); ++k) links[k].coefficient *= viscosity[k];
  }
};

// Viscosity between fluid rows i and j, of link k.
template <int D>
double fluid_viscosity(const Workspace<D>& work, Index i, std::int32_t j, std::int64_t k) {
  return work.pair_viscosity.empty() ? pair_viscosity(work.viscosity[i], work.viscosity[j]) : work.pair_viscosity[k];
}

}  // namespace

namespace {

// pair_viscosity of fluid row i's links: at the mean of both ends' shear rates, which is that of the link's middle.
template <int D>
void link_viscosities(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, std::span<const double> shear_rates, Index i) {
  const double limit = scene.description.scheme.viscosity_limit, own = shear_rates[i];
  const std::int64_t first = work.neighbors.start[i], last = work.neighbors.start[i + 1];
  const auto rheology = [&](Index row) -> const auto& { return scene.description.bodies[state.body[row]].fluid.rheology; };
  const auto rate = [&](std::int32_t j) { return j < scene.first_fluid ? own : 0.5 * (own + shear_rates[j]); };
  for (std::int64_t k = first; k < last; ++k) work.pair_viscosity[k] = rate(work.neighbors.index[k]);
  viscosities(rheology(i), std::span(work.pair_viscosity).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first)),
              limit);
  for (std::int64_t k = first; k < last; ++k) {
    const std::int32_t j = work.neighbors.index[k];
    if (j >= scene.first_fluid && state.body[j] != state.body[i])
      work.pair_viscosity[k] = pair_viscosity(work.pair_viscosity[k], viscosity(rheology(j), rate(j), limit));
  }
}

}  // namespace

template <int D>
void particle_viscosity(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  work.viscosity.assign(n, 0);
  const double limit = scene.description.scheme.viscosity_limit;
  constexpr Index part = 512;  // rows of one body that are looked at together
#pragma omp parallel for schedule(static)
  for (Index begin = scene.first_fluid; begin < n; begin += part)
    for (Index first = begin, last; first < std::min(n, begin + part); first = last) {
      for (last = first; last < std::min(n, begin + part) && state.body[last] == state.body[first]; ++last)
        work.viscosity[last] = shear_rate<D>(work.velocity_gradient[last]);
      viscosities(scene.description.bodies[state.body[first]].fluid.rheology,
                  std::span(work.viscosity).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first)), limit);
    }
  work.pair_viscosity.clear();
  if (!scene.viscosity->shear_dependent || !scene.viscosity->corrected) return;
  work.pair_viscosity.resize(work.neighbors.index.size());
  std::vector<double> shear_rates(n, 0);
#pragma omp parallel for schedule(static)
  for (Index i = scene.first_fluid; i < n; ++i) shear_rates[i] = shear_rate<D>(work.velocity_gradient[i]);
#pragma omp parallel for schedule(dynamic, 256)
  for (Index i = scene.first_fluid; i < n; ++i) link_viscosities<D>(scene, state, work, shear_rates, i);
}

template <int D>
void add_laplacian_correction(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  const double l0 = scene.lattice.spacing;
  // Cell Reynolds number from which no layer that viscosity makes is seen, however well it is summed: it grows to 3 % of l0 while the flow
  // passes a cell.
  constexpr double unresolved = 1e3;
#pragma omp parallel for schedule(dynamic, 128)
  for (Index i = scene.first_fluid; i < n; ++i) {
    if (state.kind[i] != Kind::fluid || work.surface[i] != 0 || work.number_density[i] < 0.8) continue;
    if (scene.density[state.body[i]] * state.velocity[i].norm() * l0 > unresolved * work.viscosity[i]) continue;
    const std::int64_t first = work.neighbors.start[i], last = work.neighbors.start[i + 1];
    // The way to the neighbour, and the part of it at whose end its velocity holds.
    const auto sample = [&](std::int32_t j, Vector<D>& r) {
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
      const double plain = fluid ? scene.lattice.laplacian_factor() * w : wall_coefficient(scene, state, work, i, j, t, w);
      const Vector<D> jump = (fluid ? state.velocity[j] : work.boundary_velocity[j]) - state.velocity[i];
      sum += mu * (consistent - plain) * jump;
    }
    work.acceleration[i] += sum / scene.density[state.body[i]];
  }
}

namespace {

// The rows of (rho/dt + viscosity) v = rho/dt v^n + rho a, one a fluid or port row; the guess in viscous_solution.
template <int D>
void assemble_viscosity(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt) {
  const Index n = static_cast<Index>(state.size()), first = scene.first_fluid;
  SymmetricMatrix& a = work.viscous_matrix;
  const Index rows = n - first;
  a.diagonal.resize(rows);
  a.start.resize(rows + 1);
  for (Index i = first; i <= n; ++i) a.start[i - first] = work.neighbors.start[i] - work.neighbors.start[first];
  a.column.resize(a.start[rows]);
  a.value.resize(a.start[rows]);
  work.viscous_source.resize(rows), work.viscous_solution.resize(rows);
  const double factor = scene.lattice.laplacian_factor();
  const std::int64_t first_link = work.neighbors.start[first];
  const auto given = [&](Index i) {
    return state.kind[i] == Kind::port && !gives_pressure(scene.description.ports[static_cast<std::size_t>(state.port[i])]);
  };
  // Rows of ports whose speed is given keep it: identity rows. Boundary links are known values: they move to the right-hand side (column =
  // own row, 0).
#pragma omp parallel
  {
    WallLinks<D> walls;
#pragma omp for schedule(dynamic, 256)
    for (Index i = first; i < n; ++i) {
      const double rho = scene.density[state.body[i]];
      double diagonal = rho / dt;
      Vector<D> source = rho / dt * state.velocity[i] + rho * work.acceleration[i];
      const bool known = given(i);
      walls.clear();
      for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
        const std::int32_t j = work.neighbors.index[k];
        const std::int64_t e = k - first_link;
        const double w = work.link_weight[k];
        a.column[e] = static_cast<std::int32_t>(i - first);
        a.value[e] = 0;
        if (w == 0 || known) continue;
        if (j < first) {
          walls.add(scene, state, work, i, j, scene.space.difference(state.position[i], state.position[j]), w);
          continue;
        }
        const double c = factor * w * fluid_viscosity(work, i, j, k);
        diagonal += c;
        if (given(j))
          source += c * state.velocity[j];
        else
          a.column[e] = static_cast<std::int32_t>(j - first), a.value[e] = -c;
      }
      walls.finish(scene, state);
      for (const auto& link : walls.links) {
        diagonal += link.coefficient;
        source += link.coefficient * work.boundary_velocity[link.boundary];
      }
      if (known) source = diagonal * state.velocity[i];
      a.diagonal[i - first] = diagonal;
      work.viscous_source[i - first] = source;
      work.viscous_solution[i - first] = state.velocity[i] + dt * work.acceleration[i];
    }
  }
}

// Adds the blood's drag on solids and shells, N. It is taken as if the particle gave way within the step: with stiff blood the plain one
// would throw it back and forth.
template <int D>
void add_drag(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, double dt, std::span<Vector<D>> boundary_force) {
  const Index solids = static_cast<Index>(boundary_force.size());
#pragma omp parallel
  {
    WallLinks<D> walls;
#pragma omp for schedule(dynamic, 64)
    for (Index s = 0; s < solids; ++s) {
      const double mass = s < scene.elastic_count ? scene.solids->mass[s] : scene.shells->mass[s - scene.elastic_count];
      walls.clear();
      for (std::int64_t k = work.neighbors.start[s]; k < work.neighbors.start[s + 1]; ++k) {
        const std::int32_t i = work.neighbors.index[k];
        const double w = work.link_weight[k];
        if (w == 0 || state.kind[i] != Kind::fluid) continue;
        const Vector<D> r = scene.space.difference(state.position[i], state.position[s]);
        walls.add(scene, state, work, i, static_cast<std::int32_t>(s), r, w);
      }
      walls.finish(scene, state);
      Vector<D> drag = Vector<D>::Zero();
      double coefficient = 0;
      for (const auto& link : walls.links) {
        const double c = scene.fluid_particle_volume * link.coefficient;
        drag += c * (state.velocity[link.fluid] + dt * work.acceleration[link.fluid] - work.boundary_velocity[s]);
        coefficient += c;
      }
      boundary_force[s] += drag / (1 + dt * coefficient / mass);
    }
  }
}

}  // namespace

template <int D>
SolveReport solve_viscosity(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt,
                            std::span<Vector<D>> boundary_force) {
  const Index n = static_cast<Index>(state.size()), first = scene.first_fluid;
  assemble_viscosity(scene, state, work, dt);
  std::vector<Vector<D>>& x = work.viscous_solution;
  const SolveReport report = conjugate_gradient<D>(work.viscous_matrix, work.viscous_source, x, 1e-8, 400, work.viscous_scratch);
#pragma omp parallel for schedule(static)
  for (Index i = first; i < n; ++i) {
    if (state.kind[i] != Kind::fluid) continue;
    work.acceleration[i] = (x[i - first] - state.velocity[i]) / dt;
  }
  if (!boundary_force.empty()) add_drag(scene, state, work, dt, boundary_force);
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
