// Leaflets and blood in one projection (docs/equations.md; numerics-coupling.md "B2" with the sides' pressures eliminated).
//
// Shell particle b with normal N, area A, mass m feels p+ and p- of the blood that wets its sides, p = sum w_i p_i with sum w_i = 1
// (through the film of gap_film.h where none does), and pushes the same blood out of its way with the same weights:
//   v_b = v^_b - dt/m A (p+ - p-) N
//   volume balance of blood i (times V):  ... = ... + sum_b s w_i A (v_b - v_b^n).N / dt,  s = +1 on the normal's side, -1 on the other.
// where m is, along the normal, the leaflet's own mass plus that of the blood within its lattice layer, rho A (l0 - h): a leaflet particle
// stands in the place of a layer l0 thick but is only h thick; and a share m_r of that again for the blood farther out, which follows at
// last step's acceleration, m a^n = ... + m_r a^(n-1). The elastic sub-steps move the same mass under the same push: what differs between
// them and this equation would be fed to the waves that no blood particle feels. The leaflet's place is that of its sub-steps, its velocity
// is then mended by the new pressure: x = X_sub, v = V_sub + dt/m (F - F^n). For a wave of frequency w against which the blood has the
// added mass m_a (and m_r = 0) that multiplies the amplitude by at most 1 in a step where w dt < 2.4, whatever m_a, and by at most 1.13
// beyond, where the viscous bending (shell.h) damps more. x = X_sub + dt/2 (v - V_sub), which lags less, multiplies it by up to 1.04
// and w dt/2: stiff leaflets run away. What x lags behind the velocity's integral is dt²/2 times the change of acceleration at most.
// Eliminating v_b adds sum_b A²/m g g^T to the pressure
// matrix, g = (s w_i): symmetric and positive, so force and displaced volume are each other's adjoint and the leaflet's real mass
// stabilises the coupling at any density ratio.
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// Explicit elastic sub-steps over dt with the last step's blood force:
// work.shell_position, shell_velocity; work.shell_free_velocity = v^n + dt (mean internal + outer force)/m: the velocity without blood.
template <int D>
ShellSubstepReport predict_leaflets(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt);

// Adds the sources of the leaflets' motion without blood to work.source and fills work.coupling (the rank-one terms).
template <int D>
void couple_leaflets(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt);

// y += sum_b A²/m g (g . x)
template <int D>
void apply_coupling(const Workspace<D>& work, std::span<const double> x, std::span<double> y);

// The pressure matrix with the rank-one terms replaced by links between the blood of the two sides: what the multigrid is built from.
template <int D>
void matrix_for_multigrid(const Workspace<D>& work, SymmetricMatrix& matrix);

// Velocities, positions, pressures, forces and accelerations of the leaflets from the solved pressure.
template <int D>
void correct_leaflets(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt);

}  // namespace sim
