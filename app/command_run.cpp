// cusp run SCENE [-o RUN.h5] [--set KEY=VALUE]… [--threads N] [--continue] [--profile]
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/run_case.h"
#include "app/run_report.h"
#include "sim/run_file.h"

namespace app {
namespace {

struct RunOptions {
  std::string scene, output;
  std::vector<std::string> settings;
  int threads = 0;
  double checkpoint_seconds = 10;
  bool resume = false, profile = false, quiet = false, json = false;
};

// Whether there is something to go on from. A run that was killed before its first checkpoint is begun again; a file that is no run is
// refused.
bool can_continue(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return false;
  try {
    if (sim::RunReader(file).has_checkpoint()) return true;
  } catch (const std::runtime_error&) {
    char signature[8]{};  // of an HDF5 file, or still zero where the run was killed while it was made
    std::ifstream(file, std::ios::binary).read(signature, sizeof signature);
    const bool begun =
        std::memcmp(signature, "\x89HDF\r\n\x1a\n", 8) == 0 || std::all_of(signature, signature + 8, [](char c) { return c == 0; });
    if (!begun) throw;
  }
  std::fprintf(stderr, "%s: holds no checkpoint yet; the run begins again\n", file.string().c_str());
  return false;
}

int run_scene(const RunOptions& options) {
  const SceneFile scene = read_scene_file(options.scene, options.settings);
  RunCaseOptions chosen;
  chosen.output = options.output.empty() ? scene.path.stem().string() + ".h5" : options.output;
  if (chosen.output.extension() != ".h5") throw SceneError("-o " + chosen.output.string() + ": has to end in .h5");
  chosen.resume = options.resume && can_continue(chosen.output);
  chosen.checkpoint_seconds = options.checkpoint_seconds;
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
  command
      ->add_option("--checkpoint", options->checkpoint_seconds, "seconds of wall time between checkpoints (default 10; 0: at every frame)")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--profile", options->profile, "say at the end where the time went");
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the result as one JSON object");
  command->callback([options, &exit_code] { exit_code = run_scene(*options); });
}

}  // namespace app
