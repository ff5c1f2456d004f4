// What the window's sliders change of a case, and the --set keys that they stand for. No window needed.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "app/scene_file.h"

namespace app {

// A calcified spot painted on a leaflet: a ball in which the tissue is `scale` times as stiff.
struct StiffSpot {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // m, in the first frame
  double radius = 0.002;                             // m
  double scale = 20;
};

struct Knobs {
  double youngs_modulus = 1e6;                                                           // Pa
  double poisson_ratio = 0.45;                                                           // below 0.5
  double thickness = 0.5e-3;                                                             // m
  double heart_rate = 75;                                                                // 1/min
  bool own_pressures = false;                                                            // else those of the case
  double ventricle_systolic = 16000, aortic_systolic = 16000, aortic_diastolic = 10700;  // Pa
  std::vector<StiffSpot> spots;                                                          // besides those of the case
};

// The knobs as the case has them.
Knobs knobs_of(const SceneFile& scene);
// The settings that lead from `start` to `now`; empty where nothing was moved.
std::vector<std::string> knob_settings(const Knobs& start, const Knobs& now);
// "leaflets 0.8 MPa (was 0.4), 2 stiff spots": what was changed, in words; "nothing changed".
std::string knobs_text(const Knobs& start, const Knobs& now);

}  // namespace app
