// The quantities that pictures show: where they come from in a run file, their ranges over runs, their scales.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "render/frame.h"
#include "sim/run_file.h"

namespace app {

using Range2 = std::array<double, 2>;  // lowest, highest; SI
using FieldRanges = std::map<std::string, Range2>;

// Fields of the blood, in the order of the particle set's fields, then of the solids.
inline const std::vector<std::string> fluid_fields = {"pressure", "speed"};
inline const std::vector<std::string> solid_fields = {"stress", "principal_stress", "displacement"};
bool is_fluid_field(const std::string& field);
// Index of the field within its list; throws std::invalid_argument naming the known ones.
int field_index(const std::string& field);

// The value of the field at a row, SI. `start` = positions at the first frame (for displacement).
float field_value(const std::string& field, const sim::RunFrame& frame, std::size_t row, const std::vector<std::array<double, 3>>& start);

// The range of each field over the runs (a sample of at most `sample` frames each), unsmoothed: within a frame, pressure between its 1st
// and 99th percentile, the others from 0 to their 99.5th (speed), 99th (stress) or largest (displacement); over a run's frames the widest
// but for the most extreme twentieth; of several runs the widest; ends rounded outwards.
FieldRanges field_ranges(const std::vector<const sim::RunReader*>& runs, std::size_t sample = 32);

// `pressure_units`: kPa, mmHg or Pa, for the blood's pressure; `map` empty = the field's own.
render::ColorScale field_scale(const std::string& field, Range2 range, const std::string& pressure_units, const std::string& map);

}  // namespace app
