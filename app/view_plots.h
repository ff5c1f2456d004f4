// Curves in the window's panels.
#pragma once

#include "app/view_model.h"

namespace app {

// Pressures, flow, orifice and stress of the run that is shown (and, thinner, of the one before), side by side in `width` x `height`
// points, with a cursor at the present moment. Returns the time at which the user holds the mouse down, else NaN.
double draw_curves(const ViewModel& model, float width, float height);

// The picked particle's history.
void draw_history(const Picked& picked, const render::ColorScale& unit, double now);

// The curves of a run: those of its pictures, and the flow and the stress where its series hold them.
std::vector<render::Plot> window_plots(const sim::RunReader& run, std::vector<render::Plot> plots);

}  // namespace app
