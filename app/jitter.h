// Particles moved a little from their lattice at the start: how much of a result hangs on where the particles happened to lie.
#pragma once

#include "app/case_parts.h"

namespace app {

// Moves each particle by a random vector, each component uniform in [-jitter, jitter] spacings, the same for the same seed whatever the
// machine. Fluid, and elastic particles deeper than the surface's own layer; walls, sheets and surface layers follow true surfaces and
// stay.
void jitter_particles(CaseParticles& parts, const StartSpec& start, int dimension, double spacing);

}  // namespace app
