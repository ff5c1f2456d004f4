// Columns of the series: probes, then metrics, then the ledger.
#pragma once

#include <string>
#include <vector>

#include "sim/probes.h"

namespace sim {

struct Column {
  std::string name, units;
};

// Columns of the point probes (line probes have files of their own).
template <int D>
std::vector<Column> probe_columns(const Scene<D>& scene);
// Metrics (ports, speed, and of a valve its orifice, coaptation, jet, stress) and the ledger.
template <int D>
std::vector<Column> metric_columns(const Scene<D>& scene);
template <int D>
std::vector<double> metric_values(const Scene<D>& scene, const State<D>& state, Workspace<D>& scratch);

}  // namespace sim
