#include "app/work_precision_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "render/text.h"

namespace app {
namespace {

using render::Align;
using render::Color;

// Okabe & Ito's palette: told apart with every common colour blindness.
const Color colors[] = {{0.00f, 0.45f, 0.70f}, {0.84f, 0.37f, 0.00f}, {0.00f, 0.62f, 0.45f}, {0.80f, 0.47f, 0.65f},
                        {0.90f, 0.62f, 0.00f}, {0.34f, 0.71f, 0.91f}, {0.55f, 0.50f, 0.10f}, {0.45f, 0.45f, 0.45f}};
const Color ink(0.10f, 0.10f, 0.12f), faint(0.86f, 0.86f, 0.88f), middle(0.55f, 0.55f, 0.58f), band(0.90f, 0.90f, 0.80f),
    front_color(0.12f, 0.12f, 0.14f), white(1, 1, 1);

constexpr float panel_width = 860, panel_height = 560, left = 92, right = 300, top = 58, bottom = 70, header = 64;

std::string number(double value, int digits = 3) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

// A logarithmic axis over whole ticks of 1, 2, 5.
struct LogAxis {
  double low = 0, high = 1;  // log10
  float from = 0, to = 1;    // pixels
  float at(double value) const { return from + static_cast<float>((std::log10(value) - low) / (high - low)) * (to - from); }
  std::vector<double> ticks() const {
    std::vector<double> list;
    const bool wide = high - low > 3.2;
    for (int power = static_cast<int>(std::floor(low)); power <= static_cast<int>(std::ceil(high)); ++power)
      for (double lead : {1.0, 2.0, 5.0}) {
        const double value = lead * std::pow(10, power);
        if ((wide && lead != 1) || std::log10(value) < low - 1e-9 || std::log10(value) > high + 1e-9) continue;
        list.push_back(value);
      }
    return list;
  }
};

struct Panel {
  render::Image& image;
  render::Font& font;
  render::Font& bold;
  const AccuracyStudy& study;
  int quantity;
  float x0, y0;
  LogAxis cost{}, error{};
  CostError points{};

  void choose_ranges() {
    double low_cost = 1e300, high_cost = 0, low = 0.008, high = 0.06;
    for (std::size_t k = 0; k < points.cost.size(); ++k) {
      if (!(points.cost[k] > 0) || !(points.error[k] > 0)) continue;
      low_cost = std::min(low_cost, points.cost[k]), high_cost = std::max(high_cost, points.cost[k]);
      low = std::min(low, 0.7 * points.error[k]), high = std::max(high, 1.4 * points.error[k]);
    }
    if (high_cost == 0) low_cost = 1, high_cost = 10;
    cost = {std::log10(0.7 * low_cost), std::log10(1.5 * high_cost), x0 + left, x0 + panel_width - right};
    if (cost.high - cost.low < 0.7) cost.low -= 0.2, cost.high += 0.5;
    error = {std::log10(std::max(low, high * 1e-6)), std::log10(high), y0 + panel_height - bottom, y0 + top};
  }

  void draw_axes() {
    render::fill(image, x0 + left, y0 + top, panel_width - left - right, panel_height - top - bottom, white);
    const std::size_t q = static_cast<std::size_t>(quantity);
    if (q < study.uncertainty.size() && study.uncertainty[q] > 0) {
      const float level = std::clamp(error.at(study.uncertainty[q]), error.to, error.from);
      render::fill(image, x0 + left, level, panel_width - left - right, error.from - level, band);
    }
    for (double tick : cost.ticks()) {
      render::stroke(image, cost.at(tick), error.from, cost.at(tick), error.to, 1, faint);
      font.draw(image, cost.at(tick), error.from + 20, 15, number(tick), ink, Align::center);
    }
    for (double tick : error.ticks()) {
      render::stroke(image, cost.from, error.at(tick), cost.to, error.at(tick), 1, faint);
      font.draw(image, cost.from - 8, error.at(tick) + 5, 15, number(100 * tick) + " %", ink, Align::right);
    }
    render::stroke(image, cost.from, error.from, cost.to, error.from, 1.5f, ink);
    render::stroke(image, cost.from, error.from, cost.from, error.to, 1.5f, ink);
    font.draw(image, 0.5f * (cost.from + cost.to), error.from + 46, 16,
              study.clock == CostClock::wall ? "wall time, s" : "processor time of all threads, s", ink, Align::center);
    bold.draw(image, x0 + left, y0 + top - 16, 19, study.quantities[q] + ": relative error", ink);
  }

  void dashes(float xa, float ya, float xb, float yb, const Color& color) {
    const float length = std::hypot(xb - xa, yb - ya);
    for (float s = 0; s < length; s += 11) {
      const float a = s / length, b = std::min(1.0f, (s + 6) / length);
      render::stroke(image, xa + a * (xb - xa), ya + a * (yb - ya), xa + b * (xb - xa), ya + b * (yb - ya), 1.4f, color);
    }
  }

  // Where the front reaches 5, 2 and 1 %.
  void draw_goals(const std::vector<std::size_t>& front) {
    std::vector<double> front_cost, front_error;
    for (std::size_t k : front) front_cost.push_back(points.cost[k]), front_error.push_back(points.error[k]);
    for (const double wanted : {0.05, 0.02, 0.01}) {
      const auto reached = cost_to_reach(front_cost, front_error, wanted);
      if (!reached) continue;
      const float x = std::clamp(cost.at(*reached), cost.from, cost.to), y = error.at(wanted);
      dashes(cost.from, y, x, y, middle);
      dashes(x, y, x, error.from, middle);
      font.draw(image, x + 4,
                error.from - 6 -
                    (wanted == 0.02   ? 18.0f
                     : wanted == 0.05 ? 36.0f
                                      : 0.0f),
                14, number(100 * wanted) + " %: " + number(*reached) + " s", middle);
    }
  }

  void mark(std::size_t k, const Color& color, float radius) {
    const float x = cost.at(points.cost[k]), y = error.at(points.error[k]);
    if (study.points[k].scene_itself)
      render::fill(image, x - radius - 1, y - radius - 1, 2 * radius + 2, 2 * radius + 2, color);
    else
      render::disc(image, x, y, radius, color);
  }

  bool shown(std::size_t k) const { return points.cost[k] > 0 && points.error[k] > 0; }

  // The curve of a knob runs through the ladder's point that it was varied at, in the order of the knob's values.
  std::vector<std::size_t> curve_points(const std::string& name) const {
    std::vector<std::size_t> list;
    for (std::size_t k = 0; k < study.points.size(); ++k)
      if (study.points[k].curve == name && shown(k)) list.push_back(k);
    if (name == "spacing") {
      std::sort(list.begin(), list.end(), [&](std::size_t a, std::size_t b) { return study.points[a].spacing > study.points[b].spacing; });
      return list;
    }
    std::sort(list.begin(), list.end(), [&](std::size_t a, std::size_t b) { return points.cost[a] < points.cost[b]; });
    for (std::size_t base : ladder_of(study))
      if (!list.empty() && shown(base) && study.points[base].spacing == study.points[list.front()].spacing &&
          name.find('=') == std::string::npos) {
        const auto place = std::find_if(list.begin(), list.end(), [&](std::size_t k) { return points.cost[k] > points.cost[base]; });
        list.insert(place, base);
        break;
      }
    return list;
  }

  void draw() {
    points = cost_and_error(study, quantity);
    choose_ranges();
    draw_axes();
    const std::vector<std::size_t> front = pareto_front(points.cost, points.error);
    draw_goals(front);
    float legend = y0 + top + 8;
    const float legend_x = x0 + panel_width - right + 18;
    const auto entry = [&](const std::string& words, const auto& sign) {
      sign(legend_x + 12, legend);
      font.draw(image, legend_x + 32, legend + 5, 15, words, ink);
      legend += 24;
    };
    for (std::size_t k = 1; k < front.size(); ++k)
      render::stroke(image, cost.at(points.cost[front[k - 1]]), error.at(points.error[front[k - 1]]), cost.at(points.cost[front[k]]),
                     error.at(points.error[front[k]]), 9, front_color, 0.18f);
    std::vector<std::string> names;
    for (const AccuracyPoint& point : study.points)
      if (point.curve != "seed" && std::find(names.begin(), names.end(), point.curve) == names.end()) names.push_back(point.curve);
    for (std::size_t c = names.size(); c-- > 0;) {
      const Color& color = colors[c % 8];
      const std::vector<std::size_t> list = curve_points(names[c]);
      for (std::size_t k = 1; k < list.size(); ++k)
        render::stroke(image, cost.at(points.cost[list[k - 1]]), error.at(points.error[list[k - 1]]), cost.at(points.cost[list[k]]),
                       error.at(points.error[list[k]]), names[c] == "spacing" ? 3.0f : 1.6f, color);
      for (std::size_t k : list)
        if (study.points[k].curve == names[c]) mark(k, color, names[c] == "spacing" ? 6.0f : 4.5f);
    }
    for (std::size_t k : front) {
      const float x = cost.at(points.cost[k]), y = error.at(points.error[k]);
      for (int s = 0; s < 36; ++s) {
        const float a = 6.2831853f * static_cast<float>(s) / 36, b = 6.2831853f * static_cast<float>(s + 1) / 36;
        render::stroke(image, x + 10 * std::cos(a), y + 10 * std::sin(a), x + 10 * std::cos(b), y + 10 * std::sin(b), 1.6f, front_color);
      }
    }
    for (std::size_t k : curve_points("spacing")) {
      const double mm = 1e3 * study.points[k].spacing;
      font.draw(image, cost.at(points.cost[k]) + 13, error.at(points.error[k]) - 9, 14, number(mm) + " mm", colors[0]);
    }
    for (std::size_t c = 0; c < names.size(); ++c)
      entry(names[c].rfind("scheme.", 0) == 0 ? names[c].substr(7) : names[c], [&](float x, float y) {
        render::stroke(image, x - 11, y, x + 11, y, c == 0 ? 3.0f : 1.6f, colors[c % 8]);
        render::disc(image, x, y, c == 0 ? 6.0f : 4.5f, colors[c % 8]);
      });
    const std::size_t q = static_cast<std::size_t>(quantity);
    entry("the scene's own settings", [&](float x, float y) { render::fill(image, x - 6, y - 6, 12, 12, colors[0]); });
    entry("front: none cheaper and better", [&](float x, float y) { render::stroke(image, x - 11, y, x + 11, y, 9, front_color, 0.3f); });
    if (q < study.noise.size() && study.noise[q] > 0) {
      const float y = error.at(study.noise[q]);
      if (y > error.to && y < error.from) dashes(cost.from, y, cost.to, y, colors[3]);
      entry("noise " + number(100 * study.noise[q], 2) + " %", [&](float x, float line) { dashes(x - 11, line, x + 11, line, colors[3]); });
    }
    if (q < study.uncertainty.size() && study.uncertainty[q] > 0)
      entry("reference known to " + number(100 * study.uncertainty[q], 2) + " %",
            [&](float x, float y) { render::fill(image, x - 11, y - 7, 22, 14, band); });
    std::vector<double> spacing, ladder_error;
    for (std::size_t k : curve_points("spacing")) spacing.push_back(study.points[k].spacing), ladder_error.push_back(points.error[k]);
    const auto order = observed_order(spacing, ladder_error);
    entry(order ? "observed order " + number(order->exponent, 2) : "no order: errors don't fall", [](float, float) {});
  }
};

}  // namespace

render::Image work_precision_picture(const AccuracyStudy& study) {
  const std::size_t panels = std::min<std::size_t>(6, study.quantities.size());
  const int columns = panels > 1 ? 2 : 1, rows = static_cast<int>((std::max<std::size_t>(1, panels) + 1) / 2);
  render::Image image(static_cast<int>(panel_width) * columns, static_cast<int>(header + panel_height * static_cast<float>(rows)) + 20);
  std::fill(image.rgba.begin(), image.rgba.end(), 255);
  render::Font font, bold(true);
  bold.draw(image, 24, 32, 23, study.title, ink);
  std::string words =
      "errors against " + study.against + "; " + std::to_string(study.threads) + (study.threads == 1 ? " thread" : " threads");
  for (std::size_t q = panels; q < study.quantities.size(); ++q) words += (q == panels ? "; not drawn: " : ", ") + study.quantities[q];
  font.draw(image, 24, 58, 16, words, middle);
  for (std::size_t q = 0; q < panels; ++q) {
    Panel panel{image,
                font,
                bold,
                study,
                static_cast<int>(q),
                panel_width * static_cast<float>(q % 2),
                header + panel_height * static_cast<float>(q / 2)};
    panel.draw();
  }
  return image;
}

}  // namespace app
