// cusp sweep SCENE --vary KEY=V1,V2,… | --list FILE.csv [--jobs N | --slurm]: the grid, one folder a case, a table of the metrics over it.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/case_grid.h"
#include "app/commands.h"
#include "app/scene_file.h"
#include "app/sweep_table.h"
#include "sim/run_file.h"

namespace app {
namespace {

struct Options {
  std::string scene, output, list;
  std::vector<std::string> vary, settings;
  int jobs = 0, threads = 0;
  bool slurm = false, wait = false, collect = false, quiet = false, json = false;
};

std::string quoted(const std::string& word) {
  std::string result = "'";
  for (char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

// A job array: each task runs one case, and goes on with it where it was started before. Without --jobs Slurm decides how many run at a
// time; without --threads each takes one processor, for this machine's number says nothing of the cluster's.
void write_slurm(const std::vector<GridCase>& cases, const GridOptions& grid, const std::filesystem::path& folder) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  std::ofstream file(folder / "sweep.slurm");
  file << "#!/bin/bash\n#SBATCH --job-name=cusp-sweep\n#SBATCH --array=0-" << cases.size() - 1 << "%" << std::max(1, grid.jobs)
       << "\n#SBATCH --cpus-per-task=" << std::max(1, grid.threads) << "\n#SBATCH --output=" << (folder / "slurm-%a.log").string()
       << "\ncase \"$SLURM_ARRAY_TASK_ID\" in\n";
  for (std::size_t k = 0; k < cases.size(); ++k) {
    std::filesystem::create_directories(cases[k].folder);
    file << k << ")";
    for (const std::string& word : case_command(cases[k], grid, program)) file << " " << quoted(word);
    file << " ;;\n";
  }
  file << "esac\n";
  if (!file.flush()) throw std::runtime_error((folder / "sweep.slurm").string() + ": can't be written");
}

// Hands the array to Slurm. With `wait` returns true when every task has ended; else says how to make the table later.
bool submit_slurm(const std::filesystem::path& folder, bool wait) {
  const std::string script = (folder / "sweep.slurm").string();
  if (std::system("command -v sbatch >/dev/null 2>&1") != 0)
    throw SceneError("--slurm: no sbatch here (Debian: slurm-wlm); " + script + " is written and can be submitted where there is one");
  const int status = std::system(((wait ? "sbatch --wait " : "sbatch ") + quoted(script)).c_str());
  if (!wait && status != 0) throw std::runtime_error("sbatch refused " + script + "; what it said stands above");
  if (!wait) std::printf("when the jobs have ended, the same command with --collect instead of --slurm makes the table\n");
  return wait;
}

// How the cases stand, from their run files alone: 0 finished, 1 not, -1 not started.
std::vector<int> codes_found(const std::vector<GridCase>& cases) {
  std::vector<int> codes;
  for (const GridCase& one : cases) {
    int code = -1;
    try {
      if (std::filesystem::exists(one.run())) code = sim::RunReader(one.run()).status() == "finished" ? 0 : 1;
    } catch (const std::exception&) {
      code = 1;
    }
    codes.push_back(code);
  }
  return codes;
}

int sweep(const Options& options) {
  read_scene_file(options.scene, options.settings);  // refuses a bad scene before any case starts
  const std::filesystem::path scene(options.scene), folder = options.output.empty() ? "sweep-" + scene.stem().string() : options.output;
  std::vector<Variation> variations;
  std::vector<GridCase> cases;
  if (!options.list.empty()) {
    if (!options.vary.empty()) throw SceneError("cusp sweep: --list and --vary don't go together; give one of them");
    cases = listed_cases(options.list, folder, variations);
  } else {
    for (const std::string& text : options.vary) variations.push_back(parse_variation(text));
    if (variations.empty()) throw SceneError("cusp sweep: nothing varies; give --vary KEY=V1,V2 or --list FILE.csv");
    cases = grid_cases(variations, folder);
  }
  for (const GridCase& one : cases) {
    std::vector<std::string> settings = options.settings;
    settings.insert(settings.end(), one.settings.begin(), one.settings.end());
    read_scene_file(scene, settings);
  }
  std::filesystem::create_directories(folder);
  GridOptions grid{scene, options.settings, options.jobs, options.threads, options.quiet, 0};
  std::vector<int> codes;
  if (options.slurm) {
    grid.threads = std::max(1, grid.threads);
    write_slurm(cases, grid, folder);
    if (!submit_slurm(folder, options.wait)) return 0;
    codes = codes_found(cases);
  } else {
    codes = options.collect ? codes_found(cases) : run_grid(cases, grid);
  }
  const nlohmann::json table = sweep_table(scene.stem().string(), variations, cases, codes);
  write_sweep(table, folder);
  if (options.json)
    std::printf("%s\n", table["cases"].dump(2).c_str());
  else
    std::printf("%s: %zu cases; plots in %s\n", (folder / "sweep.csv").string().c_str(), cases.size(),
                (folder / "sweep.html").string().c_str());
  return std::all_of(codes.begin(), codes.end(), [](int code) { return code == 0; }) ? 0 : 1;
}

}  // namespace

void add_sweep_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("sweep", "run a scene over a grid of settings, one folder a case; run it again to go on");
  command->footer(
      "Example: cusp sweep scene.toml --vary body.leaflets.material.youngs_modulus=1e6,2e6 --vary spacing=0.001,0.0015 --jobs 2");
  command->add_option("SCENE", options->scene, "scene file (.toml)")->required();
  command->add_option("--vary", options->vary, "KEY=V1,V2,...; may be repeated: all combinations are run")->allow_extra_args(false);
  command->add_option("--set", options->settings, "KEY=VALUE for all cases; may be repeated")->allow_extra_args(false);
  command->add_option("-o,--output", options->output, "folder (default: sweep-SCENE)");
  command->add_option("--jobs", options->jobs, "cases at a time (default: 1; with --slurm as many as Slurm gives)")
      ->check(CLI::Range(1, 4096));
  command->add_option("--threads", options->threads, "threads of each case (default: all, divided by --jobs; with --slurm 1)")
      ->check(CLI::Range(1, 4096));
  command->add_flag("--slurm", options->slurm, "submit the cases as a Slurm job array instead of running them here");
  command->add_flag("--wait", options->wait, "with --slurm: wait until the jobs have ended, then make the table");
  command->add_flag("--collect", options->collect, "run nothing: make the table of what is there");
  command->add_option("--list", options->list, "CSV instead of --vary: a heading of keys, one case a row");
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the table as JSON");
  command->callback([options, &exit_code] { exit_code = sweep(*options); });
}

}  // namespace app
