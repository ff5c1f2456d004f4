// Corrected MPS gradients over irregular particles (paper Eqs 16, 17 with the moment matrix of numerics-fluid 4(ii)3-4).
#pragma once

#include <algorithm>
#include <cmath>

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// The part of the way from a fluid particle to a boundary particle that lies in the fluid: 1 for a shell (its particles lie on the
// surface), d_f / (d_f + d_b) for a wall or solid of which the particle lies d_b below the true surface. r: from fluid to boundary
// particle; normal: unit, into the fluid; back_depth: distance below the wall's far face, 0 = none near. Seen from behind the surface's
// plane (round a corner, or the far face of a thin wall) the surface is taken to be d_b away in the direction of the fluid particle. Never
// below 0.2, so that a fluid particle on the surface keeps a finite sample. bend = r.K r of a curved surface (wall_curvatures): a part q of
// the way before the boundary particle it is crossed where q across - depth = q² bend / 2.
template <int D>
double fluid_fraction(const Vector<D>& r, const Vector<D>& normal, double depth, double back_depth = 0, double bend = 0) {
  if (depth <= 0) return 1;
  double across = -r.dot(normal);
  if (across < 0 && back_depth > 0) across = -across, depth = back_depth, bend = 0;
  if (across <= depth) return std::clamp(1.0 - depth / std::max(r.norm(), 1e-12), 0.2, 1.0);
  return std::clamp(1.0 - 2 * depth / (across + std::sqrt(std::max(across * across - 2 * bend * depth, 0.0))), 0.2, 1.0);
}

// The same for the link from fluid to boundary row j.
template <int D>
double fluid_fraction(const Scene<D>& scene, const Workspace<D>& work, const Vector<D>& r, std::int32_t j) {
  const double bend = work.boundary_curvature.empty() ? 0 : r.dot(work.boundary_curvature[j] * r);
  return fluid_fraction<D>(r, work.boundary_normal[j], scene.description.particles.depth[j], scene.back_depth[j], bend);
}

// Whether the port gives its pressure (else its speed).
template <int D>
bool gives_pressure(const Port<D>& port) {
  return port.condition == PortCondition::pressure || port.condition == PortCondition::windkessel;
}

// The part of the way from blood at x_i to a port particle at x_j that lies inside the port's plane, where its pressure holds; in [0.2, 1].
template <int D>
double port_fraction(const Port<D>& port, const Vector<D>& x_i, const Vector<D>& x_j) {
  const double inside = -(x_i - port.point).dot(port.normal), outside = (x_j - port.point).dot(port.normal);
  if (outside <= 0) return 1;
  return std::clamp(inside / (inside + outside), 0.2, 1.0);
}

// In one pass over the neighbours of every fluid particle:
// Inverse moment matrices, M = d/n0 sum w r r^T / |r|². One over fluid and boundary (for velocities: the boundary particle carries the
// value that makes the velocity at its true surface the surface's own), one over fluid alone (for pressure, so that a linear pressure has
// its exact gradient beside a wall too). The identity where n < 0.6 n0; eigenvalues below a floor (0.3, 0.1) are lifted to it. grad v from
// the current velocities; on the boundary v is the surface's own. Where the boundary layer is thinner than a spacing (cell Reynolds number
// rho |v_t| l0 / mu of the slip above 20) the tangential jump counts in the ratio 20/Re, in an inviscid fluid not at all: a layer that the
// particles cannot resolve would else appear as divergence. The trace is the divergence of Eq (17), exact for linear fields.
template <int D>
void velocity_gradients(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// What counts there of the jump from the velocity of a particle of fluid `body` to that of the boundary's surface with a unit `normal`.
// kinematic: m²/s at the rate that a wall one spacing away would cause; < 0: not asked for yet, kept for the particle's next neighbour.
template <int D>
Vector<D> resolved_jump(const Scene<D>& scene, std::int32_t body, const Vector<D>& jump, const Vector<D>& normal, double& kinematic);

// Eigenvalues of a symmetric matrix lifted to at least `floor`, then inverted.
template <int D>
Tensor<D> floored_inverse(const Tensor<D>& moment, double floor);

}  // namespace sim
