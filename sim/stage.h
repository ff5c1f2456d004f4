// The stages of a time step, in the order of the step, and their clocks.
#pragma once

#include <array>
#include <chrono>
#include <vector>

namespace sim {

enum class Stage {
  neighbors,
  ports_and_walls,
  velocity_gradients,
  viscosity,
  elastic,
  pressure_assembly,
  leaflet_coupling,
  multigrid_setup,
  pressure_solve,
  pressure_gradient,
  motion,
  sides,
  exchange,
  count
};
constexpr std::array<const char*, static_cast<std::size_t>(Stage::count)> stage_names = {
    "neighbours, density", "ports and walls",          "velocity gradients", "viscosity",      "elastic sub-steps",
    "pressure assembly",   "leaflet coupling",         "multigrid set-up",   "pressure solve", "pressure gradient",
    "motion and shifting", "sides of leaflets, walls", "exchange at ports"};

// One stage of one step, for a trace. Seconds on the steady clock.
struct StageEvent {
  Stage stage;
  double start, duration;
};
// Where the clocks also note every interval while there is room in its capacity; null: nowhere. Set by the program's --profile, before a
// run.
inline std::vector<StageEvent>* stage_trace = nullptr;

// Adds the wall time between its making and its end to the stage's seconds.
class StageClock {
 public:
  StageClock(std::vector<double>& seconds, Stage stage) : seconds_(seconds), stage_(static_cast<std::size_t>(stage)) {
    seconds_.resize(stage_names.size(), 0);
  }
  ~StageClock() {
    const double duration = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    seconds_[stage_] += duration;
    if (stage_trace && stage_trace->size() < stage_trace->capacity())
      stage_trace->push_back({static_cast<Stage>(stage_), std::chrono::duration<double>(start_.time_since_epoch()).count(), duration});
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  std::vector<double>& seconds_;
  std::size_t stage_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Runs `work` on the clock of `stage`.
template <class Work>
decltype(auto) timed(std::vector<double>& seconds, Stage stage, Work&& work) {
  const StageClock clock(seconds, stage);
  return work();
}

}  // namespace sim
