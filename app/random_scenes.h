// Scenes that nobody wrote: random combinations of bodies and effects, each of which must run or be refused in one line.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace app {

// The text of the scene of a seed: the same on every machine.
std::string random_scene(std::uint64_t seed);

// Runs it for `steps` steps, or fewer if limit_seconds pass. {seed, outcome, message, steps, seconds, particles}; outcome is
//   ran      - every value finite to the last step,
//   refused  - by the scene language, in one line, before anything ran,
//   stopped  - the run gave up with its one line (a step refused too often),
//   slow     - limit_seconds passed first,
//   broken   - a value that is not finite, or a message of several lines.
// Only slow and broken are failures of the program.
nlohmann::json run_random_scene(std::uint64_t seed, int steps = 50, double limit_seconds = 60);

}  // namespace app
