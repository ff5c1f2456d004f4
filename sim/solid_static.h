// Equilibrium of elastic solids under their loads: load steps, Newton's method with line search.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "sim/solid_loads.h"
#include "sim/solid_tangent.h"

namespace sim {

// The loads are beyond what the body can carry (or the solver can follow): one line with the load factor reached.
struct Overloaded : std::runtime_error {
  using std::runtime_error::runtime_error;
};

template <int D>
struct StaticProblem {
  std::span<const Load<D>> loads;
  std::optional<Vector<D>> gravity;  // scaled with the load factor
  double tolerance = 1e-8;           // residual force relative to the loads
  int newton_iterations = 30;        // per load step
  double smallest_step = 1e-4;       // of the load factor interval, before giving up
};

struct StaticReport {
  int load_steps = 0, newton_iterations = 0, factorisations = 0;
  double residual = 0;  // relative, of the last step
};

// Brings the solid from equilibrium at factor `from` to equilibrium at factor `to`; position: first n rows, in and out. Loads count with
// load_factor(load, factor), a load without ramp and table with the factor itself (proportional loading); gravity with min(factor, 1).
// Throws Overloaded, leaving position at the last equilibrium found, and std::invalid_argument where nothing holds a body.
template <int D>
StaticReport solve_static(const SolidElasticity<D>& solid, const SolidPattern<D>& pattern, const StaticProblem<D>& problem, double from,
                          double to, std::span<Vector<D>> position);

}  // namespace sim
