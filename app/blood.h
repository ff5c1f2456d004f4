// Blood by its haematocrit.
#pragma once

#include "sim/scene_description.h"

namespace app {

// Herschel-Bulkley constants of blood at 37 C; hematocrit in per cent, 0 to 75.
sim::HerschelBulkley blood_rheology(double hematocrit);
// kg/m3: plasma 1025, cells 1100, mixed by volume.
double blood_density(double hematocrit);

}  // namespace app
