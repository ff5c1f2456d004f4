// Incompressibility: one Poisson equation for the pressure of all fluid, its source, and the pressure gradient (paper Eqs 28-34, 38 in the
// form of docs/equations.md).
//
// Volume balance of fluid particle i, with k = 2d/(lambda n0), V = l0^d, sums over visible fluid j and boundary particles b:
//   sum_j k w (p_i - p_j)/rho + [surface: k (n0 - n_i) p_i/rho] = -(div v^n)_i/dt - D_i(a) + gamma (n_i - n0)/(n0 dt²)
// with projection_time for dt.
// The divergence of the present velocity is the corrected one (exact for linear fields, wall at its true surface). The divergence of the
// accelerations a (gravity, viscosity, boundary) is summed with the weights of the Laplacian itself,
//   D_i(a) = sum_j k w (a_i + a_j)/2 . r + sum_b k w a_b . r,
// so that a uniform body force is balanced by an exactly linear pressure over any particle arrangement: fluid at rest stays at rest.
// Boundaries need no pressure unknown: their links carry the normal flux that the boundary prescribes, and no pressure flux.
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// Numbers the fluid particles that take part (all but isolated drops with n < 0.02 n0).
template <int D>
void number_unknowns(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// Within what time the divergence of the present velocity is taken away, s: the step; beside a free surface no less than what flow and
// body accelerations would let a step be, since each projection over an uneven arrangement feeds some of the shortest waves: with steps
// kept far below that they would outgrow what dissipates them. With solids or leaflets the step always: fluid must give way to what rings.
template <int D>
double projection_time(const Scene<D>& scene, const State<D>& state, double dt);

// Matrix and source of the volume balance, times V. Prescribed port pressures move to the source.
template <int D>
void pressure_poisson(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt);

// Solves it and writes the pressures of the fluid rows (Pa). Where no pressure is given, the mean of each connected region is 0.
template <int D>
SolveReport solve_pressure(const Scene<D>& scene, State<D>& state, Workspace<D>& work);

// grad p at every fluid particle: corrected differences inside (exact for linear pressure), p = 0 half a spacing ahead of a free surface; in
// spray sum (p_i + p_j) r, which conserves momentum (numerics-fluid 4(ii)4).
template <int D>
void pressure_gradients(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// Pressure on walls and solids, extrapolated from the blood beside them; for output and probes only.
template <int D>
void boundary_pressures(const Scene<D>& scene, State<D>& state, const Workspace<D>& work);

}  // namespace sim
