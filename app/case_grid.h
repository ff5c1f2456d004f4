// Many runs of one scene: the grid of values to vary, one folder and one child process a case, resumable.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace app {

struct Variation {
  std::string key;  // dotted path
  std::vector<std::string> values;
};
// "KEY=V1,V2,…"; commas within brackets or quotes belong to a value. Throws SceneError.
Variation parse_variation(const std::string& text);

struct GridCase {
  std::filesystem::path folder;       // of its own
  std::vector<std::string> settings;  // "KEY=VALUE", one a variation
  int threads = 0;                    // of this case; 0 = as the options say
  std::filesystem::path run() const { return folder / "run.h5"; }
};
// Every combination, the last variation changing fastest.
std::vector<GridCase> grid_cases(const std::vector<Variation>& variations, const std::filesystem::path& folder);

struct GridOptions {
  std::filesystem::path scene;
  std::vector<std::string> settings;  // common to all cases
  int jobs = 1, threads = 0;          // at a time; of each (0 = all divided by jobs)
  bool quiet = false;
  double budget_seconds = 0;  // no case is started after it; 0 = none
};
// Threads of one case: as asked for, else this machine's, divided by the jobs.
int threads_of_case(const GridOptions& options);
// Exit code a case (0 also for cases that were finished before); -1 = not started (budget, Ctrl-C). A signal that stops this process stops
// the running cases too: they keep what they have, and the next call goes on with them.
std::vector<int> run_grid(const std::vector<GridCase>& cases, const GridOptions& options);

// What a case cost all in all, its earlier parts included; zeros where the case was not run by run_grid. Kept in cost.json in its folder.
struct CaseCost {
  double elapsed = 0, processor = 0;  // s; processor: all threads
  double peak_memory = 0;             // bytes
};
CaseCost read_case_cost(const GridCase& one);

// The command line of one case, for job scripts.
std::vector<std::string> case_command(const GridCase& one, const GridOptions& options, const std::string& program);

}  // namespace app
