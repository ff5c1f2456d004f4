// What a scene would simulate and what not: for `cusp explain`.
#pragma once

#include <nlohmann/json.hpp>

#include "app/scene_file.h"

namespace app {

struct StageLine {
  std::string stage;    // what the step does
  std::string because;  // the key or body that asks for it; empty = not simulated
};
// The stages of one step in order, those that the scene does not ask for included (with an empty `because`).
std::vector<StageLine> stages_of(const SceneFile& scene, bool shells, bool solids);

// bodies, particles, stages, memory, estimated time; with `measure`, the time of a few real steps.
nlohmann::json explain_scene(const SceneFile& scene, int measured_steps);

}  // namespace app
