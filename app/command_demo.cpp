// cusp demo [-o DIR]: one heart beat of the built-in patient, with its movie and stills.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "app/assets.h"
#include "app/commands.h"
#include "app/movie.h"
#include "app/progress.h"
#include "app/run_case.h"
#include "app/run_report.h"
#include "app/valve_moments.h"

namespace app {
namespace {

struct Options {
  std::string output = "out/demo", size = "1920x1080";
  std::vector<std::string> settings;
  int threads = 0;
  bool resume = false, quiet = false, json = false;
};

// Times of the open valve and of the closed one at rest.
std::pair<double, double> open_and_closed(const sim::RunReader& run) {
  if (const std::optional<ValveMoments> moments = valve_moments(run)) return {moments->open, moments->closed};
  const std::vector<double> time = run.column("time");
  return {0.3 * time.back(), time.back()};
}

MovieJob job_for(const std::filesystem::path& run, const std::filesystem::path& output, const Options& options) {
  MovieJob job;
  job.runs = {run}, job.output = output;
  job.stop = &stop_on_signal();
  if (std::sscanf(options.size.c_str(), "%dx%d", &job.width, &job.height) != 2)
    throw SceneError("--size " + options.size + ": is no size; as in 1920x1080");
  return job;
}

int demo(const Options& options) {
  const std::filesystem::path folder(options.output), run_file = folder / "run.h5";
  std::filesystem::create_directories(folder);
  const SceneFile scene = read_scene_file(asset("scenes/demo.toml"), options.settings);
  RunCaseOptions chosen;
  chosen.output = run_file, chosen.quiet = options.quiet, chosen.threads = options.threads;
  chosen.resume = options.resume && std::filesystem::exists(run_file);
  const sim::RunResult result = run_case(scene, chosen);
  print_run_result(result, run_file, options.json, options.quiet);
  if (result.ending == sim::RunEnding::stopped) return exit_code_of(result);
  const auto [open, closed] = open_and_closed(sim::RunReader(run_file));
  for (const auto& [name, time] : {std::pair{"open.png", open}, std::pair{"closed.png", closed}}) {
    MovieJob still = job_for(run_file, folder / name, options);
    still.time = time;
    make_movie(still);
  }
  MovieJob movie = job_for(run_file, folder / "movie.mp4", options);
  if (!options.quiet) std::fprintf(stderr, "rendering %s\n", movie.output.string().c_str());
  const MovieResult made = make_movie(movie);
  if (!options.quiet)
    std::printf("%s: %zu frames in %s\n", movie.output.string().c_str(), made.frames, duration_text(made.seconds).c_str());
  return exit_code_of(result);
}

}  // namespace

void add_demo_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("demo", "one heart beat of the built-in patient: run, movie and stills");
  command->footer("Example: cusp demo -o out/demo");
  command->add_option("-o,--output", options->output, "folder (default: out/demo)");
  command->add_option("--set", options->settings, "KEY=VALUE; may be repeated")->allow_extra_args(false);
  command->add_option("--size", options->size, "of the movie and the stills");
  command->add_option("--threads", options->threads, "processor threads (default: all)")->check(CLI::Range(1, 4096));
  command->add_flag("--continue", options->resume, "go on with a run that was stopped");
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the result as one JSON object");
  command->callback([options, &exit_code] { exit_code = demo(*options); });
}

}  // namespace app
