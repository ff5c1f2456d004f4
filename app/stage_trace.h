// The stages of a run as a trace that chrome://tracing and Perfetto open.
#pragma once

#include <filesystem>
#include <vector>

#include "sim/stage.h"

namespace app {

// JSON of Chrome's trace event format: one complete event ("X") an interval, microseconds from the first one's start. Throws
// std::runtime_error where the file can't be written.
void write_stage_trace(const std::vector<sim::StageEvent>& events, const std::filesystem::path& file);

}  // namespace app
