// Walls continued beyond open ends, so that blood beside a port sees the vessel go on.
#pragma once

#include "sim/scene_description.h"

namespace sim {

// Appends a wall body whose particles mirror, across each port's plane, the wall within `depth` (m) inside it, wherever no wall is yet.
// Nothing is added where the walls already reach beyond their ports. Rows of the fluid move back accordingly.
template <int D>
void continue_walls_beyond_ports(SceneDescription<D>& description, double depth);

}  // namespace sim
