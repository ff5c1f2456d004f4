// Errors of the runs of a study: against the scene's [reference], a valve's clinical figures or all probes against the finest run.
#pragma once

#include <filesystem>
#include <vector>

#include "app/compare.h"
#include "app/work_precision.h"

namespace app {

// Fills the study's quantities, sources, uncertainties and its points' errors and changes (files[k] belongs to points[k]); returns the
// comparisons. The finest run, where it is the reference, has error NaN; its own uncertainty is what the two finest differ by, taken to
// fall further with the observed order (first order where there is none).
std::vector<std::vector<Comparison>> compare_all(const SceneFile& scene, const std::vector<std::filesystem::path>& files,
                                                 AccuracyStudy& study);

// Standard deviation of quantity q over the answers, over the magnitude of the reference; of curves the root mean square along them.
double relative_spread(const std::vector<std::vector<Comparison>>& answers, std::size_t q);
// |a - b| over the magnitude of a's reference; of curves by root mean squares.
double relative_change(const Comparison& a, const Comparison& b);

}  // namespace app
