// How a camera moves: from one view to another, and under the mouse. Pure functions.
#pragma once

#include "render/camera.h"

namespace render {

// Between two cameras: directions turned along the shortest arc at a constant rate, lengths blended. t is cut to [0, 1]; its ends are the
// cameras themselves.
Camera between(const Camera& from, const Camera& to, double t);
// Starts and ends at rest: 3 t² - 2 t³.
double eased(double t);

// Turned round the target: `right` and `down` are the mouse's way in radians (what is in front follows the mouse).
Camera orbited(const Camera& camera, float right, float down);
// Shifted in the picture's plane, so that a thing at the target follows the mouse; metres at the target.
Camera panned(const Camera& camera, float right, float down);
// factor > 1 brings things nearer; kept between 1/50 and 50 of `whole`, the width that shows everything.
Camera zoomed(const Camera& camera, float factor, float whole);

}  // namespace render
