// Open ends: three layers of port particles outside each opening carry the port's pressure or speed; blood crosses freely
// (numerics-fluid 4(ii)7).
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// Adds the port particles of every port to a new state, continuing the blood's own lattice outward.
template <int D>
void open_ports(const Scene<D>& scene, State<D>& state);

// Pressure (Pa) and speed (m/s, inward) of every port at a time; Windkessel ports from their memory. Sets the port particles' pressure and
// velocity: with a given pressure the speed is the blood's own beside the port, extrapolated outward along its normal (without `work`,
// which holds the neighbours, its mean).
template <int D>
void prescribe_ports(const Scene<D>& scene, State<D>& state, const Workspace<D>* work, double time);

// work.grip: beside a port (within 3 l0) whose profile the particles do not resolve, blood slips along the wall, as the port's layers do.
template <int D>
void wall_grip(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// After the move: port particles that came in become blood and a new one follows three layers behind; blood that went out becomes port;
// what lies more than three layers out is removed. Updates port_flow, port_volume, the Windkessel and the ledger.
template <int D>
void exchange_through_ports(const Scene<D>& scene, State<D>& state, double dt);

// Removes blood that left the scene's box, counted as out.
template <int D>
void remove_escaped(const Scene<D>& scene, State<D>& state);

}  // namespace sim
