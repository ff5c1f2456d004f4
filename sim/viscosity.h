// Viscous stress of the blood, implicit (paper Eqs 25-27), with a correction that makes the Laplacian exact for quadratic velocities.
#pragma once

#include <span>

#include "sim/linear_solver.h"
#include "sim/rheology.h"

namespace sim {

template <int D>
struct Scene;
template <int D>
struct Workspace;
template <int D>
struct State;

struct Viscosity {
  bool shear_dependent = false;  // some body's viscosity depends on its shear rate
  bool corrected = true;         // add the least-squares correction (exact for quadratic profiles); costs a 5x5 or 9x9 solve a particle
};

// mu of every fluid particle from its velocity gradient (Eqs 8-10); where it depends on the shear rate and the Laplacian is corrected also
// that of every link of fluid rows (work.pair_viscosity), at the mean rate of its ends: a mean of the ends' viscosities is too high by
// r²/8 times the curvature of mu along the link, 1 % of the flow with 20 particles across.
template <int D>
void particle_viscosity(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// Adds to the acceleration of every fluid particle the difference between the consistent (least-squares) and the MPS Laplacian of the
// present velocity, so that a steady flow obeys the consistent one while the implicit matrix stays symmetric. Explicit.
template <int D>
void add_laplacian_correction(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// Solves rho (v* - v)/dt = mu 2d/(lambda n0) sum (v*_j - v*_i) w + rho a for v* (Eq 27) and replaces work.acceleration by (v* - v)/dt.
// No slip on the boundary's true surface. Adds the reaction to boundary_force (N per row below first_fluid), if that is not empty.
template <int D>
SolveReport solve_viscosity(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt,
                            std::span<Eigen::Matrix<double, D, 1>> boundary_force);

}  // namespace sim
