#include "sim/step.h"

#include <cmath>
#include <cstdio>
#include <utility>

#include "sim/density_projection.h"
#include "sim/leaflet_coupling.h"
#include "sim/ledger.h"
#include "sim/number_density.h"
#include "sim/operators.h"
#include "sim/ordering.h"
#include "sim/paper_step.h"
#include "sim/parallel.h"
#include "sim/ports.h"
#include "sim/pressure.h"
#include "sim/shifting.h"
#include "sim/sides.h"
#include "sim/solid_coupling.h"
#include "sim/stage.h"
#include "sim/walls.h"

namespace sim {
namespace {
using Index = std::ptrdiff_t;

// Gravity and the loads on fluid bodies, m/s².
template <int D>
void body_accelerations(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid);
  work.acceleration.assign(state.size(), Vector<D>::Zero());
  if (scene.gravity) add_gravity(*scene.gravity, std::span(work.acceleration).subspan(first));
  for (const auto& load : scene.description.loads) {
    if (!load.acceleration || scene.description.bodies[load.body].kind != Kind::fluid) continue;
    const double factor = load_factor(load, state.time);
    for (std::size_t i = first; i < state.size(); ++i)
      if (state.body[i] == load.body) work.acceleration[i] += factor * load.acceleration(state.position[i], state.time);
  }
}

// v = v + dt (a - grad p / rho); x = x + dt (v_old + v)/2 in a vessel (second order), x = x + dt v where a free surface makes waves (the
// mean velocity would let their amplitude grow by w² dt/4 a second).
template <int D>
void advance_fluid(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt) {
  const Index n = static_cast<Index>(state.size());
#pragma omp parallel for schedule(static)
  for (Index i = scene.first_fluid; i < n; ++i) {
    if (state.kind[i] == Kind::port) {
      state.position[i] += dt * state.velocity[i];
      continue;
    }
    const Vector<D> old = state.velocity[i];
    state.velocity[i] += dt * (work.acceleration[i] - work.pressure_gradient[i] / scene.density[state.body[i]]);
    state.position[i] += scene.pressure->free_surface ? Vector<D>(dt * state.velocity[i]) : Vector<D>(0.5 * dt * (old + state.velocity[i]));
  }
}

template <int D>
void wrap_positions(const Scene<D>& scene, State<D>& state) {
  if (!scene.space.any) return;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i)
    state.position[i] = scene.space.wrapped(state.position[i]);
}

// Throws what went wrong with the step just taken, if anything.
template <int D>
void check_step(const Scene<D>& scene, const State<D>& state, double dt) {
  const double l0 = scene.description.spacing;
  if (dt < 1e-4 * scene.description.scheme.maximum_step && dt < state.last_step)
    throw NumericalFailure("a speed ran away: the step fell below a ten-thousandth of scheme.maximum_step");
  if (state.step > 20 && dt < state.last_step && dt < 1e-4 * state.time / static_cast<double>(state.step))
    throw NumericalFailure("a speed ran away: the step fell below a ten-thousandth of the mean step so far");
  constexpr double farthest = 0.5;  // of l0: blood that moves farther in a step passes neighbours that it never met
  const auto sound = [&](Index i) {
    const double speed = state.velocity[i].norm();
    return std::isfinite(speed) && state.position[i].allFinite() && std::isfinite(state.pressure[i]) &&
           (i < scene.first_fluid || speed * dt < farthest * l0);
  };
  const Index n = static_cast<Index>(state.size());
  Index i = n;  // the first that is not
#pragma omp parallel for schedule(static) reduction(min : i)
  for (Index k = 0; k < n; ++k)
    if (!sound(k)) i = std::min(i, k);
  if (i == n) return;
  char text[240];
  std::snprintf(text, sizeof text, "%s of particle %lld (body '%s') at (%.4g, %.4g, %.4g) m",
                std::isfinite(state.velocity[i].norm()) ? "runaway speed" : "no finite speed", static_cast<long long>(state.id[i]),
                scene.description.bodies[state.body[i]].name.c_str(), state.position[i][0], state.position[i][1],
                D == 3 ? state.position[i][D - 1] : 0.0);
  throw NumericalFailure(text);
}

template <int D>
[[noreturn]] void refuse_energy(double energy) {
  char text[160];
  std::snprintf(text, sizeof text, "the kinetic energy grew by %.3g %s beyond the work done in the step", energy, D == 3 ? "J" : "J/m");
  throw NumericalFailure(text);
}

template <int D>
void viscosity_stage(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt, StepReport& report) {
  if (!scene.viscosity) return;
  const StageClock clock(work.stage_times, Stage::viscosity);
  particle_viscosity(scene, state, work);
  if (scene.viscosity->corrected) add_laplacian_correction(scene, state, work);
  work.boundary_force.assign(static_cast<std::size_t>(scene.elastic_count + scene.shell_count), Vector<D>::Zero());
  report.viscosity_iterations = solve_viscosity<D>(scene, state, work, dt, work.boundary_force).iterations;
  develop_port_profiles(scene, state, work);
}

template <int D>
void pressure_stage(const Scene<D>& scene, State<D>& state, Workspace<D>& work, StepReport& report) {
  const SolveReport solve = solve_pressure(scene, state, work);
  report.pressure_iterations = solve.iterations;
  report.pressure_residual = solve.residual;
  if (!solve.converged && solve.residual > 100 * scene.description.scheme.pressure_tolerance)
    throw NumericalFailure("the pressure equation did not converge");
  state.ledger.pressure_iterations += solve.iterations;
}

template <int D>
std::span<const Vector<D>> shell_rows(const Scene<D>& scene, std::span<const Vector<D>> all) {
  return all.subspan(static_cast<std::size_t>(scene.elastic_count), static_cast<std::size_t>(scene.shell_count));
}

template <int D>
void step_fluid(const Scene<D>& scene, State<D>& state, Workspace<D>& work, std::span<const Vector<D>> from, double dt,
                StepReport& report) {
  StageTimes& clocks = work.stage_times;
  report.elastic_substeps = 0;  // a refused step's do not count
  find_neighborhood(scene, state, work);
  timed(clocks, Stage::ports_and_walls, [&] {
    prescribe_ports<D>(scene, state, dt);
    wall_grip(scene, state, work);
  });
  timed(clocks, Stage::velocity_gradients, [&] {
    velocity_gradients(scene, state, work);
    body_accelerations(scene, state, work);
    add_subparticle_dissipation(scene, state, work, dt);
  });
  viscosity_stage(scene, state, work, dt, report);
  number_unknowns(scene, state, work);
  if (scene.solids) timed(clocks, Stage::elastic, [&] { report.elastic_substeps = predict_solids(scene, state, work, dt); });
  timed(clocks, Stage::pressure_assembly, [&] { pressure_poisson(scene, state, work, dt); });
  if (scene.shells) {
    timed(clocks, Stage::leaflet_coupling, [&] { wetted_sides(scene, state, work); });
    timed(clocks, Stage::elastic, [&] {
      const ShellSubstepReport shells = predict_leaflets(scene, state, work, dt);
      report.elastic_substeps += shells.substeps;
      state.ledger.limiter_hits += shells.limiter_hits;
    });
    const StageClock clock(clocks, Stage::leaflet_coupling);
    couple_leaflets(scene, state, work, dt);
    remember_sides(scene, state, work);
  }
  state.ledger.elastic_substeps += report.elastic_substeps;
  pressure_stage(scene, state, work, report);
  timed(clocks, Stage::pressure_gradient, [&] { pressure_gradients(scene, state, work); });
  if (scene.shells) timed(clocks, Stage::leaflet_coupling, [&] { correct_leaflets(scene, state, work, dt); });
  if (scene.solids) timed(clocks, Stage::elastic, [&] { correct_solids(scene, state, work, dt); });
  timed(clocks, Stage::motion, [&] {
    shifting_displacement(scene, state, work, dt);
    advance_fluid(scene, state, work, dt);
    if (scene.sheet) stick_in_gaps(state, work);
    shift_particles(scene, state, work);
    separate_particles(scene, state, work);
    project_density(scene, state, work);
  });
  if (scene.sheet) timed(clocks, Stage::sides, [&] { keep_sides(scene, state, work); });
  account_fluid<D>(scene, state, work, from, dt);
  if (scene.shells)
    account_shell_loads<D>(scene, state.ledger, work.shell_outer_force, work.boundary_force, shell_rows<D>(scene, from),
                           shell_rows<D>(scene, state.position));
  timed(clocks, Stage::exchange, [&] {
    exchange_through_ports(scene, state, dt);
    remove_escaped(scene, state);
    wrap_positions(scene, state);
  });
}

// Solids and shells alone, under their loads.
template <int D>
void step_dry(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt, StepReport& report) {
  const StageClock clock(work.stage_times, Stage::elastic);
  if (scene.description.scheme.name == Scheme::paper) return step_paper_solids(scene, state, work, dt, report);
  if (scene.solids) {
    report.elastic_substeps = predict_solids(scene, state, work, dt);
    state.ledger.elastic_substeps += report.elastic_substeps;
    std::copy(work.solid_position.begin(), work.solid_position.end(), state.position.begin());
    std::copy(work.solid_velocity.begin(), work.solid_velocity.end(), state.velocity.begin());
  }
  if (!scene.shells) return;
  const ShellSubstepReport shells = predict_leaflets(scene, state, work, dt);
  report.elastic_substeps = shells.substeps;
  state.ledger.elastic_substeps += shells.substeps;
  state.ledger.limiter_hits += shells.limiter_hits;
  account_shell_loads<D>(scene, state.ledger, work.shell_outer_force, {}, shell_rows<D>(scene, state.position), work.shell_position);
  std::copy(work.shell_position.begin(), work.shell_position.end(), state.position.begin() + scene.elastic_count);
  std::copy(work.shell_velocity.begin(), work.shell_velocity.end(), state.velocity.begin() + scene.elastic_count);
}

}  // namespace

namespace {

// Neighbours, weights, density and free surface, before anything hides one particle from another.
template <int D>
void look_around(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const std::size_t n = state.size();
  work.search.resize(n);
  work.is_fluid.resize(n);
#pragma omp parallel for schedule(static)
  for (Index i = 0; i < static_cast<Index>(n); ++i) {
    const bool fluid = state.kind[i] == Kind::fluid || state.kind[i] == Kind::port;
    work.is_fluid[i] = fluid;
    work.search[i] = fluid ? Search::all : state.kind[i] == Kind::wall ? Search::none : Search::fluid_only;
  }
  boundary_surfaces(scene, state, work);
  find_neighbors<D>(work.neighbors, work.grid, state.position, work.search, work.is_fluid, scene.description.domain, scene.lattice.radius);
  link_weights(scene, state, work);
  particle_number_density(scene, state, work);
  find_free_surface(scene, state, work);
}

}  // namespace

template <int D>
void find_neighborhood(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const std::size_t n = state.size();
  timed(work.stage_times, Stage::neighbors, [&] { look_around(scene, state, work); });
  timed(work.stage_times, Stage::sides, [&] {
    if (scene.sheet)
      cut_links(scene, state, work);
    else
      cut_links_through_walls(scene, state, work);
  });
  if (scene.pressure && !scene.pressure->free_surface && (state.step > 0 || !scene.sheet)) work.surface.assign(n, 0);
}

template <int D>
StepReport step(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double until) {
  StepReport report;
  const StepLimit limit = time_step_limit(scene, state, until);
  double dt = limit.step;
  report.limited_by = limit.name;
  constexpr std::int64_t sorting_interval = 32;  // steps; particles pass a cell in some hundred
  if (scene.pressure && state.step % sorting_interval == 0) sort_by_cells(scene, state);
  work.before = state;
  const State<D>& before = work.before;
  for (;;) {
    try {
      move_walls(scene, state, dt);
      if (scene.contact && !work.contact) work.contact = scene.contact;
      if (scene.pressure)
        step_fluid<D>(scene, state, work, before.position, dt, report);
      else
        step_dry(scene, state, work, dt, report);
      check_step(scene, state, dt);
      if (const double energy = runaway_energy(scene, before, state, work); energy > 0) refuse_energy<D>(energy);
      break;
    } catch (const NumericalFailure& failure) {
      state = before;
      ++state.ledger.refused_steps;
      if (++report.refused > 6) {
        char text[400];
        std::snprintf(text, sizeof text,
                      "%s at t = %.6g s, even with a step of %.3g s; lower scheme.cfl or time.step, or check the loads and pressures there",
                      failure.what(), state.time, dt);
        throw NumericalFailure(text);
      }
      dt *= 0.5;
      report.limited_by = "refused step";
    }
  }
  state.ledger.refused_steps = before.ledger.refused_steps + report.refused;
  state.time += dt;
  state.last_step = dt;
  ++state.step;
  report.step = dt;
  return report;
}

template StepReport step(const Scene<2>&, State<2>&, Workspace<2>&, double);
template StepReport step(const Scene<3>&, State<3>&, Workspace<3>&, double);
template void find_neighborhood(const Scene<2>&, const State<2>&, Workspace<2>&);
template void find_neighborhood(const Scene<3>&, const State<3>&, Workspace<3>&);

}  // namespace sim
