// Keeps fluid particles evenly spaced, and keeps what is not resolved from growing.
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// Small displacement down the gradient of concentration (numerics-fluid 4(ii)5):
//   dr_i = -l0² A d/n0 sum w r/|r|² (1 + 0.2 (w/w(l0))^4),  A = min(A_max, 0.02 + 3 |u|_max,neighbours dt / l0),  |dr| <= 0.1 l0.
// None at a free surface, none across one beside it. Into work.displacement.
template <int D>
void shifting_displacement(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt);
// x += dr, v += grad v dr.
template <int D>
void shift_particles(const Scene<D>& scene, State<D>& state, const Workspace<D>& work);

// Dissipation for unresolved scales: each pair exchanges momentum in proportion to the part of its velocity jump that the resolved
// velocity gradients do not explain,
//   a_i += 2d/(lambda n0) sum w nu_ij [v_j - v_i - (grad v_i + grad v_j) r/2],  nu_ij = C l0 |v_j - v_i|.
// It vanishes for any linear velocity field, conserves momentum, and damps what alternates from particle to particle. In fluids with a free
// surface a share of that part, scheme.projection_filter, also goes in every step of the flow's own size: over an uneven arrangement the
// approximate projection lets some of the shortest waves grow a little each time (Rider 1998, Int. J. Numer. Meth. Fluids 28, 789).
template <int D>
void add_subparticle_dissipation(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt);

// Moves fluid pairs nearer than 0.7 l0 apart by at most 0.05 l0 and takes away the approach velocity below 0.6 l0 (numerics-coupling 5.2).
// Also keeps fluid 0.25 l0 clear of the true surface of walls and solids: nearer particles are put back and counted in the ledger
// where they lay beyond it.
template <int D>
void separate_particles(const Scene<D>& scene, State<D>& state, Workspace<D>& work);

}  // namespace sim
