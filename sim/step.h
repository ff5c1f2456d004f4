// One time step, written out in the order it happens (paper Fig. 1).
#pragma once

#include <stdexcept>
#include <string>

#include "sim/linear_solver.h"
#include "sim/scene.h"
#include "sim/time_step.h"
#include "sim/workspace.h"

namespace sim {

struct StepReport {
  double step = 0;         // s, taken
  std::string limited_by;  // what limited it
  int pressure_iterations = 0, viscosity_iterations = 0;
  double pressure_residual = 0;
  int refused = 0;  // attempts undone before this one held
  std::int64_t elastic_substeps = 0;
};

// A step that cannot be taken: what, where (m), when, and what the user can change; one line.
struct NumericalFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Advances the state by at most `until` seconds (the time left to the next output). A step that ends in NaN or unconverged, or in which
// something moves by more than it may, is undone and tried again with half the size; after 6 halvings NumericalFailure is thrown and the
// state is the last good one.
template <int D>
StepReport step(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double until);

// Neighbours, link weights (cut at leaflets), density and free surface at the present positions.
template <int D>
void find_neighborhood(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

}  // namespace sim
