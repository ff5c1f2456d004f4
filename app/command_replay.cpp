// cusp replay RUN.h5 --set … [-o NEW.h5]: the same run again with something changed.
#include <cmath>
#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/run_case.h"
#include "app/run_report.h"

namespace app {
namespace {

struct Options {
  std::string run, output;
  std::vector<std::string> settings;
  int threads = 0;
  bool quiet = false, json = false;
};

// The scene that a run file was made from; its relative paths start where they started then.
SceneFile scene_of_run(const std::filesystem::path& run, const sim::RunHeader& header, const std::vector<std::string>& settings) {
  std::vector<std::string> all = header.settings;
  all.insert(all.end(), settings.begin(), settings.end());
  return parse_scene_text(header.scene_text, run.parent_path() / header.scene_folder / header.scene_name, all);
}

nlohmann::json compared(const sim::RunReader& before, const sim::RunReader& after) {
  nlohmann::json json = nlohmann::json::object();
  for (const std::string& name : before.header().columns) {
    const std::vector<double> a = before.column(name), b = after.column(name);
    if (a.empty() || b.empty() || name == "time") continue;
    json[name] = {{"before", a.back()}, {"after", b.back()}, {"change", b.back() - a.back()}};
  }
  return json;
}

int replay(const Options& options) {
  std::unique_ptr<sim::RunReader> before;
  try {
    before = std::make_unique<sim::RunReader>(options.run);
  } catch (const std::runtime_error& error) {
    throw SceneError(error.what());
  }
  if (options.settings.empty()) throw SceneError("cusp replay: nothing is changed; give --set KEY=VALUE");
  const SceneFile scene = scene_of_run(std::filesystem::absolute(options.run), before->header(), options.settings);
  RunCaseOptions chosen;
  const std::filesystem::path old(options.run);
  chosen.output = options.output.empty() ? old.parent_path() / (old.stem().string() + "_replay.h5") : std::filesystem::path(options.output);
  if (std::filesystem::weakly_canonical(chosen.output) == std::filesystem::weakly_canonical(old))
    throw SceneError("-o " + options.output + ": is the run itself; choose another name");
  chosen.quiet = options.quiet, chosen.threads = options.threads;
  const sim::RunResult result = run_case(scene, chosen);
  const sim::RunReader after(chosen.output);
  nlohmann::json json = run_result_json(result, chosen.output);
  json["compared_with"] = options.run;
  json["comparison"] = compared(*before, after);
  if (options.json) {
    std::printf("%s\n", json.dump(2).c_str());
  } else {
    print_run_result(result, chosen.output, false, options.quiet);
    std::printf("%-28s %14s %14s %14s\n", "last value of", "before", "after", "change");
    for (const auto& [name, row] : json["comparison"].items())
      if (row["change"].get<double>() != 0)
        std::printf("%-28s %14.6g %14.6g %14.6g\n", name.c_str(), row["before"].get<double>(), row["after"].get<double>(),
                    row["change"].get<double>());
  }
  return exit_code_of(result);
}

}  // namespace

void add_replay_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("replay", "simulate a run again with something changed, and compare both");
  command->footer("Example: cusp replay run.h5 --set body.leaflets.material.youngs_modulus=2e6");
  command->add_option("RUN", options->run, "run file (.h5)")->required();
  command->add_option("--set", options->settings, "KEY=VALUE; may be repeated")->allow_extra_args(false);
  command->add_option("-o,--output", options->output, "the new run (default: RUN_replay.h5)");
  command->add_option("--threads", options->threads, "processor threads (default: all)")->check(CLI::Range(1, 4096));
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print one JSON object");
  command->callback([options, &exit_code] { exit_code = replay(*options); });
}

}  // namespace app
