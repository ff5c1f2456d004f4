// The work-precision picture: log error over log cost, a panel a quantity, a curve a knob. Drawn without a display.
#pragma once

#include "app/work_precision.h"
#include "render/image.h"

namespace app {

// At most six quantities; further ones are named below.
render::Image work_precision_picture(const AccuracyStudy& study);

}  // namespace app
