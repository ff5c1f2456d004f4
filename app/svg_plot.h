// Small line plots as SVG text: panels side by side, each with axes, curves and a legend. For reports that need no window and no library.
#pragma once

#include <string>
#include <vector>

namespace app {

struct PlotCurve {
  std::string label;
  std::vector<double> x, y;  // same length
  bool points = false;       // markers instead of a line
};

struct PlotBar {
  std::string label;
  double value = 0, limit = 0;  // limit 0 = none
};

// A panel holds curves, or bars (each with a mark at its limit).
struct PlotPanel {
  std::string title, x_label, y_label;
  std::vector<PlotCurve> curves;
  std::vector<PlotBar> bars;
};

// One SVG document; panels of 420 x 300 px, three a row. Values that are not finite are left out.
std::string svg_plot(const std::string& title, const std::vector<PlotPanel>& panels);

}  // namespace app
