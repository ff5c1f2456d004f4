// Prescribed loads and gravity on elastic solids.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sim/scene_description.h"
#include "sim/solid.h"

namespace sim {

// Adds to force (N; 2-D: N/m), for rows [0, n) of the solid, at a time (s; static mode: the load factor):
//   gravity       m g
//   force         share * force * factor, a dead load; with 1 + D numbers a row in `share` (share, offset from the particle at rest, m) it
//                 acts on the surface, at that offset
//   acceleration  m a(x, t) * factor; a load without rows acts on its whole body
//   pressure      -p cof(F) A at the surface (Nanson), following the deformed surface; A = surface_area
// Forces through the surface act at the surface: what a particle carries at depth d below it goes to the particle and its neighbours such
// that the work is that of the fitted displacement at the surface point.
// work.derivatives must hold solid_derivatives of the same positions. `proportional` multiplies gravity and the loads that have neither
// ramp nor table: the load factor in static mode, 1 in time.
template <int D>
void external_loads(const SolidElasticity<D>& solid, std::span<const Load<D>> loads, const std::optional<Vector<D>>& gravity, double time,
                    std::span<const Vector<D>> position, const SolidWork<D>& work, std::span<Vector<D>> force, double proportional = 1);

// True where a load's forces turn with the surface: the tangent is then not the stiffness alone.
template <int D>
bool follows_surface(const Load<D>& load);

}  // namespace sim
