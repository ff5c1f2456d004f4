#include "sim/shifting.h"

#include <cmath>

#include "sim/time_step.h"

namespace sim {
using Index = std::ptrdiff_t;

namespace {

// Strength of the shift of what rests. In a vessel with leaflets it stays where it is. Below a free surface it needs a little, as much in a
// second however short the steps: what each shift lifts falls again, and waves would grow by it.
template <int D>
double shift_at_rest(const Scene<D>& scene, const State<D>& state, double dt) {
  constexpr double a_little = 0.02;
  if (scene.pressure->free_surface) return a_little * std::min(1.0, dt / unrestricted_step(scene, state));
  return scene.sheet ? 0.0 : a_little;
}

}  // namespace

template <int D>
void shifting_displacement(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt) {
  const Index n = static_cast<Index>(state.size());
  work.displacement.assign(n, Vector<D>::Zero());
  const double l0 = scene.lattice.spacing, strongest = scene.description.scheme.shifting;
  if (!(strongest > 0)) return;
  const double factor = l0 * l0 * scene.lattice.gradient_factor();
  const double radius = scene.lattice.radius, closest = scene.lattice.closest(), per_l0 = 1 / weight(l0, radius, closest);
  const auto first_fluid = static_cast<std::int32_t>(scene.first_fluid);
  const double least = shift_at_rest(scene, state, dt);
  // The strongest shift of particle i. Where blood neither comes nor goes, no leaflet sheds it, viscosity orders it cell by cell (|v| l0/nu
  // below 2) and layers slide on one another (strain and spin alike), half of it keeps particles even; all of it stirs a pipe's blood until
  // it flows 1.9 % too fast. Where strain or spin prevails, particles cluster, and all of it is wanted.
  const bool calm = !scene.sheet && scene.description.ports.empty() && scene.viscosity;
  const auto most = [&](Index i, double speed) {
    if (!calm) return strongest;
    const double cell = scene.density[state.body[i]] * speed * l0 / std::max(work.viscosity[i], 1e-300);  // Reynolds number
    const Tensor<D>& gradient = work.velocity_gradient[i];
    const double strain = (gradient + gradient.transpose()).squaredNorm(), spin = (gradient - gradient.transpose()).squaredNorm();
    const double layered = strain + spin > 0 ? 1 - std::abs(strain - spin) / (strain + spin) : 1.0;
    return strongest * (1 - 0.5 * layered / (1 + std::pow(0.5 * cell, 4)));
  };
#pragma omp parallel for schedule(dynamic, 256)
  for (Index i = scene.first_fluid; i < n; ++i) {
    if (state.kind[i] != Kind::fluid || work.surface[i] == 1) continue;
    const Padded<D> here = work.position[i];
    Padded<D> sum = Padded<D>::Zero(), to_surface = Padded<D>::Zero();
    double fastest = work.velocity[i].squaredNorm();
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const std::int32_t j = work.neighbors.index[k];
      const Padded<D> r = scene.space.difference(here, work.position[j]);
      const double inverse = 1 / std::max(r.norm(), closest);
      const double w = std::max(radius * inverse - 1, 0.0) * (j < first_fluid ? scene.measure[j] : 1.0);  // weight(), kernel.h
      const double q = w * per_l0, q2 = q * q;
      sum += w * (inverse * inverse) * (1 + 0.2 * q2 * q2) * r;
      if (j >= first_fluid) fastest = std::max(fastest, work.velocity[j].squaredNorm());
      if (work.surface[j] == 1) to_surface += w * r;
    }
    Vector<D> outward = to_surface.template head<D>();
    const double speed = std::sqrt(fastest);
    const double strength = std::min(most(i, speed), least + 3 * speed * dt / l0);
    Vector<D> shift = -factor * strength * sum.template head<D>();
    if (work.surface[i] == 2 && outward.squaredNorm() > 0) {
      outward.normalize();
      shift -= shift.dot(outward) * outward;
    }
    const double length = shift.norm();
    if (length > 0.1 * l0) shift *= 0.1 * l0 / length;
    work.displacement[i] = shift;
  }
}

template <int D>
void shift_particles(const Scene<D>& scene, State<D>& state, const Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
#pragma omp parallel for schedule(static)
  for (Index i = scene.first_fluid; i < n; ++i) {
    state.position[i] += work.displacement[i];
    state.velocity[i] += work.velocity_gradient[i] * work.displacement[i];
  }
}

template <int D>
void add_subparticle_dissipation(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt) {
  const Index n = static_cast<Index>(state.size());
  const double filter =
      scene.pressure->free_surface  // 1/s over n0
          ? scene.description.scheme.projection_filter / (std::max(dt, unrestricted_step(scene, state)) * scene.lattice.number_density)
          : 0;
  if (filter == 0 && scene.description.scheme.subparticle_dissipation == 0) return;
  const double factor = scene.lattice.laplacian_factor() * scene.description.scheme.subparticle_dissipation * scene.lattice.spacing;
#pragma omp parallel for schedule(dynamic, 256)
  for (Index i = scene.first_fluid; i < n; ++i) {
    if (state.kind[i] != Kind::fluid) continue;
    Padded<D> sum = Padded<D>::Zero(), filtered = Padded<D>::Zero();
    const DyadSum<D> gradient = work.gradient_columns[i];
    const Padded<D> here = work.position[i], velocity = work.velocity[i];
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const double w = work.link_weight[k];
      const std::int32_t j = work.neighbors.index[k];
      if (w == 0 || j < scene.first_fluid) continue;
      const Padded<D> half = 0.5 * scene.space.difference(here, work.position[j]), jump = work.velocity[j] - velocity;
      const DyadSum<D>& other = work.gradient_columns[j];
      Padded<D> rough = jump;  // what the mean gradient does not explain of the jump
      for (int d = 0; d < D; ++d) rough -= half[d] * (gradient.column[d] + other.column[d]);
      sum += w * jump.norm() * rough;
      if (filter > 0) filtered += w * rough;
    }
    work.acceleration[i] += factor * sum.template head<D>();
    if (filter > 0) work.acceleration[i] += filter * filtered.template head<D>();
  }
}

template <int D>
void separate_particles(const Scene<D>& scene, State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  const double l0 = scene.lattice.spacing;
  work.displacement.assign(n, Vector<D>::Zero());
  work.velocity_old = state.velocity;
  constexpr double certain = 0.1;  // of a spacing: what the surface between curved wall particles is known to
  std::int64_t behind = 0;
  double deepest = 0;
#pragma omp parallel for schedule(dynamic, 256) reduction(+ : behind) reduction(max : deepest)
  for (Index i = scene.first_fluid; i < n; ++i) {
    if (state.kind[i] != Kind::fluid) continue;
    Vector<D> push = Vector<D>::Zero(), slow = Vector<D>::Zero();
    double over_wall = 0, weights = 0;  // height over the wall's surface as a smooth mean over its particles (Kolluri 2005)
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const std::int32_t j = work.neighbors.index[k];
      const Vector<D> r = scene.space.difference(state.position[i], state.position[j]);
      const double square = r.squaredNorm();
      if (square >= (j >= scene.first_fluid ? 0.49 : 1.44) * l0 * l0) continue;  // most are
      const double distance = std::sqrt(square);
      if (j >= scene.first_fluid) {
        if (distance >= 0.7 * l0 || work.link_weight[k] == 0) continue;
        const Vector<D> along =
            distance > 1e-9 * l0 ? Vector<D>(r / distance) : Vector<D>(Vector<D>::Unit(i < j ? 0 : D - 1) * (i < j ? 1.0 : -1.0));
        push -= std::min(0.05 * l0, 0.5 * (0.7 * l0 - distance)) * along;
        const double closing = (work.velocity_old[i] - work.velocity_old[j]).dot(along);
        if (distance < 0.6 * l0 && closing > 0) slow -= 0.5 * closing * along;
      } else if (state.kind[j] != Kind::shell && distance < 1.2 * l0 && work.link_weight[k] != 0) {
        const Vector<D>& normal = work.boundary_normal[j];
        const double height = -r.dot(normal) - scene.description.particles.depth[j];  // above the true surface, locally flat
        const double aside = (r + r.dot(normal) * -normal).norm();
        const double w = std::pow(1 - distance * distance / (1.44 * l0 * l0), 2);
        over_wall += w * height;
        weights += w;
        if (height > 0.25 * l0 || aside > 0.75 * l0) continue;
        const Vector<D> lift = std::min(0.1 * l0, 0.25 * l0 - height) * normal;
        if (lift.squaredNorm() > push.squaredNorm()) push = lift;
        const double closing = (work.boundary_velocity[j] - work.velocity_old[i]).dot(normal);
        if (closing > 0) slow = closing * normal;
      }
    }
    if (over_wall < -certain * l0 * weights) ++behind, deepest = std::max(deepest, -over_wall / weights);
    work.displacement[i] = push;
    state.velocity[i] += slow;
  }
#pragma omp parallel for schedule(static)
  for (Index i = scene.first_fluid; i < n; ++i) state.position[i] += work.displacement[i];
  state.ledger.penetrations += behind;
  state.ledger.deepest_penetration = std::max(state.ledger.deepest_penetration, deepest);
}

#define INSTANTIATE(D)                                                                                \
  template void shifting_displacement(const Scene<D>&, const State<D>&, Workspace<D>&, double);       \
  template void shift_particles(const Scene<D>&, State<D>&, const Workspace<D>&);                     \
  template void add_subparticle_dissipation(const Scene<D>&, const State<D>&, Workspace<D>&, double); \
  template void separate_particles(const Scene<D>&, State<D>&, Workspace<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
