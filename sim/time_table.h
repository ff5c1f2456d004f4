// How far something has come whose speed is a table of time.
#pragma once

#include "sim/scene_description.h"

namespace sim {

// Integral of the table's value from time 0 to t >= 0, exact; a table that repeats does so from time 0.
double integral(const TimeTable& table, double t);

}  // namespace sim
