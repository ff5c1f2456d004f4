// Walls, and every other solid surface as the fluid sees it: where it is and how fast it moves.
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// Moves the walls that have a motion by dt and sets their velocity.
template <int D>
void move_walls(const Scene<D>& scene, State<D>& state, double dt);

// work.boundary_normal and boundary_velocity of all rows below first_fluid: walls turned with their motion and dragging with their
// surface_velocity; solids and shells as they are now.
template <int D>
void boundary_surfaces(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

}  // namespace sim
