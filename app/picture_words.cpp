// Titles, read-outs and plots of a run.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/make_frame.h"

namespace app {
namespace {

const render::Color ventricle_color(0.75f, 0.16f, 0.16f), aorta_color(0.10f, 0.32f, 0.66f);
const std::vector<render::Color> curve_colors = {
    {0.10f, 0.32f, 0.66f}, {0.85f, 0.45f, 0.05f}, {0.10f, 0.50f, 0.40f}, {0.55f, 0.20f, 0.55f}};
constexpr double pascals_per_mmHg = 133.322;

int column_index(const sim::RunHeader& header, const std::string& name) {
  const auto found = std::find(header.columns.begin(), header.columns.end(), name);
  return found == header.columns.end() ? -1 : static_cast<int>(found - header.columns.begin());
}

std::string port_name(const sim::RunHeader& header, int port) {
  return port >= 0 && port < static_cast<int>(header.ports.size()) ? header.ports[static_cast<std::size_t>(port)] : std::string();
}

render::Curve curve_of(const std::vector<std::vector<double>>& series, int column, const std::string& label, const render::Color& color,
                       double factor) {
  render::Curve curve{label, color, {}, {}};
  for (const auto& row : series) {
    curve.time.push_back(row[0]);
    curve.value.push_back(factor * row[static_cast<std::size_t>(column)]);
  }
  return curve;
}

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

// The row of the series nearest to the time; -1 where there is none.
int row_at(const std::vector<std::vector<double>>& series, double time) {
  int best = -1;
  for (std::size_t i = 0; i < series.size(); ++i)
    if (best < 0 || std::abs(series[i][0] - time) < std::abs(series[static_cast<std::size_t>(best)][0] - time)) best = static_cast<int>(i);
  return best;
}

}  // namespace

std::string pressure_text(double pascals) { return text("%.1f kPa", pascals / 1000) + text(" (%.0f mmHg)", pascals / pascals_per_mmHg); }

std::vector<render::Plot> make_plots(const sim::RunHeader& header, const std::vector<std::vector<double>>& series) {
  if (series.size() < 2) return {};
  std::vector<render::Plot> plots;
  if (header.valve) {
    render::Plot pressures{"Pressure", "mmHg", {}};
    for (const auto& [port, label, color] : {std::tuple{header.valve->ventricle_port, "left ventricle", ventricle_color},
                                             std::tuple{header.valve->aorta_port, "aorta", aorta_color}})
      if (const int column = column_index(header, "port." + port_name(header, port) + ".pressure"); column > 0)
        pressures.curves.push_back(curve_of(series, column, label, color, 1 / pascals_per_mmHg));
    if (!pressures.curves.empty()) plots.push_back(std::move(pressures));
    if (const int column = column_index(header, "orifice_area"); column > 0)
      plots.push_back({"Orifice area", "cm²", {curve_of(series, column, "", curve_colors[2], 1e4)}});
    if (!plots.empty()) return plots;
  }
  // The first probes, those of the first one's unit.
  const int first_metric = column_index(header, "maximum_speed");
  render::Plot probes;
  for (int column = 1; column < first_metric && probes.curves.size() < curve_colors.size(); ++column) {
    const std::string& unit = header.units[static_cast<std::size_t>(column)];
    if (!probes.curves.empty() && unit != probes.unit) continue;
    probes.unit = unit;
    probes.label = "Probes";
    probes.curves.push_back(
        curve_of(series, column, header.columns[static_cast<std::size_t>(column)], curve_colors[probes.curves.size()], 1));
  }
  if (probes.curves.empty()) return {};
  return {probes};
}

std::vector<std::string> make_readouts(const sim::RunHeader& header, const std::vector<std::vector<double>>& series, double time) {
  std::vector<std::string> readouts;
  const int row = row_at(series, time);
  if (!header.valve || row < 0) return readouts;
  const auto value = [&](const std::string& name, double& found) {
    const int column = column_index(header, name);
    if (column >= 0) found = series[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    return column >= 0;
  };
  double found = 0;
  if (value("port." + port_name(header, header.valve->ventricle_port) + ".pressure", found))
    readouts.push_back("LV " + pressure_text(found));
  if (value("port." + port_name(header, header.valve->aorta_port) + ".pressure", found))
    readouts.push_back("aorta " + pressure_text(found));
  if (value("orifice_area", found)) readouts.push_back("orifice " + text("%.2f cm²", 1e4 * found));
  if (value("port." + port_name(header, header.valve->ventricle_port) + ".flow", found))
    readouts.push_back("flow " + text("%.0f mL/s", 1e6 * found));
  return readouts;
}

std::string settings_text(const sim::RunHeader& header) {
  std::vector<std::string> parts;
  std::string last;
  for (const auto& body : header.bodies) {
    if (body.kind != sim::Kind::shell && body.kind != sim::Kind::elastic) continue;
    std::string part = body.kind == sim::Kind::shell && header.valve ? "leaflets" : body.name;
    part += text(" %.3g", body.youngs_modulus >= 1e9 ? body.youngs_modulus / 1e9 : body.youngs_modulus / 1e6) +
            (body.youngs_modulus >= 1e9 ? " GPa" : " MPa");
    if (body.thickness > 0) part += text(", %.3g mm", 1e3 * body.thickness);
    if (!body.material.empty()) part += ", " + body.material;
    if (part != last && parts.size() < 3) parts.push_back(part);
    last = part;
  }
  parts.push_back("spacing " + (header.spacing < 0.1 ? text("%.3g mm", 1e3 * header.spacing) : text("%.3g m", header.spacing)));
  parts.push_back(header.scheme + " scheme");
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : "  ·  ") + part;
  return all;
}

}  // namespace app
