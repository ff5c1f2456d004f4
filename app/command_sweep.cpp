// cusp sweep SCENE --vary KEY=V1,V2,… [--jobs N | --slurm]: the grid, one folder a case, a table of the metrics over it.
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/case_grid.h"
#include "app/commands.h"
#include "app/scene_file.h"
#include "sim/run_file.h"

namespace app {
namespace {

struct Options {
  std::string scene, output;
  std::vector<std::string> vary, settings;
  int jobs = 1, threads = 0;
  bool slurm = false, quiet = false, json = false;
};

std::string quoted(const std::string& word) {
  std::string result = "'";
  for (char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

// A job array: `sbatch sweep.slurm`; each task runs one case, and may be run again to go on.
void write_slurm(const std::vector<GridCase>& cases, const GridOptions& grid, const std::filesystem::path& folder) {
  std::ofstream file(folder / "sweep.slurm");
  file << "#!/bin/bash\n#SBATCH --job-name=cusp-sweep\n#SBATCH --array=0-" << cases.size() - 1
       << "\n#SBATCH --cpus-per-task=" << std::max(1, grid.threads) << "\ncase \"$SLURM_ARRAY_TASK_ID\" in\n";
  for (std::size_t k = 0; k < cases.size(); ++k) {
    std::filesystem::create_directories(cases[k].folder);
    file << k << ")";
    for (const std::string& word : case_command(cases[k], grid, "cusp")) file << " " << quoted(word);
    file << " ;;\n";
  }
  file << "esac\n";
}

// One row a case: its settings, how it ended, the last value of every column, and the largest.
nlohmann::json table_of(const std::vector<GridCase>& cases, const std::vector<int>& codes) {
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t k = 0; k < cases.size(); ++k) {
    nlohmann::json row{{"case", cases[k].folder.filename().string()}, {"settings", cases[k].settings}, {"exit_code", codes[k]}};
    if (codes[k] >= 0 && std::filesystem::exists(cases[k].run())) {
      try {
        const sim::RunReader run(cases[k].run());
        row["status"] = run.status(), row["wall_seconds"] = run.wall_seconds();
        for (const std::string& name : run.header().columns) {
          const std::vector<double> values = run.column(name);
          if (values.empty()) continue;
          row["last"][name] = values.back();
          row["largest"][name] = *std::max_element(values.begin(), values.end());
        }
      } catch (const std::exception& error) {
        row["status"] = error.what();
      }
    } else {
      row["status"] = codes[k] < 0 ? "not started" : "refused";
    }
    rows.push_back(row);
  }
  return rows;
}

void write_csv(const nlohmann::json& rows, const std::vector<Variation>& variations, const std::filesystem::path& file) {
  std::ofstream out(file);
  std::vector<std::string> columns;
  for (const auto& row : rows)
    if (row.contains("last") && columns.empty())
      for (const auto& [name, value] : row["last"].items()) columns.push_back(name);
  out << "case";
  for (const Variation& variation : variations) out << "," << variation.key;
  out << ",status,wall_seconds";
  for (const std::string& column : columns) out << "," << column << ",max " << column;
  out << "\n";
  for (const auto& row : rows) {
    out << row["case"].get<std::string>();
    for (const auto& setting : row["settings"]) {
      const std::string text = setting.get<std::string>();
      out << ",\"" << text.substr(text.find('=') + 1) << "\"";
    }
    out << "," << row["status"].dump() << "," << row.value("wall_seconds", 0.0);
    for (const std::string& column : columns)
      if (row.contains("last") && row["last"].contains(column))
        out << "," << row["last"][column].dump() << "," << row["largest"][column].dump();
      else
        out << ",,";
    out << "\n";
  }
}

int sweep(const Options& options) {
  read_scene_file(options.scene, options.settings);  // refuses a bad scene before any case starts
  std::vector<Variation> variations;
  for (const std::string& text : options.vary) variations.push_back(parse_variation(text));
  if (variations.empty()) throw SceneError("cusp sweep: nothing varies; give --vary KEY=V1,V2");
  const std::filesystem::path scene(options.scene), folder = options.output.empty() ? "sweep-" + scene.stem().string() : options.output;
  const std::vector<GridCase> cases = grid_cases(variations, folder);
  for (const GridCase& one : cases) {
    std::vector<std::string> settings = options.settings;
    settings.insert(settings.end(), one.settings.begin(), one.settings.end());
    read_scene_file(scene, settings);
  }
  std::filesystem::create_directories(folder);
  GridOptions grid{scene, options.settings, options.jobs, options.threads, options.quiet, 0};
  if (options.slurm) {
    write_slurm(cases, grid, folder);
    std::printf("%s: %zu cases; start them with sbatch\n", (folder / "sweep.slurm").string().c_str(), cases.size());
    return 0;
  }
  const std::vector<int> codes = run_grid(cases, grid);
  const nlohmann::json rows = table_of(cases, codes);
  write_csv(rows, variations, folder / "sweep.csv");
  std::ofstream(folder / "sweep.json") << rows.dump(2) << "\n";
  if (options.json)
    std::printf("%s\n", rows.dump(2).c_str());
  else
    std::printf("%s: %zu cases\n", (folder / "sweep.csv").string().c_str(), cases.size());
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
  command->add_option("--jobs", options->jobs, "cases at a time")->check(CLI::Range(1, 4096));
  command->add_option("--threads", options->threads, "threads of each case (default: all, divided by --jobs)")->check(CLI::Range(1, 4096));
  command->add_flag("--slurm", options->slurm, "write a job script instead of running");
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the table as JSON");
  command->callback([options, &exit_code] { exit_code = sweep(*options); });
}

}  // namespace app
