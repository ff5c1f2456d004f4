#include "sim/time_step.h"

#include <cmath>

#include "sim/parallel.h"

namespace sim {

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
    const std::size_t first = static_cast<std::size_t>(scene.first_fluid);
    const double fastest =
        std::sqrt(largest(state.size() - first, 0.0, [&](std::size_t i) { return state.velocity[first + i].squaredNorm(); }));
    at_most(scheme.cfl * l0 / std::max(std::max(fastest, 0.2 * scene.reference_speed), 1e-300), "flow");
    double acceleration = scene.gravity ? scene.gravity->acceleration.norm() : 0;
    for (const auto& load : scene.description.loads)
      if (load.acceleration && state.size() > first)
        acceleration = std::max(acceleration, load.acceleration(state.position.back(), state.time).norm());
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

template StepLimit time_step_limit(const Scene<2>&, const State<2>&, double);
template StepLimit time_step_limit(const Scene<3>&, const State<3>&, double);

}  // namespace sim
