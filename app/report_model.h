// The report's 3-D model of the stressed valve.
#pragma once

#include <nlohmann/json.hpp>

#include "app/clinical.h"

namespace app {

struct ReportMoments {
  double open = 0, closed = 0, stressed = 0;  // s
};
ReportMoments report_moments(const ClinicalFigures& clinical);
// {"glb": base64, "top": Pa at the colour scale's end, "times", "center", "axis", "radius"}; null without leaflets. Scenes of the GLB:
// open, closed, largest stress.
nlohmann::json report_model(const sim::RunReader& run, const ReportMoments& moments);

}  // namespace app
