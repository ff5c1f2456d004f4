// The dry scene: the leaflets of a valve case alone, without blood, under a pressure difference that is given to them as a load. An effect
// set of the same program: blood and ports are taken out of the description, a load and damping are put in. It answers a change of
// stiffness in seconds, and only for the closed valve: a structure-only model misses 13 to 28 % of the peak stress that one with blood
// finds, and it knows no flow.
#pragma once

#include "app/build_case.h"

namespace app {

struct DrySettings {
  double pressure = 12000;  // Pa, aorta minus ventricle (90 mmHg): what a closed valve bears in diastole; negative opens the valve
  double ramp = 0.004;      // s from zero to all of it
  double end = 0.010;       // s: on the demo the stress at 9 ms is within 0.01 % of that at 15 ms
  double output = 0.0025;   // s between frames
  double step = 1e-4;       // s: how often the load follows the surface
  double damping = 3000;    // 1/s, on the leaflets' speed, in place of the blood's resistance
};

// Throws SceneError where the case has no valve of sheets.
BuiltCase<3> dry_case(const SceneFile& scene, BuiltCase<3> built, const DrySettings& settings);
[[noreturn]] void refuse_dry(const SceneFile& scene);

inline constexpr const char* dry_warning = "dry preview, without blood: it misses 13 to 28 % of the peak stress, and knows no flow";

}  // namespace app
