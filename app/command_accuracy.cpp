// cusp accuracy SCENE [--vary …] [--knobs …] [--budget 20min] [--store] [-o DIR]: what accuracy costs in time; --builtin: the five cases of
// docs/accuracy.md.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>

#include "app/accuracy.h"
#include "app/assets.h"
#include "app/commands.h"
#include "app/run_budget.h"
#include "app/scene_table.h"

namespace app {
namespace {

struct Options {
  std::string scene, output, budget, clock = "wall", knobs, docs;
  std::vector<std::string> vary, settings;
  int jobs = 1, threads = 1, repeats = 3, seeds = 5;
  bool quiet = false, json = false, store = false, builtin = false;
};

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  std::string word;
  for (char c : list + ",")
    if (c == ',') {
      if (!word.empty()) words.push_back(word);
      word.clear();
    } else {
      word += c;
    }
  return words;
}

AccuracyOptions chosen_options(const Options& options) {
  AccuracyOptions chosen;
  chosen.scene = options.scene, chosen.settings = options.settings, chosen.vary = options.vary, chosen.knobs = words_of(options.knobs);
  const std::filesystem::path path(options.scene);
  chosen.folder =
      options.output.empty() ? path.parent_path() / ("accuracy-" + path.stem().string()) : std::filesystem::path(options.output);
  chosen.jobs = options.jobs, chosen.threads = options.threads, chosen.repeats = options.repeats, chosen.seeds = options.seeds;
  chosen.budget = options.budget.empty() ? 0 : read_duration("--budget", options.budget);
  chosen.clock = options.clock == "processor" ? CostClock::processor : CostClock::wall, chosen.quiet = options.quiet || options.json;
  return chosen;
}

void store(const AccuracyStudy& study, const SceneFile& scene) {
  const std::filesystem::path file = stored_study_path(scene);
  std::ofstream stream(file);
  stream << study_json(study).dump(1) << "\n";
  if (!stream.flush()) throw std::runtime_error(file.string() + ": can't be written; set CUSP_ASSETS to an assets folder of your own");
}

int measure(const Options& options) {
  const AccuracyOptions chosen = chosen_options(options);
  const AccuracyStudy study = measure_accuracy(chosen);
  write_study(study, chosen.folder);
  if (options.store) store(study, read_scene_file(chosen.scene, chosen.settings));
  if (options.json)
    std::printf("%s\n", study_json(study).dump(2).c_str());
  else
    std::printf("%s\n%s\n", study_text(study, "").c_str(), (chosen.folder / "accuracy.md").string().c_str());
  const bool failed = std::any_of(study.left_out.begin(), study.left_out.end(),
                                  [](const std::string& line) { return line.find(": failed: ") != std::string::npos; });
  // A knob may be one that the scene can't be run with; that a rung of the ladder failed is another matter.
  return failed && ladder_of(study).size() < 2 ? 1 : 0;
}

// The cases of assets/scenes/accuracy/cases.toml, one after the other, and the page made of them.
int measure_builtin(const Options& options) {
  const std::filesystem::path file = asset("scenes/accuracy/cases.toml"),
                              folder = options.output.empty() ? std::filesystem::path("accuracy") : std::filesystem::path(options.output);
  const toml::table table = toml::parse_file(file.string());
  const TableReader top(table, "", {"case"});
  std::string page =
      "# What accuracy costs\n\nMade by `cusp accuracy --builtin --docs docs`: five cases, each run over a ladder of spacings, jittered "
      "starts and its other "
      "knobs, against its reference or its own finest run. A ringed point lies on the front: nothing measured is cheaper and better. The "
      "squares are the scenes' own settings. Times are of the machine that made the page; `cusp accuracy SCENE` measures yours.\n\n";
  for (const toml::table* entry : top.tables("case")) {
    const TableReader reader(*entry, "case", {"name", "scene", "set", "vary", "knobs", "seeds", "repeats"});
    const std::string name = reader.text("name");
    Options one = options;
    one.scene = std::filesystem::weakly_canonical(file.parent_path() / reader.text("scene")).string();
    one.output = (folder / name).string();
    if (reader.has("set")) one.settings = reader.texts("set");
    if (reader.has("vary")) one.vary = reader.texts("vary");
    one.knobs = reader.text("knobs", "");
    one.seeds = static_cast<int>(reader.integer("seeds", {0, 100, false, false, "0 to 100"}, options.seeds));
    one.repeats = static_cast<int>(reader.integer("repeats", {1, 100, false, false, "1 to 100"}, options.repeats));
    const AccuracyOptions chosen = chosen_options(one);
    const AccuracyStudy study = measure_accuracy(chosen);
    write_study(study, chosen.folder);
    if (options.store) store(study, read_scene_file(chosen.scene, chosen.settings));
    page += study_text(study, "accuracy/" + name + ".png", 2);
    if (!options.docs.empty()) {
      const std::filesystem::path docs(options.docs);
      std::filesystem::create_directories(docs / "accuracy");
      std::filesystem::copy_file(chosen.folder / "accuracy.png", docs / "accuracy" / (name + ".png"),
                                 std::filesystem::copy_options::overwrite_existing);
    }
    std::printf("%s: %s\n", name.c_str(), (chosen.folder / "accuracy.md").string().c_str());
    std::fflush(stdout);
  }
  while (page.size() > 1 && page[page.size() - 2] == '\n') page.pop_back();
  std::ofstream(folder / "accuracy.md") << page;
  if (!options.docs.empty()) std::ofstream(std::filesystem::path(options.docs) / "accuracy.md") << page;
  return 0;
}

}  // namespace

void add_accuracy_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("accuracy", "what accuracy costs in time: a ladder of runs against [reference] or the finest");
  command->footer(
      "Example: cusp accuracy scene.toml --budget 20min\n         cusp accuracy scene.toml --vary spacing=0.02,0.014,0.01 --knobs none");
  CLI::Option* scene = command->add_option("SCENE", options->scene, "scene file (.toml) with probes, or a valve");
  command->add_option("--vary", options->vary, "KEY=V1,V2,...: spacing alone is the ladder; anything else, the grid that is run instead")
      ->allow_extra_args(false);
  command->add_option("--knobs", options->knobs, "names with commas, or none (default: all that the scene has)");
  command->add_option("--set", options->settings, "KEY=VALUE for all runs; may be repeated")->allow_extra_args(false);
  command->add_option("--budget", options->budget,
                      "wall time for all of it: the ladder that fits is run, then what else fits; 90s, 20min, 2h");
  command->add_option("--repeats", options->repeats, "of each spacing, for the time's range")->check(CLI::Range(1, 100));
  command->add_option("--seeds", options->seeds, "jittered starts")->check(CLI::Range(0, 100));
  command->add_option("--clock", options->clock, "what cost means: wall, or processor (all threads; for a busy machine)")
      ->check(CLI::IsMember({"wall", "processor"}));
  command->add_option("-o,--output", options->output, "folder (default: accuracy-SCENE beside the scene)");
  command->add_option("--jobs", options->jobs, "runs at a time; more than one spoils wall times")->check(CLI::Range(1, 4096));
  command->add_option("--threads", options->threads, "threads of each run")->check(CLI::Range(1, 4096));
  command->add_flag("--store", options->store, "keep the result with the program, for --time-budget and --error-target of `cusp run`");
  CLI::Option* builtin = command->add_flag("--builtin", options->builtin, "the built-in cases instead of a scene");
  command->add_option("--docs", options->docs, "with --builtin: write accuracy.md and its pictures into this folder");
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the result as JSON");
  command->callback([=, &exit_code] {
    if (scene->count() == 0 && builtin->count() == 0) throw SceneError("cusp accuracy: no scene; give a scene file, or --builtin");
    exit_code = options->builtin ? measure_builtin(*options) : measure(*options);
  });
}

}  // namespace app
