// cusp validate --stability: the stability matrix of assets/scenes/stability/cells.toml.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace app {

struct StabilityOptions {
  std::filesystem::path output = "validation/stability";  // one folder a cell; stability.md and stability.json
  std::vector<std::string> cells;                         // names; empty = all
  bool fast = false;                                      // only the cells marked fast
  bool list = false;                                      // only list them
  int jobs = 0;                                           // cells at a time, or threads of a cell alone; 0 = as many as processors
  bool quiet = false;
};

// Runs the cells, each in a process of its own, and judges each from its run file: {"cases": [{name, status: pass / degraded / refused /
// fail, vary, value, step, time, cause, invariants...}], "counts": {...}}. Writes stability.md and stability.json into `output`, and prints
// a line a cell unless quiet.
nlohmann::json run_stability(const StabilityOptions& options);

}  // namespace app
