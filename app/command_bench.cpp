// cusp bench [SCENE]: a scene's steps on the clock; without a scene the bench scenes, and with --docs time and memory against size.
#include <cstdio>
#include <fstream>
#include <memory>

#include "app/assets.h"
#include "app/command_bench.h"
#include "app/measure_speed.h"

namespace app {
namespace {

struct Options {
  std::string scene, docs;
  std::vector<std::string> settings;
  std::vector<double> sizes{20e3, 60e3, 127e3};
  std::vector<int> threads{1};
  double until = 0;
  int steps = 10;
  bool quiet = false, json = false;
};

void print_one(const nlohmann::json& one) {
  std::printf("%s\n  %lld particles (%lld fluid), %d threads, %lld steps over %.4g s\n", one["title"].get<std::string>().c_str(),
              one["particles"].get<long long>(), one["fluid_particles"].get<long long>(), one["threads"].get<int>(),
              one["steps"].get<long long>(), one["simulated"].get<double>());
  std::printf(
      "  %.4g s a step (wall, median), %.3g microseconds of processor a particle and step, %.4g processor seconds a simulated second\n",
      one["seconds_a_step"].get<double>(), one["microseconds_a_particle_and_step"].get<double>(),
      one["processor_seconds_a_simulated_second"].get<double>());
  std::printf("  %.3g pressure iterations a step, density error %.3g %% mean, %.3g %% rms, compression %.3g %% mean, %.4g MiB at most\n",
              one["pressure_iterations"].get<double>(), 100 * one.value("density_error_mean", 0.0),
              100 * one.value("density_error_rms", 0.0), 100 * one.value("compression_mean", 0.0),
              one["peak_memory"].get<double>() / 1048576);
  if (one.contains("stage_seconds"))
    for (const auto& [stage, seconds] : one["stage_seconds"].items())
      std::printf("    %-26s %8.2f ms a step\n", stage.c_str(), 1e3 * seconds.get<double>() / one["steps"].get<double>());
  std::fflush(stdout);
}

int bench(const Options& options) {
  SpeedOptions chosen;
  chosen.threads = options.threads.front(), chosen.until = options.until, chosen.steps = options.steps;
  if (!options.scene.empty()) {
    const nlohmann::json one = measure_speed(read_scene_file(options.scene, options.settings), chosen);
    if (options.json)
      std::printf("%s\n", one.dump(2).c_str());
    else
      print_one(one);
    return 0;
  }
  std::vector<nlohmann::json> scenes;
  for (const char* name : {"dam_break", "resting_tank"}) {
    scenes.push_back(measure_speed(read_scene_file(asset(std::string("scenes/bench/") + name + ".toml"), options.settings), chosen));
    if (!options.json) print_one(scenes.back());
  }
  nlohmann::json all{{"scenes", scenes}};
  if (!options.docs.empty()) {
    all["scaling"] = measure_scaling(options.sizes, options.threads, options.steps, options.quiet);
    std::ofstream file(std::filesystem::path(options.docs) / "performance.md");
    file << performance_text(all["scaling"], scenes);
    if (!file.flush()) throw std::runtime_error(options.docs + "/performance.md: can't be written");
  }
  if (options.json) std::printf("%s\n", all.dump(2).c_str());
  return 0;
}

}  // namespace

void add_bench_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("bench", "how fast a scene's steps are; without a scene: a dam break and a tank at rest");
  command->footer("Example: cusp bench scene.toml --steps 20 --threads 2");
  command->add_option("SCENE", options->scene, "scene file (.toml)");
  command->add_option("--set", options->settings, "KEY=VALUE; may be repeated")->allow_extra_args(false);
  command->add_option("--threads", options->threads, "processor threads (default 1); several with commas for --docs")
      ->delimiter(',')
      ->check(CLI::Range(1, 4096));
  command->add_option("--steps", options->steps, "timed steps, after a first one")->check(CLI::Range(1, 1000000));
  command->add_option("--until", options->until, "simulated seconds instead of steps")->check(CLI::PositiveNumber);
  command->add_option("--sizes", options->sizes, "particles, with commas, for --docs")->delimiter(',')->check(CLI::Range(1e3, 1e8));
  command->add_option("--docs", options->docs, "also measure time and memory against size, and write performance.md into this folder");
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the result as JSON");
  command->callback([options, &exit_code] { exit_code = bench(*options); });
}

}  // namespace app
