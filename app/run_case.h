// From a scene file to a finished run file: what `run`, `demo`, `sweep`, `accuracy`, `validate` and `replay` have in common.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/dry_case.h"
#include "app/scene_file.h"
#include "sim/run.h"

namespace app {

struct CaseParticles;  // build_case.h

struct RunCaseOptions {
  std::filesystem::path output;  // RUN.h5
  bool resume = false;
  bool quiet = false;
  double checkpoint_seconds = 10;
  std::size_t trace_events = 0;                           // stages of steps to note for a trace (sim/stage.h)
  int threads = 0;                                        // 0 = OpenMP's own choice
  std::shared_ptr<const CaseParticles> placed;            // particles of an earlier run that this one shares; null: place them
  std::optional<DrySettings> dry;                         // leaflets alone under a pressure difference (dry_case.h)
  std::function<void(const sim::RunProgress&)> progress;  // after every step, besides the printed one
};

// Places, builds and simulates; warnings go to stderr and into the run file.
sim::RunResult run_case(const SceneFile& scene, const RunCaseOptions& options);

// Builds the scene and hands it, with its dimension as type, to `use`: use(built, scene) with sim::Scene<2> or sim::Scene<3>.
template <class Use>
void with_scene(const SceneFile& file, Use&& use);
// The same with the options' particles and effects.
template <class Use>
void with_scene(const SceneFile& file, const RunCaseOptions& options, Use&& use);

}  // namespace app

#include "app/run_case_inline.h"
