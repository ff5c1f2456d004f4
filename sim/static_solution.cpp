#include "sim/static_solution.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "sim/solid_static.h"

namespace sim {
namespace {

// In static mode a load without ramp and table grows in proportion to the factor.
template <int D>
std::vector<Load<D>> proportional_loads(const SceneDescription<D>& description) {
  std::vector<Load<D>> loads = description.loads;
  const double far = 1e6 * std::max(1.0, description.time.end);
  for (Load<D>& load : loads)
    if (load.ramp <= 0 && !load.factor) load.factor = TimeTable{{0, far}, {0, far}, false};
  return loads;
}

}  // namespace

template <int D>
struct StaticSolution<D>::Data {
  const Scene<D>& scene;
  std::vector<Load<D>> shell_loads;
  SolidPattern<D> pattern;
};

template <int D>
StaticSolution<D>::StaticSolution(const Scene<D>& scene)
    : data_(std::make_unique<Data>(Data{scene, proportional_loads(scene.description), {}})) {
  if (scene.solids) data_->pattern = solid_pattern(*scene.solids);
}
template <int D>
StaticSolution<D>::~StaticSolution() = default;

namespace {

template <int D>
void advance_shells(const Scene<D>& scene, const std::vector<Load<D>>& loads, std::span<Vector<D>> position, double from, double to) {
  const ShellElasticity<D>& shells = *scene.shells;
  double reached = from, increment = to - from;
  std::vector<Vector<D>> last(position.begin(), position.end());
  while (reached < to) {
    const double target = std::min(to, reached + increment);
    const ShellLoad<D> load = [&](std::span<const Vector<D>> now, std::span<Vector<D>> force) {
      add_shell_loads(shells, loads, target, now, force);
      if (scene.gravity)
        for (std::size_t i = 0; i < force.size(); ++i) force[i] += target * shells.mass[i] * *scene.description.gravity;
    };
    const ShellStaticReport report = solve_shell_equilibrium(shells, load, position, scene.description.scheme.elastic_tolerance, 100);
    if (report.converged) {
      reached = target;
      std::copy(position.begin(), position.end(), last.begin());
      continue;
    }
    std::copy(last.begin(), last.end(), position.begin());
    increment *= 0.5;
    if (increment > 1e-4 * std::max(std::abs(to), 1e-300)) continue;
    char text[160];
    std::snprintf(text, sizeof text, "no equilibrium of the shell beyond a load factor of %.4g: ", reached);
    throw NoEquilibrium(text + (report.message.empty() ? std::string("lower the load or stiffen the material") : report.message));
  }
}

}  // namespace

template <int D>
void StaticSolution<D>::advance(State<D>& state, double factor) {
  const Scene<D>& scene = data_->scene;
  const double from = state.time;
  State<D> next = state;
  try {
    if (scene.solids) {
      StaticProblem<D> problem;
      problem.loads = scene.description.loads;
      problem.gravity = scene.description.gravity;
      problem.tolerance = scene.description.scheme.elastic_tolerance;
      solve_static(*scene.solids, data_->pattern, problem, from, factor,
                   std::span<Vector<D>>(next.position).first(static_cast<std::size_t>(scene.elastic_count)));
    }
  } catch (const Overloaded& failure) {
    throw NoEquilibrium(failure.what());
  }
  if (scene.shells)
    advance_shells(scene, data_->shell_loads,
                   std::span<Vector<D>>(next.position)
                       .subspan(static_cast<std::size_t>(scene.elastic_count), static_cast<std::size_t>(scene.shell_count)),
                   from, factor);
  state = std::move(next);
  std::fill(state.velocity.begin(), state.velocity.end(), Vector<D>::Zero());
  state.last_step = factor - from;
  state.time = factor;
  ++state.step;
}

template class StaticSolution<2>;
template class StaticSolution<3>;

}  // namespace sim
