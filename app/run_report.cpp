#include "app/run_report.h"
#include "sim/stage.h"

#include <cstdio>

#include "app/progress.h"

namespace app {
namespace {

const char* ending_name(sim::RunEnding ending) {
  switch (ending) {
    case sim::RunEnding::finished:
      return "finished";
    case sim::RunEnding::already_finished:
      return "already finished";
    case sim::RunEnding::stopped:
      return "interrupted";
    case sim::RunEnding::out_of_time:
      return "stopped by limits.wall_time";
    case sim::RunEnding::failed:
      return "failed";
  }
  return "?";
}

}  // namespace

int exit_code_of(const sim::RunResult& result) {
  return result.ending == sim::RunEnding::failed || result.ending == sim::RunEnding::stopped || !result.over_limits.empty() ? 1 : 0;
}

nlohmann::json run_result_json(const sim::RunResult& result, const std::filesystem::path& file) {
  nlohmann::json json{{"run", file.string()},
                      {"status", ending_name(result.ending)},
                      {"time", result.time},
                      {"steps", result.steps},
                      {"frames", result.frames},
                      {"wall_seconds", result.wall_seconds},
                      {"particle_steps", result.particle_steps}};
  if (!result.message.empty()) json["message"] = result.message;
  if (!result.over_limits.empty()) json["over_limits"] = result.over_limits;
  if (!result.notices.empty()) json["notices"] = result.notices;
  for (std::size_t k = 0; k < result.columns.size() && k < result.last_row.size(); ++k)
    json["last"][result.columns[k]] = result.last_row[k];
  return json;
}

void print_run_result(const sim::RunResult& result, const std::filesystem::path& file, bool json, bool quiet) {
  if (json) {
    std::printf("%s\n", run_result_json(result, file).dump(2).c_str());
  } else if (!quiet) {
    std::printf("%s: %s at t = %.6g after %lld steps, %lld frames, %s\n", file.string().c_str(), ending_name(result.ending), result.time,
                static_cast<long long>(result.steps), static_cast<long long>(result.frames), duration_text(result.wall_seconds).c_str());
  }
  if (!result.message.empty()) std::fprintf(stderr, "%s: %s\n", file.string().c_str(), result.message.c_str());
  for (const std::string& line : result.over_limits) std::fprintf(stderr, "%s: %s\n", file.string().c_str(), line.c_str());
  for (const std::string& line : result.notices) std::fprintf(stderr, "%s: %s\n", file.string().c_str(), line.c_str());
}

void print_profile(const sim::RunResult& result) {
  double total = 0;
  for (double seconds : result.stage_times.seconds) total += seconds;
  std::fprintf(stderr, "%-22s %8s %6s %8s\n", "stage", "s", "%", "ms/step");
  for (std::size_t stage = 0; stage < result.stage_times.seconds.size(); ++stage)
    if (result.stage_times.seconds[stage] > 0)
      std::fprintf(stderr, "%-22s %8.2f %6.1f %8.2f\n", sim::stage_names[stage], result.stage_times.seconds[stage],
                   100 * result.stage_times.seconds[stage] / total,
                   1e3 * result.stage_times.seconds[stage] / static_cast<double>(result.steps));
  if (result.steps > 0 && result.particle_steps > 0)
    std::fprintf(stderr, "%.3g s a step, %.3g microseconds a particle and step\n", result.wall_seconds / static_cast<double>(result.steps),
                 1e6 * result.wall_seconds / result.particle_steps);
}

}  // namespace app
