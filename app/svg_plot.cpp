#include "app/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace app {
namespace {

constexpr double panel_width = 420, panel_height = 300, left = 70, right = 14, top = 34, bottom = 46;
const char* const colors[] = {"#c03028", "#2060b0", "#208040", "#a06000"};

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string text_at(double x, double y, const std::string& text, const char* anchor = "middle", int size = 12) {
  std::ostringstream out;
  out << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\" font-size=\"" << size << "\">" << escaped(text)
      << "</text>\n";
  return out.str();
}

// Steps of 1, 2 or 5 times a power of ten: four to eight of them over the range.
double tick_step(double range) {
  const double power = std::pow(10, std::floor(std::log10(range / 4)));
  const double lead = range / 4 / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

struct Range {
  double low = 1e300, high = -1e300;
  void add(double value) {
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  }
  void widen() {
    if (!(high >= low)) low = 0, high = 1;
    const double size = high - low > 0 ? high - low : std::max(std::abs(high), 1e-12);
    low -= 0.05 * size, high += 0.05 * size;
  }
};

std::string curve_panel(const PlotPanel& panel) {
  Range x, y;
  for (const PlotCurve& curve : panel.curves)
    for (std::size_t k = 0; k < curve.x.size(); ++k) x.add(curve.x[k]), y.add(curve.y[k]);
  x.widen(), y.widen();
  const double width = panel_width - left - right, height = panel_height - top - bottom;
  const auto at_x = [&](double value) { return left + (value - x.low) / (x.high - x.low) * width; };
  const auto at_y = [&](double value) { return top + (y.high - value) / (y.high - y.low) * height; };
  std::ostringstream out;
  out << "<rect x=\"" << left << "\" y=\"" << top << "\" width=\"" << width << "\" height=\"" << height
      << "\" fill=\"none\" stroke=\"#888\"/>\n";
  const double step_x = tick_step(x.high - x.low), step_y = tick_step(y.high - y.low);
  for (double v = std::ceil(x.low / step_x) * step_x; v <= x.high; v += step_x) {
    out << "<path d=\"M" << at_x(v) << " " << top << "V" << top + height << "\" stroke=\"#ddd\"/>\n";
    out << text_at(at_x(v), top + height + 15, number(std::abs(v) < 1e-9 * step_x ? 0 : v), "middle", 10);
  }
  for (double v = std::ceil(y.low / step_y) * step_y; v <= y.high; v += step_y) {
    out << "<path d=\"M" << left << " " << at_y(v) << "H" << left + width << "\" stroke=\"#ddd\"/>\n";
    out << text_at(left - 5, at_y(v) + 4, number(std::abs(v) < 1e-9 * step_y ? 0 : v), "end", 10);
  }
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const PlotCurve& curve = panel.curves[c];
    const char* color = colors[c % 4];
    std::ostringstream path;
    for (std::size_t k = 0; k < curve.x.size(); ++k) {
      if (!std::isfinite(curve.x[k]) || !std::isfinite(curve.y[k])) continue;
      if (curve.points)
        out << "<circle cx=\"" << at_x(curve.x[k]) << "\" cy=\"" << at_y(curve.y[k]) << "\" r=\"2.5\" fill=\"" << color << "\"/>\n";
      else
        path << (path.tellp() == 0 ? "M" : "L") << at_x(curve.x[k]) << " " << at_y(curve.y[k]);
    }
    if (!curve.points) out << "<path d=\"" << path.str() << "\" fill=\"none\" stroke=\"" << color << "\" stroke-width=\"1.6\"/>\n";
    const double row = top + 14 + 14 * static_cast<double>(c);
    out << "<rect x=\"" << left + 8 << "\" y=\"" << row - 8 << "\" width=\"10\" height=\"8\" fill=\"" << color << "\"/>\n";
    out << text_at(left + 22, row, curve.label, "start", 11);
  }
  out << text_at(left + width / 2, panel_height - 10, panel.x_label);
  return out.str();
}

// Horizontal bars of relative errors with a mark at each limit.
std::string bar_panel(const PlotPanel& panel) {
  const double start = 140, width = panel_width - start - 60;
  double most = 1e-300;
  for (const PlotBar& bar : panel.bars) most = std::max({most, bar.value, bar.limit});
  std::ostringstream out;
  const double pitch = std::min(28.0, (panel_height - top - 20) / static_cast<double>(std::max<std::size_t>(1, panel.bars.size())));
  for (std::size_t b = 0; b < panel.bars.size(); ++b) {
    const PlotBar& bar = panel.bars[b];
    const double y = top + 6 + pitch * static_cast<double>(b);
    const bool passed = bar.limit == 0 || bar.value <= bar.limit;
    out << "<rect x=\"" << start << "\" y=\"" << y << "\" width=\"" << std::max(1.0, bar.value / most * width) << "\" height=\""
        << 0.6 * pitch << "\" fill=\"" << (passed ? "#2060b0" : "#c03028") << "\"/>\n";
    if (bar.limit > 0)
      out << "<path d=\"M" << start + bar.limit / most * width << " " << y - 2 << "v" << 0.6 * pitch + 4
          << "\" stroke=\"#000\" stroke-width=\"1.5\"/>\n";
    out << text_at(start - 6, y + 0.5 * pitch, bar.label, "end", 10);
    out << text_at(panel_width - 4, y + 0.5 * pitch, number(100 * bar.value) + " %", "end", 10);
  }
  return out.str();
}

}  // namespace

std::string svg_plot(const std::string& title, const std::vector<PlotPanel>& panels) {
  const std::size_t columns = std::max<std::size_t>(1, std::min<std::size_t>(3, panels.size()));
  const std::size_t rows = (panels.size() + columns - 1) / columns;
  const double width = panel_width * static_cast<double>(columns), height = 30 + panel_height * static_cast<double>(rows);
  std::ostringstream out;
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << height
      << "\" font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
      << text_at(10, 21, title, "start", 15);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    out << "<g transform=\"translate(" << panel_width * static_cast<double>(p % columns) << ","
        << 30 + panel_height * static_cast<double>(p / columns) << ")\">\n"
        << text_at(panel_width / 2, 22, panels[p].title + (panels[p].y_label.empty() ? "" : ": " + panels[p].y_label), "middle", 12)
        << (panels[p].bars.empty() ? curve_panel(panels[p]) : bar_panel(panels[p])) << "</g>\n";
  }
  out << "</svg>\n";
  return out.str();
}

}  // namespace app
