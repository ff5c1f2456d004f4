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
struct StageTimes {
  std::vector<double> seconds;    // by Stage, summed; empty before the first
  std::vector<StageEvent> trace;  // every interval while there is room in its capacity (none by itself)
};

// Adds the wall time between its making and its end to the stage's seconds.
class StageClock {
 public:
  StageClock(StageTimes& times, Stage stage) : times_(times), stage_(static_cast<std::size_t>(stage)) {
    times_.seconds.resize(stage_names.size(), 0);
  }
  ~StageClock() {
    const double duration = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    times_.seconds[stage_] += duration;
    if (times_.trace.size() < times_.trace.capacity())
      times_.trace.push_back({static_cast<Stage>(stage_), std::chrono::duration<double>(start_.time_since_epoch()).count(), duration});
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  StageTimes& times_;
  std::size_t stage_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Runs `work` on the clock of `stage`.
template <class Work>
decltype(auto) timed(StageTimes& times, Stage stage, Work&& work) {
  const StageClock clock(times, stage);
  return work();
}

}  // namespace sim
