// The published step of the elastic bodies (scheme.name = "paper"), in the order of the paper's Fig. 1. It shows what the published
// operators do; docs/paper.md says where they are right and where they can't be.
#pragma once

#include "sim/scene.h"
#include "sim/step.h"
#include "sim/workspace.h"

namespace sim {

// Refuses what the published step is not wired for: std::invalid_argument with one line.
template <int D>
void check_paper_scheme(const SceneDescription<D>& scene);

// Moves the solids by dt with Eqs (20)-(24), in implicit steps of at most 1e-4 s (Eq 20 damps an oscillation by exp(-pi omega dt) a
// period), under gravity and loads. Throws NumericalFailure where the outer iterations do not converge.
template <int D>
void step_paper_solids(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt, StepReport& report);

}  // namespace sim
