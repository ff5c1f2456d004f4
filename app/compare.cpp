#include "app/compare.h"

#include <algorithm>
#include <cmath>

namespace app {
namespace {

double interpolated(const std::vector<double>& at, const std::vector<double>& value, double x) {
  if (x <= at.front()) return value.front();
  if (x >= at.back()) return value.back();
  const std::size_t upper = static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), x) - at.begin());
  const double share = (x - at[upper - 1]) / (at[upper] - at[upper - 1]);
  return value[upper - 1] + share * (value[upper] - value[upper - 1]);
}

// Relative L2 of a curve against the reference's points that it covers.
void compare_curves(Comparison& result, const std::vector<double>& at, const std::vector<double>& measured,
                    const std::vector<std::vector<double>>& table) {
  double difference = 0, norm = 0, square = 0;
  for (const auto& row : table) {
    const double slack = 1e-9 * (at.back() - at.front());
    if (row[0] < at.front() - slack || row[0] > at.back() + slack) continue;
    const double value = interpolated(at, measured, row[0]);
    result.at.push_back(row[0]), result.measured_curve.push_back(value), result.reference_curve.push_back(row[1]);
    difference += (value - row[1]) * (value - row[1]), norm += row[1] * row[1], square += value * value;
  }
  const double count = static_cast<double>(std::max<std::size_t>(1, result.at.size()));
  result.measured = std::sqrt(square / count), result.reference = std::sqrt(norm / count);
  result.error = norm > 0 ? std::sqrt(difference / norm) : std::sqrt(difference / count);
}

Comparison start(const ReferenceSpec& reference, const std::string& quantity) {
  Comparison result;
  result.quantity = quantity, result.source = reference.source, result.uncertainty = reference.uncertainty, result.limit = reference.limit;
  return result;
}

// A profile along a line: the coordinate is the one along which the line runs most.
Comparison compare_line(const ReferenceSpec& reference, const sim::RunReader& run, const sim::RunHeader::LineInfo& line) {
  Comparison result = start(reference, reference.probe);
  const auto times = run.column("time");
  std::size_t row = times.size() - 1;
  if (reference.time)
    for (std::size_t k = 0; k < times.size(); ++k)
      if (std::abs(times[k] - *reference.time) < std::abs(times[row] - *reference.time)) row = k;
  result.time = times[row];
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(line.points.back()[k] - line.points.front()[k]) > std::abs(line.points.back()[axis] - line.points.front()[axis])) axis = k;
  std::size_t component = 0;
  for (std::size_t k = 0; k < line.components.size(); ++k)
    if (line.components[k] == "value." + reference.component) component = k;
  if (!reference.component.empty() && line.components[component] != "value." + reference.component)
    refuse(reference.spot, "the probe has no component \"" + reference.component + "\"");
  const std::vector<double> values = run.line(line.name)[row];
  std::vector<std::pair<double, double>> points;
  for (std::size_t k = 0; k < line.points.size(); ++k)
    points.emplace_back(line.points[k][static_cast<std::size_t>(axis)], values[k * line.components.size() + component]);
  std::sort(points.begin(), points.end());
  std::vector<double> at, measured;
  for (const auto& [x, value] : points) at.push_back(x), measured.push_back(value);
  compare_curves(result, at, measured, read_number_table(reference.table, reference.spot));
  return result;
}

}  // namespace

std::vector<Comparison> compare_with_references(const SceneFile& scene, const sim::RunReader& run) {
  std::vector<Comparison> result;
  const std::vector<double> times = run.column("time");
  if (times.empty()) return result;
  for (const ReferenceSpec& reference : scene.references) {
    const auto& lines = run.header().lines;
    const auto line = std::find_if(lines.begin(), lines.end(), [&](const auto& one) { return one.name == reference.probe; });
    if (line != lines.end()) {
      if (reference.table.empty()) refuse(reference.spot, "a line probe needs a table", "give table = \"profile.csv\" (coordinate, value)");
      result.push_back(compare_line(reference, run, *line));
      continue;
    }
    if (!reference.table.empty()) {
      result.push_back(start(reference, reference.probe + (reference.component.empty() ? "" : "." + reference.component)));
      const std::vector<double> curve = run.column(result.back().quantity);
      if (curve.empty())
        refuse(reference.spot, "the run has no column \"" + result.back().quantity + "\"", "give component = \"x\" or the like");
      compare_curves(result.back(), times, curve, read_number_table(reference.table, reference.spot));
      result.back().time = times.back();
    }
    for (const auto& [component, expected] : reference.values) {
      result.push_back(start(reference, reference.probe + (component.empty() ? "" : "." + component)));
      Comparison& one = result.back();
      const std::vector<double> curve = run.column(one.quantity);
      if (curve.empty()) refuse(reference.spot, "the run has no column \"" + one.quantity + "\"", "name a component that the probe has");
      one.time = reference.time.value_or(times.back());
      one.measured = interpolated(times, curve, one.time), one.reference = expected;
      one.error = std::abs(one.measured - expected) / (expected != 0 ? std::abs(expected) : 1);
    }
  }
  return result;
}

nlohmann::json comparison_json(const Comparison& c) {
  nlohmann::json json{{"quantity", c.quantity},   {"time", c.time},      {"measured", c.measured},
                      {"reference", c.reference}, {"error", c.error},    {"uncertainty", c.uncertainty},
                      {"source", c.source},       {"passed", c.passed()}};
  if (c.limit) json["limit"] = *c.limit;
  return json;
}

}  // namespace app
