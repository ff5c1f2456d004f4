// The built-in cases of assets/scenes/validation/cases.toml: run, compared with their references, tabled and plotted.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/svg_plot.h"

namespace app {

struct ValidationCase {
  std::string name, title;
  std::filesystem::path scene;
  int priority = 3;
  std::vector<std::string> fast, full;  // settings
  std::vector<std::string> ladder;      // spacings, coarse to fine, whose errors give the observed order of convergence
};

// Throws SceneError on a bad table.
std::vector<ValidationCase> read_validation_cases();

struct ValidationResult {
  nlohmann::json json;            // name, title, priority, status, checks, steps, seconds, order (with a ladder)
  std::vector<PlotPanel> panels;  // curves against their references, then the errors as bars
};

// Runs one case into folder/NAME.h5. status: pass, degraded (passed, but steps were refused on the way), refused (bad input), fail.
// full: the full settings, and the ladder.
ValidationResult run_validation_case(const ValidationCase& one, bool full, int threads, const std::filesystem::path& folder);

// Slope of log error over log spacing by least squares; none where the errors do not fall from each spacing to the next finer one.
std::optional<double> convergence_order(const std::vector<double>& spacing, const std::vector<double>& error);

// validation.md, .csv and .json in the folder.
void write_validation_tables(const nlohmann::json& all, const std::filesystem::path& folder);

}  // namespace app
