// A run beside its [reference]: measured, expected, error. For accuracy, validate and report.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/scene_file.h"
#include "sim/run_file.h"

namespace app {

struct Comparison {
  std::string quantity;  // "mid.y", or the probe's name for a profile or a curve
  std::string source;
  double time = 0;                     // s at which it was measured
  double measured = 0, reference = 0;  // SI; of a profile or curve: root mean squares
  double error = 0;  // relative: |measured - reference| / |reference|, or the L2 norm of a profile's difference over that of the reference
  double scale = 0;  // SI, what error is relative to where that is not the reference itself; else 0
  double uncertainty = 0;                                   // of the reference, absolute, SI
  std::optional<double> limit;                              // relative error that passes
  std::vector<double> at, measured_curve, reference_curve;  // of a profile or curve: for plots
  bool passed() const { return !limit || error <= *limit; }
};

// Throws SceneError where a reference names a component that the probe has not.
std::vector<Comparison> compare_with_references(const SceneFile& scene, const sim::RunReader& run);
nlohmann::json comparison_json(const Comparison& comparison);

}  // namespace app
