// What two runs differ by, on the same leaflets: colours of a third picture beside them.
#pragma once

#include <string>

#include "app/make_frame.h"

namespace app {

// `second` as a frame whose solids carry, in each field, its own value minus that of `first` at the same particle, on a blue - grey -
// orange scale of +-extent[k] (SI, per entry of solid_fields, > 0). Panels that show the blood are left out. Throws std::invalid_argument
// (one line) where the leaflets of both are not the same particles, or no panel shows a solid.
render::Frame difference_frame(const render::Frame& first, const render::Frame& second, const std::vector<double>& extent);

// The 99th percentile of the size of the differences between two frames, per entry of solid_fields; 0 where there is none.
std::vector<double> difference_extent(const render::Frame& first, const render::Frame& second);

}  // namespace app
