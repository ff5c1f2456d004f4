#include "app/stability_measures.h"

#include <algorithm>
#include <cmath>

#include "app/scene_table.h"
#include "sim/particles.h"

namespace app {

Series::Series(const sim::RunReader& run) {
  for (const auto& row : run.series())
    for (std::size_t k = 0; k < row.size(); ++k) columns[run.header().columns[k]].push_back(row[k]);
}

double Series::first(const std::string& name) const {
  const auto found = columns.find(name);
  return found == columns.end() || found->second.empty() ? 0 : found->second.front();
}

double Series::last(const std::string& name) const {
  const auto found = columns.find(name);
  return found == columns.end() || found->second.empty() ? 0 : found->second.back();
}

double Series::largest(const std::string& name) const {
  const auto found = columns.find(name);
  return found == columns.end() || found->second.empty() ? 0 : *std::max_element(found->second.begin(), found->second.end());
}

double energy_at_rest(const sim::RunReader& run) {
  const sim::RunFrame frame = run.frame(0);
  double particles = 0;
  for (std::uint8_t kind : frame.kind) particles += kind == static_cast<std::uint8_t>(sim::Kind::fluid);
  constexpr double density = 1000, speed = 0.01;
  return 0.5 * density * particles * std::pow(run.header().spacing, run.header().dimension) * speed * speed;
}

double energy_growth(const Series& series, double rest) {
  const auto at = [&](const char* name, std::size_t row) {
    const auto found = series.columns.find(name);
    return found == series.columns.end() ? 0.0 : found->second[row];
  };
  const std::size_t rows = series.columns.at("time").size();
  double growth = 0, scale = rest;
  const double first = at("kinetic_energy", 0) + at("elastic_energy", 0);
  for (std::size_t row = 0; row < rows; ++row) {
    const double energy = at("kinetic_energy", row) + at("elastic_energy", row), work = at("port_work", row) + at("load_work", row);
    growth = std::max(growth, energy - first - work);
    scale = std::max({scale, energy, std::abs(work)});
  }
  return scale > 0 ? growth / scale : 0;
}

double leaflet_speed(const sim::RunFrame& frame) {
  double fastest = 0;
  for (std::size_t i = 0; i < frame.size(); ++i)
    if (frame.kind[i] == static_cast<std::uint8_t>(sim::Kind::shell))
      fastest = std::max(fastest, double(std::hypot(frame.velocity[i][0], frame.velocity[i][1], frame.velocity[i][2])));
  return fastest;
}

double leak(const Series& series) {
  const auto &time = series.columns.at("time"), &in = series.columns.at("port.aorta.volume"),
             &out = series.columns.at("port.ventricle.volume");
  const std::size_t half = time.size() / 2;
  const double volume = 0.5 * ((in.back() - in[half]) - (out.back() - out[half]));
  constexpr double beat = 0.8, stroke = 70e-6;  // s, m³
  return std::abs(volume) / (time.back() - time[half]) * beat / stroke;
}

bool finite(const sim::RunFrame& frame) {
  for (std::size_t i = 0; i < frame.size(); ++i) {
    for (double x : frame.position[i])
      if (!std::isfinite(x)) return false;
    for (float v : frame.velocity[i])
      if (!std::isfinite(v)) return false;
    if (!std::isfinite(frame.pressure[i]) || !std::isfinite(frame.von_mises[i])) return false;
  }
  return true;
}

double apart(const std::filesystem::path& first, const std::filesystem::path& second) {
  const sim::RunReader a(first), b(second);
  const sim::RunFrame p = a.frame(a.frame_count() - 1), q = b.frame(b.frame_count() - 1);
  if (p.time != q.time || p.size() != q.size()) return infinite;
  std::map<std::int64_t, std::size_t> row;
  for (std::size_t i = 0; i < q.size(); ++i) row[q.id[i]] = i;
  double result = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto found = row.find(p.id[i]);
    if (found == row.end()) return infinite;
    for (std::size_t axis = 0; axis < 3; ++axis) result = std::max(result, std::abs(p.position[i][axis] - q.position[found->second][axis]));
  }
  return result;
}

std::string overload_told(const sim::RunReader& run) {
  for (const std::string& line : run.warnings())
    if (line.rfind("overloaded: ", 0) == 0) return line;
  return "";
}

double beats_apart(const Series& series, const std::string& column, double beat) {
  const auto &time = series.columns.at("time"), &value = series.columns.at(column);
  const auto rows = static_cast<std::size_t>(std::lround(beat / (time[1] - time[0])));
  const std::size_t beats = (value.size() - 1) / rows;
  if (beats < 4) return infinite;
  std::vector<double> mean(rows, 0);
  for (std::size_t b = 2; b < beats; ++b)
    for (std::size_t k = 0; k < rows; ++k) mean[k] += value[b * rows + k] / static_cast<double>(beats - 2);
  double largest = 0, worst = 0;
  for (double m : mean) largest = std::max(largest, std::abs(m));
  for (std::size_t b = 2; b < beats; ++b) {
    double sum = 0;
    for (std::size_t k = 0; k < rows; ++k) sum += std::pow(value[b * rows + k] - mean[k], 2);
    worst = std::max(worst, std::sqrt(sum / static_cast<double>(rows)));
  }
  return largest > 0 ? worst / largest : infinite;
}

}  // namespace app
