// cusp run SCENE [-o RUN.h5] [--set KEY=VALUE]… [--threads N] [--continue] [--profile]
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/run_case.h"
#include "app/run_report.h"

namespace app {
namespace {

struct RunOptions {
  std::string scene, output;
  std::vector<std::string> settings;
  int threads = 0;
  bool resume = false, profile = false, quiet = false, json = false;
};

int run_scene(const RunOptions& options) {
  const SceneFile scene = read_scene_file(options.scene, options.settings);
  RunCaseOptions chosen;
  chosen.output = options.output.empty() ? scene.path.stem().string() + ".h5" : options.output;
  if (chosen.output.extension() != ".h5") throw SceneError("-o " + chosen.output.string() + ": has to end in .h5");
  chosen.resume = options.resume && std::filesystem::exists(chosen.output);
  chosen.quiet = options.quiet, chosen.threads = options.threads;
  const sim::RunResult result = run_case(scene, chosen);
  print_run_result(result, chosen.output, options.json, options.quiet);
  if (options.profile) print_profile(result);
  return exit_code_of(result);
}

}  // namespace

void add_run_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = program.add_subcommand("run", "simulate a scene");
  command->footer("Example: cusp run scene.toml -o run.h5 --set spacing=0.02 --threads 2");
  command->add_option("SCENE", options->scene, "scene file (.toml)")->required();
  command->add_option("-o,--output", options->output,
                      "run file; RUN.xmf and RUN.csv are written beside it (default: the scene's name, here)");
  command->add_option("--set", options->settings, "KEY=VALUE with the dotted path of any scene key; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--threads", options->threads, "processor threads (default: all)")->check(CLI::Range(1, 4096));
  command->add_flag("--continue", options->resume, "go on from the last checkpoint of the run file, if there is one");
  command->add_flag("--profile", options->profile, "say at the end where the time went");
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the result as one JSON object");
  command->callback([options, &exit_code] { exit_code = run_scene(*options); });
}

}  // namespace app
