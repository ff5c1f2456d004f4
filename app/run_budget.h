// A budget instead of knobs: `cusp run --time-budget` and `--error-target` choose spacing, step and tolerances from what `cusp accuracy`
// measured: accuracy.json beside the scene, or one that comes with the program (assets/accuracy).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/scene_file.h"
#include "app/work_precision.h"

namespace app {

// Of what the scene simulates, spacing, time, scheme, limits, probes and references aside: equal for scenes whose measured costs and errors
// are each other's.
std::string scene_signature(const SceneFile& scene);

// Microseconds of wall time a particle and step over the first steps at that spacing: how fast this machine is now. 0 in a static scene.
double calibrate(const std::filesystem::path& scene, const std::vector<std::string>& settings, double spacing, int threads);

struct FoundStudy {
  AccuracyStudy study;
  std::filesystem::path file;
  std::string caution;  // where it was measured on something else: what, in words; else empty
};
// Throws SceneError, naming the command that measures, where there is none.
FoundStudy find_study(const SceneFile& scene, const std::string& option);
// Where `--store` puts a study; its name is the scene's, or "patient" for a patient's valve.
std::filesystem::path stored_study_path(const SceneFile& scene);

struct BudgetChoice {
  double spacing = 0;
  std::vector<std::string> settings;                // spacing first, then the free knobs
  double expected_seconds = 0, expected_error = 0;  // worst of the study's quantities, relative
  std::string words;                                // what was chosen and why, one line
};
// `speed`: this machine's time over that of the study (calibrate), `end`: s to be simulated. The spacing is interpolated on the study's
// ladder in the logarithms and lies between its coarsest rung and 0.7 of its finest. `fitted` (spacing, coarser) makes it one that divides
// the bodies. Both throw SceneError where the study can't answer: no ladder, or a budget below the coarsest run, or an error below the
// finest's.
using FitSpacing = std::function<double(double, bool)>;
BudgetChoice choose_for_time(const AccuracyStudy& study, double seconds, double speed, double end, const FitSpacing& fitted);
BudgetChoice choose_for_error(const AccuracyStudy& study, double error, double speed, double end, const FitSpacing& fitted);

// "90s", "20min", "2h" in s; "5%" or "0.05" as a share. Throw SceneError naming the option.
double read_duration(const std::string& option, const std::string& text);
double read_share(const std::string& option, const std::string& text);

}  // namespace app
