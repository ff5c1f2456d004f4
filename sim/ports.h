// Open ends: three layers of port particles outside each opening carry the port's pressure or speed; blood crosses freely
// (numerics-fluid 4(ii)7).
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// Adds the port particles of every port to a new state, continuing the blood's own lattice outward.
template <int D>
void open_ports(const Scene<D>& scene, State<D>& state);

// Pressure (Pa) and speed (m/s, inward) of every port at the end of a step of dt seconds; Windkessel ports from their memory. Sets the port
// particles' pressure and velocity: where the port follows the blood their mean speed is that of the blood beside the opening, and their
// profile their own, as far as particles resolve it.
template <int D>
void prescribe_ports(const Scene<D>& scene, State<D>& state, double dt);

// Takes the viscous step's velocities for the particles of ports that follow the blood: outside the opening the vessel goes on straight, so
// only viscosity changes the profile there, and a uniform push keeps the mean (Womersley's flow). The profile is not copied from
// the blood inside: at an inflow that feeds on itself.
template <int D>
void develop_port_profiles(const Scene<D>& scene, State<D>& state, const Workspace<D>& work);

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
