// Order of the blood's rows in memory: particles that are near in space lie near in memory, so that sums over neighbours find them in the
// cache. Solids, shells and walls keep their rows.
#pragma once

#include "sim/scene.h"

namespace sim {

// Sorts the rows from scene.first_fluid on by cells of the kernel's radius (x fastest), within a cell by id. The order depends on the state
// alone, so a continued run sorts as an uninterrupted one.
template <int D>
void sort_by_cells(const Scene<D>& scene, State<D>& state);

}  // namespace sim
