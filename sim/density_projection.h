// Incompressibility of a fluid with a free surface, second part: after a step its particles are moved until their number density is the
// undisturbed one again (Bender, Koschier 2015, the constant-density solver; on positions alone: Kugelstadt et al. 2019, "Implicit density
// projection for volume conserving liquids").
//
// With C_i = n_i/n0 - 1 and J = dC/dx, the smallest displacement that takes the errors away is x' - x = -J^T l with J J^T l = C. Inside
// the fluid too much and too little are mended, beside a surface only too much. Velocities stay: a density error mended by the pressure
// drives the fluid, the faster it is mended the more.
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

struct DensityReport {
  int iterations = 0;
  double before = 0, after = 0;  // mean |C| of what is to be mended, - ; after: as the linearised equations have it
};

// Moves the fluid to a mean error of scheme.density_tolerance (0: not at all), with the neighbours and the surface of the step's start.
// Nothing moves farther than 0.05 l0: moved by up to 0.1, twice as many splashes threw up more energy than they had. Only where a free
// surface leaves fluid room to give way, and no solids or leaflets shape it.
template <int D>
DensityReport project_density(const Scene<D>& scene, State<D>& state, Workspace<D>& work);

}  // namespace sim
