// What each effect costs and whether it costs nothing where it is not engaged: for `cusp explain --measure` without a scene.
#pragma once

#include <nlohmann/json.hpp>

namespace app {

// One row an effect of assets/scenes/effects/effects.toml: stages that the step gains with it, bytes of arrays (state and scratch) without
// and with it, seconds of processor time a step without and with it, and how far the run at zero strength is from the run without it after
// the same steps: positions in units of the spacing, speeds relative to the largest. Throws SceneError on a bad table or scene.
nlohmann::json measure_effects(int steps = 5);

}  // namespace app
