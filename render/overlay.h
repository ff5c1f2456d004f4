// What is written on a picture: colour bars, scale bar, orientation marker, names, plots, title and warnings.
#pragma once

#include <string>
#include <vector>

#include "render/camera.h"
#include "render/frame.h"
#include "render/image.h"
#include "render/text.h"

namespace render {

// Pixels.
struct Rect {
  int x = 0, y = 0, width = 0, height = 0;
};

// Pixels at a panel's right edge that its colour bars take; 0 where it has none.
int legend_space(const Panel& panel, int text_size);

// The fonts and sizes of one picture.
struct Lettering {
  Font regular{false}, bold{true};
  int size = 20;  // pixels, of running text
};

// Where the parts of a picture lie. Throws std::invalid_argument where the picture is too small to hold them.
struct Layout {
  Rect header, footer, plots;
  std::vector<Rect> titles, panels;  // each panel's words stand above its picture, so that nothing hides behind them
  int text_size = 20;
};
Layout lay_out(const Frame& frame, int width, int height);

// Round numbers within [minimum, maximum], about `wanted` of them, and how many decimals they need.
struct Ticks {
  std::vector<double> values;
  int decimals = 0;
};
Ticks round_ticks(double minimum, double maximum, int wanted);
std::string number_text(double value, int decimals);

// Where the colour bar of the panel's n-th of `count` legends lies (the coloured part alone).
Rect color_bar_place(const Rect& panel, int n, int count, int text_size);
void draw_color_bar(Image& image, const Rect& bar, const ColorScale& scale, Lettering& lettering);

void draw_panel_overlay(Image& image, const Rect& place, const Frame& frame, const Panel& panel, Lettering& lettering);
void draw_panel_title(Image& image, const Rect& place, const Panel& panel, Lettering& lettering);
void draw_header(Image& image, const Rect& place, const Frame& frame, Lettering& lettering);
void draw_footer(Image& image, const Rect& place, const Frame& frame, Lettering& lettering);
void draw_plots(Image& image, const Rect& place, const Frame& frame, Lettering& lettering);

}  // namespace render
