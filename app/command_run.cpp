// cusp run SCENE [-o RUN.h5] [--set KEY=VALUE]… [--threads N] [--continue] [--profile] [--time-budget 10min | --error-target 5%]
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "app/accuracy_plan.h"
#include "app/commands.h"
#include "app/compare.h"
#include "app/progress.h"
#include "app/run_budget.h"
#include "app/run_case.h"
#include "app/run_report.h"
#include "app/stage_trace.h"
#include "sim/run_file.h"

namespace app {
namespace {

struct RunOptions {
  std::string scene, output, time_budget, error_target;
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

// What a budget chooses for the scene. A run that goes on keeps what was chosen for it.
BudgetChoice choose_settings(const RunOptions& options, const SceneFile& scene) {
  const bool by_time = !options.time_budget.empty();
  const std::string option = by_time ? "--time-budget" : "--error-target";
  if (by_time && !options.error_target.empty()) throw SceneError("--time-budget and --error-target don't go together; give one of them");
  for (const std::string& setting : options.settings)
    if (setting.rfind("spacing=", 0) == 0)
      throw SceneError("--set " + setting + ": " + option + " chooses the spacing; leave one of them out");
  const double wanted = by_time ? read_duration(option, options.time_budget) : read_share(option, options.error_target);
  const FoundStudy found = find_study(scene, option);
  const int threads = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  double speed = 1;  // this machine's time over that of the study, at the same spacing
  if (found.study.calibration > 0 && scene.time.mode != sim::TimeMode::static_equilibrium)
    speed = calibrate(options.scene, options.settings, found.study.points[ladder_of(found.study).front()].spacing, threads) /
            found.study.calibration;
  const FitSpacing fitted = [&](double spacing, bool coarser) { return fitting_spacing(scene, spacing, coarser); };
  BudgetChoice choice = by_time ? choose_for_time(found.study, wanted, speed, scene.time.end, fitted)
                                : choose_for_error(found.study, wanted, speed, scene.time.end, fitted);
  char text[80];
  std::snprintf(text, sizeof text, "; this machine takes %.2g times the study's time now", speed);
  choice.words = option + (by_time ? " " + options.time_budget : " " + options.error_target) + ": " + choice.words + text;
  if (!found.caution.empty()) choice.words += "; " + found.caution;
  return choice;
}

// How near the run came to what was expected, and to the reference where the scene has one.
nlohmann::json budget_outcome(const BudgetChoice& choice, const sim::RunResult& result, const SceneFile& scene,
                              const std::filesystem::path& file) {
  nlohmann::json outcome{{"settings", choice.settings},
                         {"expected_seconds", choice.expected_seconds},
                         {"seconds", result.wall_seconds},
                         {"expected_error", choice.expected_error}};
  if (scene.references.empty() || result.ending != sim::RunEnding::finished) return outcome;
  double worst = 0;
  for (const Comparison& c : compare_with_references(scene, sim::RunReader(file))) worst = std::max(worst, c.error);
  outcome["error"] = worst;
  return outcome;
}

std::string outcome_words(const nlohmann::json& outcome) {
  char text[200];
  std::snprintf(text, sizeof text, "took %s where %s were expected; ", duration_text(outcome["seconds"]).c_str(),
                duration_text(outcome["expected_seconds"]).c_str());
  std::string words = text;
  if (outcome.contains("error"))
    std::snprintf(text, sizeof text, "largest error against [reference] %.2g %% where %.2g %% were expected",
                  100 * outcome["error"].get<double>(), 100 * outcome["expected_error"].get<double>());
  else
    std::snprintf(text, sizeof text, "the scene has no [reference], so its error is not known (%.2g %% were expected)",
                  100 * outcome["expected_error"].get<double>());
  return words + text;
}

int run_scene(const RunOptions& options) {
  SceneFile scene = read_scene_file(options.scene, options.settings);
  RunCaseOptions chosen;
  chosen.output = options.output.empty() ? scene.path.stem().string() + ".h5" : options.output;
  if (chosen.output.extension() != ".h5") throw SceneError("-o " + chosen.output.string() + ": has to end in .h5");
  chosen.resume = options.resume && can_continue(chosen.output);
  chosen.checkpoint_seconds = options.checkpoint_seconds;
  chosen.quiet = options.quiet, chosen.threads = options.threads;
  std::optional<BudgetChoice> choice;
  if (!options.time_budget.empty() || !options.error_target.empty()) {
    if (chosen.resume) {
      scene = read_scene_file(options.scene, sim::RunReader(chosen.output).header().settings);
    } else {
      choice = choose_settings(options, scene);
      std::vector<std::string> settings = options.settings;
      settings.insert(settings.end(), choice->settings.begin(), choice->settings.end());
      scene = read_scene_file(options.scene, settings);
      if (!options.quiet) std::fprintf(stderr, "%s\n", choice->words.c_str());
    }
  }
  if (options.profile) chosen.trace_events = 100'000;  // the first some ten thousand steps
  const sim::RunResult result = run_case(scene, chosen);
  if (choice) {
    const nlohmann::json outcome = budget_outcome(*choice, result, scene, chosen.output);
    nlohmann::json printed = run_result_json(result, chosen.output);
    printed["budget"] = outcome;
    if (options.json) std::printf("%s\n", printed.dump(2).c_str());
    print_run_result(result, chosen.output, false, options.quiet || options.json);
    if (!options.json && !options.quiet) std::printf("%s\n", outcome_words(outcome).c_str());
  } else {
    print_run_result(result, chosen.output, options.json, options.quiet);
  }
  if (options.profile) {
    print_profile(result);
    const std::filesystem::path trace = std::filesystem::path(chosen.output).replace_extension(".trace.json");
    write_stage_trace(result.stage_times.trace, trace);
    std::fprintf(stderr, "%s: opens in Perfetto (ui.perfetto.dev) or chrome://tracing\n", trace.string().c_str());
  }
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
  command->add_option("--time-budget", options->time_budget,
                      "choose spacing and step for this wall time (90s, 10min, 2h) from what `cusp accuracy` measured");
  command->add_option("--error-target", options->error_target, "the same for this error (5%)");
  command->add_flag("--profile", options->profile, "say at the end where the time went, and write RUN.trace.json for Perfetto");
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the result as one JSON object");
  command->callback([options, &exit_code] { exit_code = run_scene(*options); });
}

}  // namespace app
