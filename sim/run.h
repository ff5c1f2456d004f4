// The run loop: steps, rows and frames at their times, checkpoints, going on, stopping cleanly.
//
// Frames and rows never change a step: the row of an output time is interpolated between the steps around it, its frame is the state at the
// first step at or after it.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "sim/run_file.h"
#include "sim/scene.h"
#include "sim/stage.h"
#include "sim/step.h"

namespace sim {

struct RunProgress {
  double time = 0, end = 0;  // s (static: load factor)
  std::int64_t step = 0, frames = 0;
  double wall_seconds = 0;  // of this run, earlier parts included
  double seconds_left = 0;  // estimated
  double step_size = 0;     // s
  std::int64_t particles = 0;
};

struct RunSetup {
  std::filesystem::path file;
  RunHeader header;                // program, scene text, lumen; the rest is filled in from the scene
  bool resume = false;             // go on from the checkpoint in `file`
  std::size_t trace_events = 0;    // of the stages of the steps, noted in the result until there are so many
  double checkpoint_seconds = 10;  // wall time between checkpoints; 0 = at every frame
  std::vector<std::string> warnings;
  std::function<void(const RunProgress&)> progress;  // after every step
  const std::atomic<bool>* stop = nullptr;           // set: the run ends after the present step
};

enum class RunEnding { finished, already_finished, stopped, out_of_time, failed };
struct RunResult {
  RunEnding ending = RunEnding::finished;
  std::string message;  // why it failed or stopped
  double time = 0;      // s reached
  std::int64_t steps = 0, frames = 0;
  double wall_seconds = 0;    // earlier parts included
  double particle_steps = 0;  // of this part
  StageTimes stage_times;     // of this part
  std::vector<std::string> columns;
  std::vector<double> last_row;
  std::vector<std::string> over_limits;  // of a finished run: books of the ledger over their limits (ledger.h)
  std::vector<std::string> notices;      // what else its user should know: overloaded leaflets (overload.h)
};

template <int D>
RunResult run(const Scene<D>& scene, const RunSetup& setup);

// The state as a frame of the run file.
template <int D>
RunFrame make_run_frame(const Scene<D>& scene, const State<D>& state);

}  // namespace sim
