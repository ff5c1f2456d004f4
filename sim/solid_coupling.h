// Elastic solids of two or more layers and blood in one projection (numerics-coupling.md, scheme B3).
//
// Fluid i and solid particle b within the kernel radius exchange volume flux and force with the same pair vector g_ib = V k w r_ib (r from
// fluid to solid, k and w those of the pressure equation):
//   volume balance of i:  ... = ... - sum_b g_ib . v_b / dt        force on b:  F_b = sum_i g_ib p_i
// Over a flat wetted face sum g_ib is the area times the normal, so F is the pressure on the deformed surface. The solid answers a change
// of force within the step as v_b = V_b + dt (M + dt² K)^-1 (F - F^n), V from its own step under last step's force; eliminating v_b adds a
// symmetric positive operator to the pressure matrix. Stiff solids need no small step.
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// Outward unit normal of the nearest face at rest for every elastic row: from the faces' area vectors.
template <int D>
std::vector<Vector<D>> rest_surface_normals(const InitialParticles<D>& particles, std::int64_t elastic_count, double spacing);

// Moves the solids over dt under their loads, gravity, drag and last step's pressure force; work.solid_position, solid_velocity. Where
// there is blood also factorises M + dt² K and sets work.acceleration of the elastic rows to what moves them without blood's pressure.
template <int D>
std::int64_t predict_solids(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt);

// y += G (M + dt² K)^-1 G^T x over the unknowns.
template <int D>
void apply_solid_coupling(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, std::span<const double> x, std::span<double> y);

// Final velocities, positions and forces of the solids.
template <int D>
void correct_solids(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt);

}  // namespace sim
