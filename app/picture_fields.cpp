#include "app/picture_fields.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace app {

bool is_fluid_field(const std::string& field) { return std::find(fluid_fields.begin(), fluid_fields.end(), field) != fluid_fields.end(); }

int field_index(const std::string& field) {
  std::string known;
  for (const auto* list : {&fluid_fields, &solid_fields})
    for (std::size_t i = 0; i < list->size(); ++i) {
      if ((*list)[i] == field) return static_cast<int>(i);
      known += (known.empty() ? "" : ", ") + (*list)[i];
    }
  throw std::invalid_argument("--field: there is no field '" + field + "'; use one of " + known);
}

float field_value(const std::string& field, const sim::RunFrame& frame, std::size_t row, const std::vector<std::array<double, 3>>& start) {
  if (field == "pressure") return frame.pressure[row];
  if (field == "speed") return std::hypot(frame.velocity[row][0], frame.velocity[row][1], frame.velocity[row][2]);
  if (field == "stress") return frame.von_mises[row];
  if (field == "principal_stress") return frame.principal_stress[row];
  if (row >= start.size()) return 0;
  const auto& now = frame.position[row];
  return static_cast<float>(std::hypot(now[0] - start[row][0], now[1] - start[row][1], now[2] - start[row][2]));
}

namespace {

struct Percentiles {
  double low, high;
};
Percentiles percentiles_of(const std::string& field) {
  if (field == "pressure") return {0.01, 0.99};
  if (field == "speed") return {0, 0.995};
  if (field == "displacement") return {0, 1};
  return {0, 0.99};
}

double percentile(std::vector<float>& values, double part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// A range below this is round-off of something at rest: it is not spread over the colours. SI
double least_span(const std::string& field) { return field == "displacement" ? 1e-9 : field == "speed" ? 1e-6 : 1e-3; }

// Ends rounded outwards to a step of 1, 2, 2.5 or 5 times a power of ten, of which the range holds four to ten: the colour bar ends at
// numbers that can be read.
Range2 rounded(Range2 range) {
  const double span = range[1] - range[0];
  if (!(span > 0)) return {range[0], range[0] + std::max(1e-6 * std::abs(range[0]), 1e-12)};
  const double rough = span / 7, power = std::pow(10.0, std::floor(std::log10(rough))), part = rough / power;
  const double step = power * (part <= 1 ? 1 : part <= 2 ? 2 : part <= 2.5 ? 2.5 : part <= 5 ? 5 : 10);
  return {std::floor(range[0] / step + 1e-9) * step, std::ceil(range[1] / step - 1e-9) * step};
}

bool carries(const std::string& field, std::uint8_t kind) {
  const auto k = static_cast<sim::Kind>(kind);
  return is_fluid_field(field) ? k == sim::Kind::fluid : k == sim::Kind::elastic || k == sim::Kind::shell;
}

// The percentiles of one frame, added to those of the run's other frames.
using FramePercentiles = std::map<std::string, std::array<std::vector<float>, 2>>;

void gather(FramePercentiles& found, const sim::RunFrame& frame, const std::vector<std::array<double, 3>>& start, bool valve) {
  for (const auto* list : {&fluid_fields, &solid_fields})
    for (const std::string& field : *list) {
      std::vector<float> values;
      for (std::size_t row = 0; row < frame.size(); ++row) {
        if (!carries(field, frame.kind[row])) continue;
        // A leaflet's particle that has not moved at all is held within the wall, where it is not shown.
        if (valve && !is_fluid_field(field) && row < start.size() && frame.position[row] == start[row]) continue;
        if (const float value = field_value(field, frame, row, start); std::isfinite(value)) values.push_back(value);
      }
      if (values.empty()) continue;
      const Percentiles part = percentiles_of(field);
      found[field][0].push_back(static_cast<float>(percentile(values, part.low)));
      found[field][1].push_back(static_cast<float>(percentile(values, part.high)));
    }
}

// A run's range goes from frame to frame, but not to the most extreme twentieth of them: a water hammer of a few milliseconds would
// otherwise set the scale of a whole beat. Fewer than twenty frames all count.
void widen(FieldRanges& ranges, FramePercentiles& found) {
  for (auto& [field, ends] : found) {
    const bool from_zero = field != "pressure" && field != "principal_stress", all = field == "displacement" || ends[0].size() < 20;
    const double low = from_zero ? 0 : percentile(ends[0], all ? 0 : 0.05), high = percentile(ends[1], all ? 1 : 0.95);
    const auto [entry, fresh] = ranges.emplace(field, Range2{low, high});
    if (!fresh) entry->second = {std::min(entry->second[0], low), std::max(entry->second[1], high)};
  }
}

}  // namespace

FieldRanges field_ranges(const std::vector<const sim::RunReader*>& runs, std::size_t sample) {
  FieldRanges ranges;
  for (const sim::RunReader* run : runs) {
    const std::size_t count = run->frame_count(), looked_at = std::min(count, std::max<std::size_t>(sample, 2));
    if (count == 0) continue;
    const auto start = run->frame(0).position;
    FramePercentiles found;
    for (std::size_t i = 0; i < looked_at; ++i)
      gather(found, run->frame(looked_at > 1 ? i * (count - 1) / (looked_at - 1) : 0), start, run->header().valve.has_value());
    widen(ranges, found);
  }
  for (auto& [field, range] : ranges) {
    if (field == "principal_stress") range[0] = std::min(range[0], 0.0);
    range[1] = std::max(range[1], range[0] + least_span(field));
    range = rounded(range);
  }
  return ranges;
}

render::ColorScale field_scale(const std::string& field, Range2 range, const std::string& pressure_units, const std::string& map) {
  render::ColorScale scale;
  scale.minimum = range[0];
  scale.maximum = range[1];
  const double largest = std::max(std::abs(range[0]), std::abs(range[1]));
  const auto pascals = [&] {
    scale.unit = largest >= 5e6 ? "MPa" : largest >= 500 ? "kPa" : "Pa";
    scale.factor = largest >= 5e6 ? 1e-6 : largest >= 500 ? 1e-3 : 1;
  };
  if (field == "pressure") {
    scale.label = "Pressure";
    scale.map = render::Colormap::viridis;
    pascals();
    if (pressure_units == "mmHg") {
      scale.unit = "mmHg";
      scale.factor = 1 / 133.322;
    } else if (pressure_units == "Pa") {
      scale.unit = "Pa";
      scale.factor = 1;
    }
  } else if (field == "speed") {
    scale.label = "Speed";
    scale.map = render::Colormap::cividis;
    scale.unit = largest >= 0.1 ? "m/s" : "mm/s";
    scale.factor = largest >= 0.1 ? 1 : 1e3;
  } else if (field == "displacement") {
    scale.label = "Displacement";
    scale.map = render::Colormap::plasma;
    scale.unit = largest >= 1 ? "m" : largest >= 1e-4 ? "mm" : "µm";
    scale.factor = largest >= 1 ? 1 : largest >= 1e-4 ? 1e3 : 1e6;
  } else {
    scale.label = field == "stress" ? "Von Mises stress" : "Largest principal stress";
    scale.map = render::Colormap::inferno;
    pascals();
  }
  if (!map.empty()) scale.map = render::colormap_by_name(map);
  return scale;
}

}  // namespace app
