// What the explicit sub-steps of shells are limited by.
#pragma once

#include "sim/shell.h"

namespace sim {

// Highest frequency of the unloaded shells, fibres and dashpots aside, by power iteration on differences of the forces: rad/s; 0 where all
// rows are held.
template <int D>
double highest_frequency(const ShellElasticity<D>& shells);

}  // namespace sim
