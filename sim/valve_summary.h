// The clinical figures of a whole run, summed up from its series; definitions, units and sources in docs/metrics.md. SI throughout.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "sim/curve.h"
#include "sim/valve_metrics.h"

namespace sim {

// The series of a run: rows by columns, with the valve's figures of every output.
struct ValveSeries {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
  bool from_frames = false;                      // the figures were computed again from the frames (an older run file)
  Curve curve(const std::string& column) const;  // empty where there is none
};
// Of a run with a valve. Where the file lacks the figures they are computed from its frames. Throws std::runtime_error on a run without
// valve.
ValveSeries valve_series(const RunReader& run, const Rheology& blood);

// When the valve opens and closes within a beat, from its orifice area (docs/metrics.md, "Times"). NaN where it did not happen.
struct ValveTimes {
  double opens = 0, open = 0, closing = 0, closed = 0;  // s: starts to open, fully open, fast closing begins, closed
  double slow_closing = 0;                              // share of the largest opening lost before fast closing begins
  bool starts_open = false;                             // the record begins with the valve partly open
};
ValveTimes valve_times(const Curve& area, double from, double to);

struct Figure {
  std::string key, label, units;                                  // "stroke_volume", "Stroke volume", "m3"
  double value = std::numeric_limits<double>::quiet_NaN();        // NaN: the run does not tell; a warning says why
  double uncertainty = std::numeric_limits<double>::quiet_NaN();  // same unit; NaN: the run gives none
  double time = std::numeric_limits<double>::quiet_NaN();         // s, of an extreme
  std::string note;                                               // where an extreme lies
  std::vector<std::string> warnings;                              // why it is not to be trusted
};
struct LeafletStress {
  int leaflet = 0;  // 1, 2, 3
  LeafletRegion region = LeafletRegion::belly;
  double von_mises = 0, principal = 0;            // Pa: largest over the beat of the region's 99th percentile
  double von_mises_time = 0, principal_time = 0;  // s
};
struct ValveSummary {
  std::vector<Figure> figures;
  std::vector<LeafletStress> leaflets;
  std::vector<std::string> warnings;    // on the run as a whole
  ValveTimes times;                     // of the beat that the figures are of
  double beat_start = 0, beat_end = 0;  // s
  int beats = 1;                        // whole beats in the run
  const Figure* find(const std::string& key) const;
};
struct SummaryOptions {
  double period = 0;                                     // s of a beat; 0 = the whole run is one
  double spacing = 0;                                    // m, l0
  double output = 0;                                     // s between rows
  double annulus_radius = 0;                             // m
  std::string ventricle = "ventricle", aorta = "aorta";  // ports
};
SummaryOptions summary_options(const RunHeader& header, double period);
// Of the last whole beat (of what there is, where no beat is whole); with several, the spread from beat to beat is the uncertainty.
ValveSummary summarise_valve(const ValveSeries& series, const SummaryOptions& options);

}  // namespace sim
