#include "sim/time_step.h"

#include <cmath>

#include "sim/parallel.h"

namespace sim {
namespace {

// Of the fluid, m/s; at least a fifth of the scene's reference speed.
template <int D>
double fastest_fluid(const Scene<D>& scene, const State<D>& state) {
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid);
  const double square = largest(state.size() - first, 0.0, [&](std::size_t i) { return state.velocity[first + i].squaredNorm(); });
  return std::max(std::max(std::sqrt(square), 0.2 * scene.reference_speed), 1e-300);
}

// Of gravity and the loads on the fluid, m/s².
template <int D>
double strongest_acceleration(const Scene<D>& scene, const State<D>& state) {
  double acceleration = scene.gravity ? scene.gravity->acceleration.norm() : 0;
  for (const auto& load : scene.description.loads)
    if (load.acceleration && state.size() > static_cast<std::size_t>(scene.first_fluid))
      acceleration = std::max(acceleration, load.acceleration(state.position.back(), state.time).norm());
  return acceleration;
}

}  // namespace

template <int D>
double unrestricted_step(const Scene<D>& scene, const State<D>& state) {
  const double l0 = scene.description.spacing, acceleration = strongest_acceleration(scene, state);
  const double flow = 0.2 * l0 / fastest_fluid(scene, state);
  return acceleration > 0 ? std::min(flow, 0.1 * std::sqrt(l0 / acceleration)) : flow;
}

template <int D>
StepLimit time_step_limit(const Scene<D>& scene, const State<D>& state, double until) {
  const SchemeSettings& scheme = scene.description.scheme;
  const TimeSettings& time = scene.description.time;
  const double l0 = scene.description.spacing;
  StepLimit limit{1e300, "nothing"};
  auto at_most = [&](double step, const char* name) {
    if (step < limit.step) limit = {step, name};
  };
  if (scene.pressure) {
    at_most(scheme.cfl * l0 / fastest_fluid(scene, state), "flow");
    const double acceleration = strongest_acceleration(scene, state);
    if (acceleration > 0) at_most(0.1 * std::sqrt(l0 / acceleration), "acceleration");
    if (state.last_step > 0) at_most(1.1 * state.last_step, "growth");
  }
  if (!scene.pressure) at_most(0.25 * time.output, "frames");  // solids and shells alone: four steps a frame at least
  if (scheme.maximum_step > 0) at_most(scheme.maximum_step, "setting");
  if (time.step > 0) limit = {time.step, "time.step"};
  // Land on outputs without a sliver of a step before them.
  if (limit.step >= until * (1 - 1e-9))
    limit = {until, "output"};
  else if (limit.step > 0.5 * until)
    limit.step = 0.5 * until;
  return limit;
}

template double unrestricted_step(const Scene<2>&, const State<2>&);
template double unrestricted_step(const Scene<3>&, const State<3>&);
template StepLimit time_step_limit(const Scene<2>&, const State<2>&, double);
template StepLimit time_step_limit(const Scene<3>&, const State<3>&, double);

}  // namespace sim
