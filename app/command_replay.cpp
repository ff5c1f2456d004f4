// cusp replay RUN.h5 --set … [--vary KEY=V1,V2] [--dry] [-o NEW.h5]: the same run again with something changed.
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>

#include "app/build_case.h"
#include "app/commands.h"
#include "app/movie.h"
#include "app/progress.h"
#include "app/replay.h"
#include "app/run_report.h"

namespace app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string run, output, vary, movie;
  std::vector<std::string> settings;
  int threads = 0;
  bool dry = false, quiet = false, json = false;
  DrySettings dry_settings;
};

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

sim::RunReader open_run(const fs::path& path) {
  try {
    return sim::RunReader(path);
  } catch (const std::runtime_error& error) {
    throw SceneError(error.what());
  }
}

// One run to be: what is set on top of the old one, under which name.
struct Variant {
  std::string name;
  std::vector<std::string> settings;
  fs::path output;
};

std::vector<Variant> variants_of(const Options& options) {
  const fs::path old(options.run);
  const fs::path plain = options.output.empty() ? old.parent_path() / (old.stem().string() + (options.dry ? "_dry.h5" : "_replay.h5"))
                                                : fs::path(options.output);
  std::vector<Variant> variants;
  if (options.vary.empty()) {
    if (options.settings.empty() && !options.dry) throw SceneError("cusp replay: nothing is changed; give --set KEY=VALUE");
    variants.push_back({options.dry ? "dry" : "replay", options.settings, plain});
  } else {
    for (const std::string& setting : spelt_out_settings(options.vary)) {
      const std::string value = setting.substr(setting.find('=') + 1);
      std::vector<std::string> settings = options.settings;
      settings.push_back(setting);
      variants.push_back({value, settings, plain.parent_path() / (plain.stem().string() + "_" + value + plain.extension().string())});
    }
  }
  for (const Variant& variant : variants) {
    if (variant.output.extension() != ".h5") throw SceneError("-o " + variant.output.string() + ": has to end in .h5");
    if (fs::weakly_canonical(variant.output) == fs::weakly_canonical(old))
      throw SceneError("-o " + variant.output.string() + ": is the run itself; choose another name");
  }
  return variants;
}

void side_by_side(const Options& options, const std::vector<Variant>& variants, bool with_old) {
  MovieJob job;
  if (with_old) job.runs.emplace_back(options.run), job.labels.emplace_back("before");
  for (const Variant& variant : variants) {
    job.runs.push_back(variant.output);
    if (with_old) job.labels.push_back(variant.name);  // without it runs are told apart by what differs
  }
  job.output = options.movie;
  job.difference = job.runs.size() == 2;
  job.stop = &stop_on_signal();
  const MovieResult made = make_movie(job);
  if (!options.quiet) std::fprintf(stderr, "%s: %zu frames\n", options.movie.c_str(), made.frames);
}

int replay(const Options& options) {
  const sim::RunReader before = open_run(options.run);
  const std::vector<Variant> variants = variants_of(options);
  std::vector<SceneFile> scenes;  // all are read before anything runs
  for (const Variant& variant : variants) scenes.push_back(scene_of_run(fs::absolute(options.run), before.header(), variant.settings));
  RunCaseOptions chosen;
  chosen.quiet = options.quiet, chosen.threads = options.threads;
  if (options.dry) chosen.dry = options.dry_settings;
  nlohmann::json json = nlohmann::json::object();
  json["compared_with"] = options.run;
  int exit_code = 0;
  double placing = 0, saved = 0;
  const bool share = variants.size() > 1 && !moves_particles(options.vary);  // --set is the same for all
  for (std::size_t k = 0; k < variants.size(); ++k) {
    if (!share || !chosen.placed) {
      const double began = now();
      chosen.placed = place_case(scenes[k]);
      placing = now() - began;
    } else {
      saved += placing;
    }
    chosen.output = variants[k].output;
    const sim::RunResult result = run_case(scenes[k], chosen);
    if (!options.json) print_run_result(result, chosen.output, false, options.quiet);
    json["runs"].push_back(run_result_json(result, chosen.output));
    exit_code = std::max(exit_code, exit_code_of(result));
    if (result.ending == sim::RunEnding::stopped) return exit_code;
  }
  json["placing_seconds"] = placing, json["reused_seconds"] = saved;

  // A dry run has no beat to compare with the old one's: the dry runs are compared with one another.
  std::vector<sim::RunReader> readers;
  std::vector<std::string> names;
  std::vector<const sim::RunReader*> compared;
  if (!options.dry) compared.push_back(&before), names.emplace_back("before");
  for (const Variant& variant : variants) readers.emplace_back(variant.output), names.push_back(variant.name);
  for (const sim::RunReader& reader : readers) compared.push_back(&reader);
  const std::vector<ComparedFigure> figures = compare_runs(compared);
  json["comparison"] = comparison_json(figures, names);
  if (options.json) {
    std::printf("%s\n", json.dump(2).c_str());
  } else {
    std::printf("%s", comparison_text(figures, names).c_str());
    std::printf("import, mesh and particles: %.1f s once%s\n", placing,
                saved > 0 ? (", reused for the others: " + duration_text(saved) + " saved").c_str() : "");
  }
  if (!options.movie.empty()) side_by_side(options, variants, !options.dry && variants.size() == 1);
  return exit_code;
}

}  // namespace

void add_replay_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("replay", "simulate a run again with something changed, and compare both");
  command->footer("Example: cusp replay run.h5 --vary body.leaflets.material.youngs_modulus=0.5e6,1e6,2e6 --movie stiffness.mp4");
  command->add_option("RUN", options->run, "run file (.h5)")->required();
  command->add_option("--set", options->settings, "KEY=VALUE; may be repeated")->allow_extra_args(false);
  command->add_option("--vary", options->vary, "KEY=V1,V2,...: one run for each value, all in one table");
  command->add_option("-o,--output", options->output, "the new run (default: RUN_replay.h5; with --vary the value is added to the name)");
  command->add_option("--movie", options->movie, "also a movie side by side: before and after with their difference, or all values");
  command->add_flag("--dry", options->dry, "leaflets alone, without blood, under a pressure difference: an answer in seconds");
  command->add_option("--pressure", options->dry_settings.pressure, "of --dry: aorta minus ventricle, Pa (default 12000; negative opens)");
  command->add_option("--threads", options->threads, "processor threads (default: all)")->check(CLI::Range(1, 4096));
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print one JSON object");
  command->callback([options, &exit_code] { exit_code = replay(*options); });
}

}  // namespace app
