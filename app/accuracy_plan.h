// Which runs tell what accuracy costs: a ladder of spacings, repeats of it, jittered starts, and every other knob varied at the ladder's
// middle.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/case_grid.h"
#include "app/scene_file.h"

namespace app {

struct PlannedRun {
  std::string curve, value;           // as in AccuracyPoint
  std::vector<std::string> settings;  // on top of the common ones
  int threads = 0, repeat = 0;        // 0 threads: as the options say; repeat 0: the first
  double spacing = 0;                 // m
  double cost_factor = 1;             // about, against the ladder's run of the same spacing
  bool scene_itself = false;
};

struct LadderPlan {
  std::vector<double> spacings;       // coarse to fine
  std::vector<std::string> left_out;  // rungs that the scene refuses, with its reason
};
// Spacings at 2, 1.41, 1, 0.71 … times the scene's, each made to fit the thinnest body a whole number of times, those left out that the
// scene refuses; at most `most` of them.
LadderPlan spacing_ladder(const SceneFile& scene, const std::vector<std::string>& settings, std::size_t most);

// The spacing nearest below `wanted` (above, where `coarser`) that divides the smallest extent of the scene's fluid and elastic boxes,
// discs and pipes; `wanted` where there is none.
double fitting_spacing(const SceneFile& scene, double wanted, bool coarser = false);

// "spacing=…" with enough digits.
std::string spacing_setting(double spacing);

std::vector<PlannedRun> ladder_runs(const SceneFile& scene, const std::vector<double>& spacings, int repeats);
// Jittered starts: `seeds` of them at 0.1 spacings.
std::vector<PlannedRun> jitter_runs(const SceneFile& scene, double spacing, int seeds);
// Every knob that the scene has, two or three values each beside its own. `only`: names of curves ("time.step", "scheme.kernel_radius",
// "threads", …); empty: all. Throws SceneError where `only` names a knob that the scene has not.
std::vector<PlannedRun> knob_runs(const SceneFile& scene, double spacing, const std::vector<std::string>& only);

// The run's folder and command.
GridCase grid_case_of(const PlannedRun& run, const std::filesystem::path& folder);

}  // namespace app
