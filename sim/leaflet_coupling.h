// Leaflets and blood in one projection (docs/equations.md; numerics-coupling.md "B2" with the sides' pressures eliminated).
//
// Shell particle b with normal N, area A, mass m feels p+ and p- of the blood that wets its sides, p = sum w_i p_i with sum w_i = 1
// (through the film of gap_film.h where none does), and pushes the same blood out of its way with the same weights:
//   v_b = v^_b - dt/m A (p+ - p-) N
//   volume balance of blood i (times V):  ... = ... + sum_b s w_i A (v_b - v_b^n).N / dt,  s = +1 on the normal's side, -1 on the other.
// where m is, along the normal, the leaflet's own mass plus that of the blood within its lattice layer, rho A (l0 - h): a leaflet particle
// stands in the place of a layer l0 thick but is only h thick. The leaflet's place is that of its sub-steps, its velocity is then mended by
// the new pressure: x = X_sub, v = v^_b - dt/m A (p+ - p-) N. x = X_sub + dt/2 (v - V_sub), which lags less, lets stiff leaflets run away.
// What x lags behind the velocity's integral is dt²/2 times the change of acceleration at most.
// Within the sub-steps a part of the blood farther out (scheme.resolved_mass) is felt too, beyond its last acceleration. It must not stand
// in the equation above: m a + m_r (a - a^(n-1)) = F feeds every wave at the rate m_r dt w²/(2 m), which made closed leaflets flutter.
// Elastic forces are taken at x + tau v along the normal, tau = scheme.leaflet_relaxation dt at most (Kelvin-Voigt): that damps the waves
// with w dt beyond about 2, which sub-steps and step see differently.
// Eliminating v_b adds sum_b A²/m g g^T to the pressure matrix, g = (s w_i): symmetric and positive, so force and displaced volume are each
// other's adjoint and the leaflet's real mass stabilises the coupling at any density ratio.
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

// Links between the blood of a leaflet's two sides that stand for the rank-one terms where the multigrid is built: what they add to the
// pressure matrix' diagonal, and their entries beside its own.
template <int D>
void link_sides(const Workspace<D>& work, SymmetricMatrix& links);

// Velocities, positions, pressures, forces and accelerations of the leaflets from the solved pressure.
template <int D>
void correct_leaflets(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt);

}  // namespace sim
