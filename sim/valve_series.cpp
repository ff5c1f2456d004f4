// The series of a valve run, from its file or, for a file without the figures, from its frames.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/valve_summary.h"

namespace sim {
namespace {

double interpolated(const ValveSeries& series, const std::string& column, double time) { return value_at(series.curve(column), time); }

std::string port_column(const RunHeader& header, std::int32_t port, const char* quantity) {
  return port >= 0 && port < static_cast<std::int32_t>(header.ports.size())
             ? "port." + header.ports[static_cast<std::size_t>(port)] + "." + quantity
             : std::string();
}

void put(ValveSeries& series, std::vector<double>& row, const std::string& column, double value) {
  const auto found = std::find(series.columns.begin(), series.columns.end(), column);
  const auto index = static_cast<std::size_t>(found - series.columns.begin());
  if (found == series.columns.end()) series.columns.push_back(column);
  if (row.size() <= index) row.resize(index + 1, 0.0);
  row[index] = value;
}

}  // namespace

Curve ValveSeries::curve(const std::string& column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end()) return {};
  const auto index = static_cast<std::size_t>(found - columns.begin());
  Curve curve;
  for (const std::vector<double>& row : rows)
    if (index < row.size()) curve.time.push_back(row[0]), curve.value.push_back(row[index]);
  return curve;
}

ValveSeries valve_series(const RunReader& run, const Rheology& blood) {
  const RunHeader& header = run.header();
  if (!header.valve) throw std::runtime_error("valve figures: the run has no valve");
  ValveSeries given{header.columns, run.series(), false};
  if (std::find(given.columns.begin(), given.columns.end(), "tip_separation") != given.columns.end()) return given;
  const ValveSheet sheet = make_valve_sheet(run);
  ValveSeries series{given.columns, {}, true};
  for (std::size_t k = 0; k < run.frame_count(); ++k) {
    const RunFrame frame = run.frame(k);
    ValveMoment moment = valve_moment(sheet, frame);
    const auto port = [&](std::int32_t number, const char* quantity) {
      return interpolated(given, port_column(header, number, quantity), frame.time);
    };
    const std::int32_t ventricle = header.valve->ventricle_port, aorta = header.valve->aorta_port;
    moment.flow = 0.5 * (port(ventricle, "flow") - port(aorta, "flow"));
    moment.pressure_difference = port(ventricle, "pressure") - port(aorta, "pressure");
    std::vector<double> row{frame.time};
    for (std::size_t c = 1; c < given.columns.size(); ++c) row.push_back(interpolated(given, given.columns[c], frame.time));
    for (const NamedValue& figure : valve_metrics(sheet, moment, blood)) put(series, row, figure.name, figure.value);
    series.rows.push_back(std::move(row));
  }
  return series;
}

SummaryOptions summary_options(const RunHeader& header, double period) {
  SummaryOptions options;
  options.period = period > 0 ? period : header.end, options.spacing = header.spacing, options.output = header.output;
  if (!header.valve) return options;
  options.annulus_radius = header.valve->annulus_radius;
  const auto name = [&](std::int32_t port) {
    return port >= 0 && port < static_cast<std::int32_t>(header.ports.size()) ? header.ports[static_cast<std::size_t>(port)]
                                                                              : std::string();
  };
  options.ventricle = name(header.valve->ventricle_port), options.aorta = name(header.valve->aorta_port);
  return options;
}

const Figure* ValveSummary::find(const std::string& key) const {
  for (const Figure& figure : figures)
    if (figure.key == key) return &figure;
  return nullptr;
}

}  // namespace sim
