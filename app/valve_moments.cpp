#include "app/valve_moments.h"

#include <algorithm>
#include <cmath>

namespace app {
namespace {

// The middle one of each value and its neighbours.
std::vector<double> median_of_three(const std::vector<double>& values) {
  std::vector<double> result = values;
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    result[i] = std::max(std::min(values[i - 1], values[i]), std::min(std::max(values[i - 1], values[i]), values[i + 1]));
  return result;
}

double largest_size(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

}  // namespace

std::optional<ValveMoments> valve_moments(const std::vector<double>& time, const std::vector<double>& area,
                                          const std::vector<double>& flow) {
  constexpr double least_opening = 10e-6;  // m2
  if (time.size() < 3 || area.size() != time.size()) return std::nullopt;
  const std::vector<double> smooth = area.size() >= 20 ? median_of_three(area) : area;  // few rows hold no single row of noise
  const auto open = static_cast<std::size_t>(std::max_element(smooth.begin(), smooth.end()) - smooth.begin());
  const double largest = smooth[open];
  if (largest < least_opening) return std::nullopt;
  std::size_t opened = 0, closing = open;
  while (opened < open && smooth[opened] < 0.5 * largest) ++opened;
  while (closing + 1 < time.size() && smooth[closing] >= 0.5 * largest) ++closing;
  ValveMoments moments{time[opened], time[open], time[closing], time.back(), largest, area.back()};
  if (smooth[closing] >= 0.5 * largest) return moments;  // it never closes
  // The closed phase lasts until the orifice grows again past half of the largest. Its first quarter rings after the closure and its
  // last tenth may see the next opening: neither is at rest.
  std::size_t end = closing;
  while (end + 1 < time.size() && smooth[end + 1] < 0.5 * largest) ++end;
  const std::size_t from = closing + (end - closing) / 4, to = end - (end - closing) / 10;
  const double most_flow = flow.size() == time.size() ? largest_size(flow) : 0;
  double least = 1e300;
  for (std::size_t i = from; i <= to; ++i) {
    const double score = smooth[i] / largest + (most_flow > 0 ? std::abs(flow[i]) / most_flow : 0);
    if (score >= least) continue;
    least = score;
    moments.closed = time[i], moments.closed_area = area[i];
  }
  return moments;
}

std::optional<ValveMoments> valve_moments(const sim::RunReader& run) {
  const sim::RunHeader& header = run.header();
  if (!header.valve) return std::nullopt;
  std::vector<double> flow;
  if (const int port = header.valve->ventricle_port; port >= 0 && port < static_cast<int>(header.ports.size()))
    flow = run.column("port." + header.ports[static_cast<std::size_t>(port)] + ".flow");
  return valve_moments(run.column("time"), run.column("orifice_area"), flow);
}

}  // namespace app
