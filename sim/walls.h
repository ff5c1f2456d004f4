// Walls, and every other solid surface as the fluid sees it: where it is and how fast it moves.
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// Moves the walls that have a motion by dt and sets their velocity. A wall that slides in a periodic domain comes in again on the other
// side; its centre of rotation moves along with it.
template <int D>
void move_walls(const Scene<D>& scene, State<D>& state, double dt);

// work.boundary_normal and boundary_velocity of all rows below first_fluid: walls turned with their motion and dragging with their
// surface_velocity; solids and shells as they are now.
template <int D>
void boundary_surfaces(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// Curvature K of the wall's surface below which each row lies, at the start: over the tangent plane at the row's nearest surface point the
// surface stands s.K s / 2 high towards the fluid at a distance s along the plane. By least squares over the surface points and normals of
// the wall rows around that face the same way; 0 beside edges and for other rows. Empty where all walls are flat.
template <int D>
std::vector<Tensor<D>> wall_curvatures(const Scene<D>& scene);

// Distance of every row below first_fluid to the far face of its wall, opposite to its own normal, m; 0 where no face lies within 1.5
// kernel radii. So that fluid on either side of a wall of few layers sees the face it wets. At the start; walls are rigid.
template <int D>
std::vector<double> far_faces(const Scene<D>& scene);

}  // namespace sim
