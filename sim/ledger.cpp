#include "sim/ledger.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sim/operators.h"
#include "sim/parallel.h"
#include "sim/rheology.h"
#include "sim/step.h"

namespace sim {

template <int D>
void account_fluid(const Scene<D>& scene, State<D>& state, const Workspace<D>& work, std::span<const Vector<D>> from, double dt) {
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid), count = state.size() - first;
  const auto fluid = [&](std::size_t k) { return state.kind[first + k] == Kind::fluid; };
  if (scene.viscosity)
    state.ledger.viscous_loss += dt * scene.fluid_particle_volume * ordered_sum(count, [&](std::size_t k) {
                                   if (!fluid(k)) return 0.0;
                                   const double rate = shear_rate<D>(work.velocity_gradient[first + k]);
                                   return work.viscosity[first + k] * rate * rate;
                                 });
  const auto mass = [&](std::size_t k) { return scene.density[state.body[first + k]] * scene.fluid_particle_volume; };
  const auto way = [&](std::size_t k) { return Vector<D>(state.position[first + k] - from[first + k]); };
  if (scene.gravity) {
    const Vector<D>& gravity = scene.gravity->acceleration;
    state.ledger.load_work += ordered_sum(count, [&](std::size_t k) { return fluid(k) ? mass(k) * gravity.dot(way(k)) : 0.0; });
    if (scene.solids)  // beyond the way that predict_solids counted
      for (std::size_t b = 0; b < static_cast<std::size_t>(scene.elastic_count); ++b)
        state.ledger.load_work += scene.solids->mass[b] * gravity.dot(state.position[b] - work.solid_position[b]);
  }
  for (const auto& load : scene.description.loads) {
    if (!load.acceleration || scene.description.bodies[load.body].kind != Kind::fluid) continue;
    double sum = 0;  // formulas are evaluated one after the other
    for (std::size_t k = 0; k < count; ++k)
      if (fluid(k) && state.body[first + k] == load.body) sum += mass(k) * load.acceleration(from[first + k], state.time).dot(way(k));
    state.ledger.load_work += load_factor(load, state.time) * sum;
  }
}

template <int D>
void account_shell_loads(const Scene<D>& scene, Ledger& ledger, std::span<const Vector<D>> outer, std::span<const Vector<D>> drag,
                         std::span<const Vector<D>> from, std::span<const Vector<D>> to) {
  double work = 0;
  for (std::size_t s = 0; s < outer.size(); ++s) {
    const Vector<D> load = drag.empty() ? outer[s] : Vector<D>(outer[s] - drag[static_cast<std::size_t>(scene.elastic_count) + s]);
    work += load.dot(to[s] - from[s]);
  }
  ledger.load_work += work;
}

namespace {

template <int D>
double fluid_kinetic_energy(const Scene<D>& scene, const State<D>& state) {
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid);
  return 0.5 * scene.fluid_particle_volume * ordered_sum(state.size() - first, [&](std::size_t k) {
           if (state.kind[first + k] != Kind::fluid) return 0.0;
           return scene.density[state.body[first + k]] * state.velocity[first + k].squaredNorm();
         });
}

// A leaflet particle stands in the place of a whole lattice cell but is only as thick as its material; the blood that the cell holds beside
// it has no particle of its own and moves along the leaflet's normal with it.
template <int D>
double solid_kinetic_energy(const Scene<D>& scene, const State<D>& state) {
  const std::size_t solids = static_cast<std::size_t>(scene.elastic_count), shells = static_cast<std::size_t>(scene.shell_count);
  double energy = 0, blood_density = 0;
  for (std::size_t b = 0; b < solids; ++b) energy += 0.5 * scene.solids->mass[b] * state.velocity[b].squaredNorm();
  if (!scene.shells) return energy;
  for (const auto& body : scene.description.bodies)
    if (body.kind == Kind::fluid) blood_density = std::max(blood_density, body.fluid.density);
  std::vector<Vector<D>> normal(shells);
  std::vector<double> area(shells);
  shell_normals_and_areas<D>(*scene.shells, std::span(state.position).subspan(solids, shells), normal, area);
  for (std::size_t s = 0; s < shells; ++s) {
    const Vector<D>& velocity = state.velocity[solids + s];
    const double thickness = scene.shells->bodies[scene.shells->body[s]].thickness, along = velocity.dot(normal[s]);
    const double blood = blood_density * area[s] * std::max(scene.lattice.spacing - thickness, 0.0);
    energy += 0.5 * (scene.shells->mass[s] * velocity.squaredNorm() + blood * along * along);
  }
  return energy;
}

template <int D>
double elastic_energy(const Scene<D>& scene, const State<D>& state, Workspace<D>& scratch) {
  const std::size_t solids = static_cast<std::size_t>(scene.elastic_count), shells = static_cast<std::size_t>(scene.shell_count);
  double energy = 0;
  if (scene.solids) energy += solid_energy<D>(*scene.solids, std::span(state.position).first(solids), scratch.solid_motion.work);
  if (scene.shells) energy += shell_energy<D>(*scene.shells, std::span(state.position).subspan(solids, shells));
  return energy;
}

template <int D>
double density_error(const Scene<D>& scene, const State<D>& state, Workspace<D>& scratch) {
  find_neighborhood(scene, state, scratch);
  double sum = 0, count = 0;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) {
    if (state.kind[i] != Kind::fluid || scratch.surface[i] != 0) continue;
    bool beside_port = false;
    for (std::int32_t j : scratch.neighbors.of(i)) beside_port = beside_port || state.kind[j] == Kind::port;
    if (beside_port) continue;
    const double error = scratch.number_density[i] - 1;
    sum += error * error;
    count += 1;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

template <int D>
void measure_ledger(const Scene<D>& scene, State<D>& state, Workspace<D>& scratch) {
  Ledger& ledger = state.ledger;
  ledger.kinetic_energy = fluid_kinetic_energy(scene, state) + solid_kinetic_energy(scene, state);
  ledger.elastic_energy = elastic_energy(scene, state, scratch);
  if (!scene.pressure) return;
  ledger.density_error = density_error(scene, state, scratch);
  std::int64_t balance = ledger.particles_in - ledger.particles_out;
  for (Kind kind : scene.description.particles.kind) balance += kind == Kind::fluid;
  for (Kind kind : state.kind) balance -= kind == Kind::fluid;
  ledger.particles_lost = std::abs(balance);
}

template <int D>
double runaway_energy(const Scene<D>& scene, const State<D>& before, const State<D>& after, Workspace<D>& scratch) {
  constexpr double share = 0.5, calm = 0.1;  // of the kinetic energy before; m/s
  const auto& ports = scene.description.ports;
  const bool complete = std::all_of(ports.begin(), ports.end(), [](const Port<D>& port) { return gives_pressure(port); });
  if (!scene.pressure || !complete || !scene.description.motions.empty() || scene.description.scheme.name == Scheme::paper) return 0;
  const auto kinetic = [&](const State<D>& state) { return fluid_kinetic_energy(scene, state) + solid_kinetic_energy(scene, state); };
  const auto work = [](const Ledger& ledger) { return ledger.port_work + ledger.load_work; };
  double heaviest = 0;
  for (const auto& body : scene.description.bodies)
    if (body.kind == Kind::fluid) heaviest = std::max(heaviest, body.fluid.density);
  const double blood = static_cast<double>(std::count(before.kind.begin(), before.kind.end(), Kind::fluid));
  const double rest = 0.5 * heaviest * scene.fluid_particle_volume * blood * calm * calm, had = kinetic(before);
  const double beyond = kinetic(after) - had - std::max(0.0, work(after.ledger) - work(before.ledger)) - share * std::max(had, rest) - rest;
  if (beyond <= 0) return 0;
  return std::max(0.0, beyond - std::max(0.0, elastic_energy(scene, before, scratch) - elastic_energy(scene, after, scratch)));
}

template <int D>
std::vector<std::string> over_limits(const Scene<D>& scene, const State<D>& state) {
  std::vector<std::string> lines;
  const Limits& limits = scene.description.limits;
  const Ledger& ledger = state.ledger;
  const auto check = [&](const char* what, const char* key, double value, double limit, const char* units) {
    if (value <= limit) return;
    char text[200];
    std::snprintf(text, sizeof text, "ledger: %s %.4g%s is over %s = %.4g", what, value, units, key, limit);
    lines.emplace_back(text);
  };
  check("particles lost", "limits.lost", static_cast<double>(ledger.particles_lost), static_cast<double>(limits.lost), "");
  check("deepest penetration", "limits.penetration", ledger.deepest_penetration / scene.description.spacing, limits.penetration, " l0");
  check("rms error of the density", "limits.density_error", ledger.density_error, limits.density_error, "");
  return lines;
}

#define INSTANTIATE(D)                                                                                                \
  template void account_fluid(const Scene<D>&, State<D>&, const Workspace<D>&, std::span<const Vector<D>>, double);   \
  template void account_shell_loads(const Scene<D>&, Ledger&, std::span<const Vector<D>>, std::span<const Vector<D>>, \
                                    std::span<const Vector<D>>, std::span<const Vector<D>>);                          \
  template void measure_ledger(const Scene<D>&, State<D>&, Workspace<D>&);                                            \
  template double runaway_energy(const Scene<D>&, const State<D>&, const State<D>&, Workspace<D>&);                   \
  template std::vector<std::string> over_limits(const Scene<D>&, const State<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
