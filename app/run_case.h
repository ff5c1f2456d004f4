// From a scene file to a finished run file: what `run`, `demo`, `sweep`, `accuracy`, `validate` and `replay` have in common.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/scene_file.h"
#include "sim/run.h"

namespace app {

struct RunCaseOptions {
  std::filesystem::path output;  // RUN.h5
  bool resume = false;
  bool quiet = false;
  double checkpoint_seconds = 10;
  int threads = 0;  // 0 = OpenMP's own choice
};

// Places, builds and simulates; warnings go to stderr and into the run file.
sim::RunResult run_case(const SceneFile& scene, const RunCaseOptions& options);

// Builds the scene and hands it, with its dimension as type, to `use`: use(built, scene) with sim::Scene<2> or sim::Scene<3>.
template <class Use>
void with_scene(const SceneFile& file, Use&& use);

}  // namespace app

#include "app/run_case_inline.h"
