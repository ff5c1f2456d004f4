// When a valve of a run is open and when it is closed and at rest: for stills, holds of a movie and comparisons.
#pragma once

#include <optional>

#include "sim/run_file.h"

namespace app {

struct ValveMoments {
  double opened = 0;   // s: the orifice first passes half of its largest area
  double open = 0;     // s: widest open (of areas smoothed over three rows where there are 20)
  double closing = 0;  // s: the orifice falls below half of its largest area, after `open`
  double closed = 0;   // s: after closing, where the remaining orifice and the flow are smallest together, away from the ends of the phase
  double largest_area = 0, closed_area = 0;  // m2, at these moments
};

// Empty where the run has no orifice or the valve never opens (largest area below 10 mm2). A valve that does not close again within the
// run has closing = closed = the last time.
std::optional<ValveMoments> valve_moments(const sim::RunReader& run);
// The same from columns of equal length: time (s), orifice area (m2), flow (m3/s; may be empty).
std::optional<ValveMoments> valve_moments(const std::vector<double>& time, const std::vector<double>& area,
                                          const std::vector<double>& flow);

}  // namespace app
