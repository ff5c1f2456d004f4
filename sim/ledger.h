// The books of a run (State::ledger): what comes in, goes out and is lost, energies and the work done, and what is over a limit. Energies
// are in J, in 2-D in J per metre of depth.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// Adds what the step just taken in the fluid did, before rows are exchanged: viscous_loss += dt sum V mu (shear rate)^2 over fluid, and
// load_work += sum m a . (x - from) with a of gravity and of the loads on fluid bodies, and the whole way of the particle: who is lifted
// by whatever means has taken that work. Solids' loads: predict_solids, and here gravity over what they moved since; shells':
// account_shell_loads. `from`: all rows' places at the step's start, m.
template <int D>
void account_fluid(const Scene<D>& scene, State<D>& state, const Workspace<D>& work, std::span<const Vector<D>> from, double dt);

// load_work += sum F . (to - from) over shells, F of loads and gravity. `outer`: with the blood's drag, N; `drag`: that drag by row, or
// empty; places in m, by shell row.
template <int D>
void account_shell_loads(const Scene<D>& scene, Ledger& ledger, std::span<const Vector<D>> outer, std::span<const Vector<D>> drag,
                         std::span<const Vector<D>> from, std::span<const Vector<D>> to);

// What is measured once an output: kinetic_energy and elastic_energy now, density_error = rms of n/n0 - 1 over fluid with neither a free
// surface nor an open end near, and particles_lost = |fluid at the start + in - out - fluid now|.
template <int D>
void measure_ledger(const Scene<D>& scene, State<D>& state, Workspace<D>& scratch);

// What kinetic energy (J) a step gained beyond the work of ports and loads, the elastic energy set free and half of what there was, blood
// at 0.1 m/s at least: above 0 only where a step ran away. 0 where the books do not hold all work: without blood, with moving walls or
// ports of given speed, in the paper's scheme. Energies of the solids are asked for only where the rest does not suffice.
template <int D>
double runaway_energy(const Scene<D>& scene, const State<D>& before, const State<D>& after, Workspace<D>& scratch);

// One line for each book that is over its limit (Limits), with value and limit; empty where all is well.
template <int D>
std::vector<std::string> over_limits(const Scene<D>& scene, const State<D>& state);

}  // namespace sim
