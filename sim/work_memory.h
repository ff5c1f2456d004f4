// What a Workspace carries from one step to the next that a step's result depends on: factors that are kept while they serve, and the
// contact search. It goes into the checkpoint as the places they were made at, so that a continued run makes the same ones and equals the
// uninterrupted run to the last bit. All else in a Workspace is made anew in each step.
#pragma once

#include "sim/run_file.h"
#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// Empty arrays where the scene has no solids or shells, or no step was taken yet.
template <int D>
NamedNumbers work_memory(const Workspace<D>& work);

// The work as it was when `memory` was taken. Arrays that are missing (a checkpoint of an earlier program) are made by the next step;
// throws std::runtime_error with one line where one has another size than the scene's.
template <int D>
void restore_work(const Scene<D>& scene, const NamedNumbers& memory, Workspace<D>& work);

}  // namespace sim
