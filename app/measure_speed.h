// How fast the solver is: `cusp bench`. A scene's steps on the clock, and time and memory against the number of particles.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/scene_file.h"

namespace app {

struct SpeedOptions {
  int threads = 1;
  double until = 0;  // s simulated; 0: count steps instead
  int steps = 10;    // timed ones, after the first, which makes the arrays
};

// {"title", "particles", "fluid_particles", "threads", "steps", "simulated" (s), "processor_seconds", "wall_seconds", "seconds_a_step"
// (wall, median), "microseconds_a_particle_and_step" (processor), "processor_seconds_a_simulated_second", "pressure_iterations" (a step),
// "density_error_mean" and "density_error_rms" (of |n/n0 - 1| inside the fluid, averaged over some twenty moments), "peak_memory" (bytes,
// of the program), "stage_seconds" {stage: s}}. The first step is timed only where `until` is given: it belongs to a run.
nlohmann::json measure_speed(const SceneFile& scene, const SpeedOptions& options);

// Each size and thread count in a process of its own, water at rest: {"rows": [measure_speed's objects], "triad" [{threads,
// bytes_a_second}], "fits"
// [{threads, "time_exponent", "memory_exponent"}]}. `sizes`: particles, walls included, about.
nlohmann::json measure_scaling(const std::vector<double>& sizes, const std::vector<int>& threads, int steps, bool quiet);

// Bytes a second that a = b + s c moves through memory with arrays far larger than the caches (McCalpin's STREAM triad, its counting: 24
// bytes an entry).
double triad_bandwidth(int threads);

// docs/performance.md: the tables of a scaling and of bench scenes.
std::string performance_text(const nlohmann::json& scaling, const std::vector<nlohmann::json>& scenes);

}  // namespace app
