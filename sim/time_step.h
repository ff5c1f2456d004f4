// How large the next step may be, and what limits it.
#pragma once

#include <string>

#include "sim/scene.h"

namespace sim {

struct StepLimit {
  double step = 0;   // s
  std::string name;  // what limits it: "flow", "acceleration", "growth", "setting", "output", …
};

// Smallest of: flow cfl l0/u_max; body accelerations 0.1 sqrt(l0/a); growth by 1/10 a step; scheme.maximum_step; time.step; `until` s left
// to the next output or the end.
template <int D>
StepLimit time_step_limit(const Scene<D>& scene, const State<D>& state, double until);

// What the step would be if the flow and the body accelerations alone limited it, at cfl 0.2: s; infinite where nothing moves or pulls.
template <int D>
double unrestricted_step(const Scene<D>& scene, const State<D>& state);

}  // namespace sim
