#include "render/overlay.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "render/panel_painter.h"

namespace render {
namespace {

const Color ink(0.10f, 0.12f, 0.15f), faint(0.36f, 0.40f, 0.45f), rule(0.70f, 0.73f, 0.77f), alarm(0.72f, 0.27f, 0.02f), paper(1, 1, 1);

float as_float(int value) { return static_cast<float>(value); }

// Text on a light box, so that it is legible over anything.
void draw_name(Image& image, float x, float y, const std::string& text, const Color& color, Lettering& lettering) {
  const int size = lettering.size * 9 / 10;
  const float wide = lettering.regular.width(text, size), pad = 0.25f * as_float(size);
  fill(image, x - pad, y - as_float(size), wide + 2 * pad, 1.35f * as_float(size), paper, 0.72f);
  lettering.regular.draw(image, x, y, size, text, color);
}

// The text, cut with an ellipsis where it is wider than `room` pixels.
std::string shortened(const std::string& text, float room, int size, Lettering& lettering) {
  if (lettering.regular.width(text, size) <= room) return text;
  std::string cut = text;
  while (!cut.empty() && lettering.regular.width(cut + "\u2026", size) > room) {
    while (cut.size() > 1 && (static_cast<unsigned char>(cut.back()) >> 6) == 2) cut.pop_back();  // the tail of a UTF-8 letter
    cut.pop_back();
  }
  return cut + "\u2026";
}

// The words in lines that are no wider than `room` pixels, where words allow it.
std::vector<std::string> wrapped(const std::string& text, float room, Font& font, int size) {
  std::vector<std::string> lines;
  std::stringstream words(text);
  for (std::string word; words >> word;) {
    if (!lines.empty() && font.width(lines.back() + " " + word, size) <= room)
      lines.back() += " " + word;
    else
      lines.push_back(word);
  }
  return lines;
}

// The largest of 1, 2, 5 times a power of ten not above `most`.
double round_length(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0})
    if (step * power <= most) return step * power;
  return power;
}

std::string length_text(double metres) {
  char text[32];
  if (metres < 1e-6)
    std::snprintf(text, sizeof text, "%g nm", metres * 1e9);
  else if (metres < 1e-3)
    std::snprintf(text, sizeof text, "%g µm", metres * 1e6);
  else if (metres < 0.0999)
    std::snprintf(text, sizeof text, "%g mm", metres * 1e3);
  else if (metres < 0.999)
    std::snprintf(text, sizeof text, "%g cm", metres * 1e2);
  else
    std::snprintf(text, sizeof text, "%g m", metres);
  return text;
}

void draw_scale_bar(Image& image, const Rect& place, const Projection& projection, Lettering& lettering) {
  const double metres = round_length(0.22 * place.width / projection.pixels_per_metre);
  const float length = static_cast<float>(metres * projection.pixels_per_metre), em = as_float(lettering.size);
  const float x = as_float(place.x) + em, y = as_float(place.y + place.height) - em, thick = std::max(2.0f, 0.14f * em);
  fill(image, x - 0.3f * em, y - 1.45f * em, length + 0.6f * em, 1.8f * em, paper, 0.6f);
  fill(image, x, y - thick, length, thick, ink);
  for (const float end : {x, x + length - thick}) fill(image, end, y - 0.4f * em, thick, 0.4f * em, ink);
  lettering.regular.draw(image, x + 0.5f * length, y - 0.5f * em, lettering.size * 9 / 10, length_text(metres), ink, Align::center);
}

// The sum of all other directions as the picture shows them, y downwards; never zero.
Eigen::Vector2f others_in_picture(const Panel& panel, const Projection& projection, const Direction* but) {
  Eigen::Vector2f sum(1e-3f, 1e-3f);
  for (const Direction& other : panel.directions) {
    const Eigen::Vector3f seen = projection.view.block<3, 3>(0, 0) * other.vector;
    if (&other != but) sum += Eigen::Vector2f(seen.x(), -seen.y());
  }
  return sum;
}

void draw_orientation(Image& image, const Rect& place, const Panel& panel, const Projection& projection, Lettering& lettering) {
  const float em = as_float(lettering.size), arm = 1.9f * em;
  const float x = as_float(place.x + place.width) - 4.6f * em, y = as_float(place.y + place.height) - 2.5f * em;
  std::vector<std::pair<float, const Direction*>> far_to_near;
  for (const Direction& direction : panel.directions)
    far_to_near.emplace_back((projection.view.block<3, 3>(0, 0) * direction.vector).z(), &direction);
  std::stable_sort(far_to_near.begin(), far_to_near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [toward_eye, direction] : far_to_near) {
    const Eigen::Vector3f seen = projection.view.block<3, 3>(0, 0) * direction->vector;
    const float tip_x = x + arm * seen.x(), tip_y = y - arm * seen.y(), length = std::hypot(tip_x - x, tip_y - y);
    stroke(image, x, y, tip_x, tip_y, 0.16f * em, direction->color);
    if (length > 0.3f * arm) {
      const float ux = (tip_x - x) / length, uy = (tip_y - y) / length, head = 0.42f * em;
      for (const float side : {-0.6f, 0.6f})
        stroke(image, tip_x, tip_y, tip_x - head * (ux - side * uy), tip_y - head * (uy + side * ux), 0.16f * em, direction->color);
    } else {
      disc(image, x, y, 0.32f * em, direction->color);  // an arrow seen from its point, or from its feathers
      if (toward_eye < 0)
        for (const float side : {-0.16f, 0.16f})
          stroke(image, x - 0.16f * em, y - side * em, x + 0.16f * em, y + side * em, 0.09f * em, paper);
    }
    const int size = lettering.size * 8 / 10;
    const float wide = lettering.regular.width(direction->name, size);
    // The name stands beyond the tip; that of an arrow towards the eye opposite to the other arrows.
    Eigen::Vector2f beyond(tip_x - x, tip_y - y);
    if (length <= 0.3f * arm) beyond = -others_in_picture(panel, projection, direction);
    beyond.normalize();
    float text_x = (length > 0.3f * arm ? tip_x : x) + 0.5f * em * beyond.x() +
                   (beyond.x() < -0.3f  ? -wide
                    : beyond.x() > 0.3f ? 0.0f
                                        : -0.5f * wide);
    const float text_y = (length > 0.3f * arm ? tip_y : y) + 0.3f * em + 0.75f * em * beyond.y();
    text_x = std::min(text_x, as_float(place.x + place.width) - wide - 0.4f * em);
    lettering.regular.draw(image, text_x, text_y, size, direction->name, direction->color);
  }
}

void draw_marks(Image& image, const Rect& place, const Frame& frame, const Panel& panel, const Projection& projection,
                Lettering& lettering) {
  for (const int index : panel.marks) {
    const Mark& mark = frame.marks[index];
    if (mark.text.empty()) continue;
    const Eigen::Vector3f at = to_pixel(projection, mark.position);
    const float wide = lettering.regular.width(mark.text, lettering.size * 9 / 10), em = as_float(lettering.size);
    const float gap = mark.radius * projection.pixels_per_metre + 0.5f * em;
    float x = at.x() + gap;
    if (x + wide > as_float(place.width) - 0.5f * em) x = at.x() - gap - wide;
    const float y = std::clamp(at.y() + 0.33f * em, 1.2f * em, as_float(place.height) - 0.5f * em);
    draw_name(image, as_float(place.x) + x, as_float(place.y) + y, mark.text, 0.6f * mark.color, lettering);
  }
}

// The common span of all curves of a plot, time from value.
struct Span {
  double first = 1e300, last = -1e300, lowest = 1e300, highest = -1e300;
};
Span span_of(const Plot& plot) {
  Span span;
  for (const Curve& curve : plot.curves)
    for (std::size_t i = 0; i < curve.time.size(); ++i) {
      if (!std::isfinite(curve.value[i])) continue;
      span.first = std::min(span.first, curve.time[i]);
      span.last = std::max(span.last, curve.time[i]);
      span.lowest = std::min(span.lowest, curve.value[i]);
      span.highest = std::max(span.highest, curve.value[i]);
    }
  if (span.highest <= span.lowest) {
    span.lowest -= 0.5;
    span.highest += 0.5;
  }
  return span;
}

double value_at(const Curve& curve, double time) {
  const auto after = std::lower_bound(curve.time.begin(), curve.time.end(), time);
  if (after == curve.time.end()) return curve.value.back();
  const std::size_t i = static_cast<std::size_t>(after - curve.time.begin());
  if (i == 0) return curve.value.front();
  const double part = (time - curve.time[i - 1]) / (curve.time[i] - curve.time[i - 1]);
  return curve.value[i - 1] + part * (curve.value[i] - curve.value[i - 1]);
}

void draw_curve(Image& image, const Curve& curve, const auto& to_x, const auto& to_y, float width) {
  for (std::size_t i = 1; i < curve.time.size(); ++i)
    if (std::isfinite(curve.value[i - 1]) && std::isfinite(curve.value[i]))
      stroke(image, to_x(curve.time[i - 1]), to_y(curve.value[i - 1]), to_x(curve.time[i]), to_y(curve.value[i]), width, curve.color);
}

void draw_plot(Image& image, const Rect& place, const Plot& plot, const std::optional<double>& now, Lettering& lettering) {
  const Span span = span_of(plot);
  if (span.last <= span.first) return;
  const int small = lettering.size * 8 / 10;
  const float em = as_float(lettering.size);
  const float left = as_float(place.x) + 3.6f * em, right = as_float(place.x + place.width) - 1.7f * em;
  const float top = as_float(place.y) + 1.9f * em, bottom = as_float(place.y + place.height) - 1.7f * em;
  const double pad = 0.06 * (span.highest - span.lowest), low = span.lowest - pad, high = span.highest + pad;
  const auto to_x = [&](double t) { return left + static_cast<float>((t - span.first) / (span.last - span.first)) * (right - left); };
  const auto to_y = [&](double v) { return bottom - static_cast<float>((v - low) / (high - low)) * (bottom - top); };
  fill(image, left, top, right - left, bottom - top, paper);
  const Ticks up = round_ticks(low, high, 3), across = round_ticks(span.first, span.last, 8);
  for (const double v : up.values) {
    fill(image, left, to_y(v), right - left, 1, rule, 0.6f);
    lettering.regular.draw(image, left - 0.4f * em, to_y(v) + 0.3f * em, small, number_text(v, up.decimals), faint, Align::right);
  }
  for (const double t : across.values) {
    fill(image, to_x(t), bottom, 1, 0.3f * em, faint);
    lettering.regular.draw(image, to_x(t), bottom + 1.15f * em, small, number_text(t, across.decimals) + " s", faint, Align::center);
  }
  float x = left +
            lettering.bold.draw(image, left, top - 0.6f * em, small, plot.label + (plot.unit.empty() ? "" : " [" + plot.unit + "]"), ink) +
            em;
  const auto labelled = std::ranges::count_if(plot.curves, [](const Curve& c) { return !c.time.empty() && !c.label.empty(); });
  const float room = (right - x) / as_float(static_cast<int>(std::max<std::ptrdiff_t>(labelled, 1))) - 2.4f * em;
  for (const Curve& curve : plot.curves) {
    if (curve.time.empty()) continue;
    draw_curve(image, curve, to_x, to_y, std::max(1.5f, 0.11f * em));
    if (curve.label.empty()) continue;
    fill(image, x, top - 0.95f * em, 1.1f * em, std::max(2.0f, 0.16f * em), curve.color);
    x += 1.4f * em;
    x += lettering.regular.draw(image, x, top - 0.6f * em, small, shortened(curve.label, room, small, lettering), ink) + em;
  }
  if (!now || *now < span.first || *now > span.last) return;
  stroke(image, to_x(*now), top, to_x(*now), bottom, std::max(1.5f, 0.09f * em), ink, 0.7f);
  for (const Curve& curve : plot.curves)
    if (!curve.time.empty() && std::isfinite(value_at(curve, *now))) {
      disc(image, to_x(*now), to_y(value_at(curve, *now)), 0.32f * em, paper);
      disc(image, to_x(*now), to_y(value_at(curve, *now)), 0.24f * em, curve.color);
    }
}

}  // namespace

Layout lay_out(const Frame& frame, int width, int height) {
  if (width < 160 || height < 120)
    throw std::invalid_argument("a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                                " pixels is too small: use 160 x 120 or more");
  Layout layout;
  const int em = layout.text_size = std::max(9, static_cast<int>(std::lround(std::min(height / 50.0, width / 64.0))));
  layout.header = {0, 0, width, 33 * em / 10};
  const int lines = std::max<int>(1, static_cast<int>(std::min<std::size_t>(frame.warnings.size(), 3)));
  const int footer_height = (4 + 14 * lines) * em / 10;
  layout.footer = {0, height - footer_height, width, footer_height};
  const int plot_height = frame.plots.empty() ? 0 : std::min(9 * em, height / 4);
  layout.plots = {0, layout.footer.y - plot_height, width, plot_height};
  const int count = static_cast<int>(frame.panels.size()), columns = frame.columns > 0 ? std::min(frame.columns, count) : count;
  const int rows = (count + columns - 1) / columns, top = layout.header.height, space = layout.plots.y - top;
  for (int i = 0; i < count; ++i) {
    const int column = i % columns, row = i / columns;
    const int x = width * column / columns, y = top + space * row / rows;
    const int wide = width * (column + 1) / columns - x, bottom = top + space * (row + 1) / rows;
    int lines = 0;  // of words above the panels of this row
    for (int k = row * columns; k < std::min(count, (row + 1) * columns); ++k) {
      const Panel& panel = frame.panels[static_cast<std::size_t>(k)];
      lines = std::max(lines, !panel.note.empty() ? 2 : !panel.title.empty() ? 1 : 0);
    }
    const int words = lines == 0 ? 0 : (6 + 14 * lines) * em / 10;
    layout.titles.push_back({x, y, wide, words});
    layout.panels.push_back({x, y + words, wide, bottom - y - words});
  }
  return layout;
}

int legend_space(const Panel& panel, int text_size) { return panel.legends.empty() ? 0 : 68 * text_size / 10; }

Ticks round_ticks(double minimum, double maximum, int wanted) {
  Ticks ticks;
  const double rough = (maximum - minimum) / std::max(wanted, 1);
  if (!(rough > 0) || !std::isfinite(rough)) return {{minimum}, 0};
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double part = rough / power, step = power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
  ticks.decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  const double slack = 1e-9 * (maximum - minimum);
  for (double k = std::ceil((minimum - slack) / step); k * step <= maximum + slack; ++k) ticks.values.push_back(k == 0 ? 0.0 : k * step);
  return ticks;
}

std::string number_text(double value, int decimals) {
  char text[64];
  if (std::abs(value) >= 1e6 || decimals > 5)
    std::snprintf(text, sizeof text, "%.3g", value);
  else
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
  std::string result = text;
  if (!result.empty() && result[0] == '-') result = "\u2212" + result.substr(1);  // a true minus sign
  return result;
}

Rect color_bar_place(const Rect& panel, int n, int count, int text_size) {
  // Above each bar three lines with its name, beneath it two with the highest value; the orientation marker at the bottom.
  const int top = panel.y + 36 * text_size / 10, bottom = panel.y + panel.height - 50 * text_size / 10, gap = 55 * text_size / 10;
  const int share = std::max(1, (bottom + gap - 32 * text_size / 10 - top) / std::max(count, 1));
  const int width = std::max(8, 11 * text_size / 10);
  return {panel.x + panel.width - 55 * text_size / 10, top + n * share, width, std::max(10, share - gap)};
}

namespace {

// A pointer at the highest value from the bar's left side (at its end where the value lies beyond it), and the value in words beneath.
void draw_highest(Image& image, const Rect& bar, const ColorScale& scale, int decimals, Lettering& lettering) {
  const float em = as_float(lettering.size), right = as_float(bar.x) + 4.9f * em;
  const int small = lettering.size * 75 / 100;
  const double part = std::clamp((*scale.highest - scale.minimum) / (scale.maximum - scale.minimum), 0.0, 1.0);
  const float y = as_float(bar.y) + static_cast<float>(1 - part) * as_float(bar.height), tip = as_float(bar.x) - 3;
  for (const float side : {-0.3f, 0.3f}) stroke(image, tip, y, tip - 0.5f * em, y + side * em, std::max(1.5f, 0.12f * em), ink);
  const std::string value = number_text(*scale.highest * scale.factor, decimals) + " " + scale.unit;
  const float below = as_float(bar.y + bar.height);
  lettering.regular.draw(image, right, below + 1.2f * em, small, "highest now", faint, Align::right);
  lettering.regular.draw(image, right, below + 2.1f * em, small, value, ink, Align::right);
}

}  // namespace

void draw_color_bar(Image& image, const Rect& bar, const ColorScale& scale, Lettering& lettering) {
  const float em = as_float(lettering.size), right = as_float(bar.x) + 4.9f * em;
  const int small = lettering.size * 8 / 10;
  const std::vector<std::string> lines =
      wrapped(scale.label + (scale.unit.empty() ? "" : " [" + scale.unit + "]"), 6 * em, lettering.bold, small);
  for (std::size_t k = 0; k < lines.size(); ++k)
    lettering.bold.draw(image, right, as_float(bar.y) - (0.7f + 0.95f * as_float(static_cast<int>(lines.size() - 1 - k))) * em, small,
                        lines[k], ink, Align::right);
  fill(image, as_float(bar.x) - 2, as_float(bar.y) - 2, as_float(bar.width) + 4, as_float(bar.height) + 4, ink);
  for (int row = 0; row < bar.height; ++row)
    fill(image, as_float(bar.x), as_float(bar.y + row), as_float(bar.width), 1, map_color(scale.map, 1 - (row + 0.5) / bar.height));
  const double low = scale.minimum * scale.factor, high = scale.maximum * scale.factor;
  const Ticks ticks = round_ticks(low, high, std::max(2, std::min(8, bar.height / (2 * lettering.size))));
  const float text_x = as_float(bar.x + bar.width) + 0.75f * em;
  for (const double value : ticks.values) {
    const float y = as_float(bar.y) + static_cast<float>((high - value) / (high - low)) * as_float(bar.height);
    fill(image, as_float(bar.x + bar.width) + 2, y - 1, 0.35f * em, 2, ink);
    const std::string text = number_text(value, ticks.decimals);
    fill(image, text_x - 0.15f * em, y - 0.45f * em, lettering.regular.width(text, small) + 0.3f * em, 0.9f * em, paper, 0.5f);
    lettering.regular.draw(image, text_x, y + 0.3f * em, small, text, ink);
  }
  if (scale.highest) draw_highest(image, bar, scale, ticks.decimals, lettering);
}

void draw_panel_overlay(Image& image, const Rect& place, const Frame& frame, const Panel& panel, Lettering& lettering) {
  const Projection projection = panel_projection(frame, panel, place.width, place.height, legend_space(panel, lettering.size));
  const float em = as_float(lettering.size);
  draw_marks(image, place, frame, panel, projection, lettering);
  const int count = static_cast<int>(panel.legends.size());
  for (int n = 0; n < count; ++n)
    draw_color_bar(image, color_bar_place(place, n, count, lettering.size), frame.scales[panel.legends[n]], lettering);
  if (panel.scale_bar) draw_scale_bar(image, place, projection, lettering);
  draw_orientation(image, place, panel, projection, lettering);
}

void draw_panel_title(Image& image, const Rect& place, const Panel& panel, Lettering& lettering) {
  if (place.height <= 0) return;
  const float em = as_float(lettering.size), x = as_float(place.x) + em, room = as_float(place.width) - 1.5f * em;
  fill(image, as_float(place.x), as_float(place.y), as_float(place.width), as_float(place.height), Color(0.96f, 0.965f, 0.97f));
  lettering.bold.draw(image, x, as_float(place.y) + 1.4f * em, lettering.size,
                      shortened(panel.title,
                                room * lettering.regular.width(panel.title, lettering.size) /
                                    std::max(1.0f, lettering.bold.width(panel.title, lettering.size)),
                                lettering.size, lettering),
                      ink);
  const int small = lettering.size * 85 / 100;
  lettering.regular.draw(image, x, as_float(place.y) + 2.8f * em, small, shortened(panel.note, room, small, lettering), faint);
}

void draw_header(Image& image, const Rect& place, const Frame& frame, Lettering& lettering) {
  fill(image, as_float(place.x), as_float(place.y), as_float(place.width), as_float(place.height), paper);
  fill(image, as_float(place.x), as_float(place.y + place.height) - 1, as_float(place.width), 1, rule);
  const float em = as_float(lettering.size), right = as_float(place.x + place.width) - em;
  lettering.bold.draw(image, em, 1.45f * em, lettering.size * 11 / 10, frame.title, ink);

  std::string time = frame.time_text;
  if (time.empty() && frame.time) time = "t = " + number_text(*frame.time, 3) + " s";
  lettering.bold.draw(image, right, 1.45f * em, lettering.size * 11 / 10, time, ink, Align::right);
  std::string readouts;
  for (const std::string& readout : frame.readouts) readouts += (readouts.empty() ? "" : "    ") + readout;
  const int small = lettering.size * 85 / 100;
  const float taken =
      lettering.regular.draw(image, right, 2.7f * em, small, shortened(readouts, right - em, small, lettering), ink, Align::right);
  lettering.regular.draw(image, em, 2.7f * em, small, shortened(frame.subtitle, right - taken - 3 * em, small, lettering), faint);
}

void draw_footer(Image& image, const Rect& place, const Frame& frame, Lettering& lettering) {
  fill(image, as_float(place.x), as_float(place.y), as_float(place.width), as_float(place.height), paper);
  fill(image, as_float(place.x), as_float(place.y), as_float(place.width), 1, rule);
  const float em = as_float(lettering.size), right = as_float(place.x + place.width) - em;
  const int small = lettering.size * 85 / 100;
  const float last_line = as_float(place.y + place.height) - 0.6f * em;
  const float caption = lettering.regular.draw(image, right, last_line, small, frame.caption, faint, Align::right);
  const std::size_t shown = std::min<std::size_t>(frame.warnings.size(), 3);
  for (std::size_t i = 0; i < shown; ++i) {
    const bool last = i + 1 == shown;
    const float room = right - em - (last && caption > 0 ? caption + em : 0.0f);
    lettering.regular.draw(image, em, last_line - 1.4f * em * as_float(static_cast<int>(shown - 1 - i)), small,
                           shortened("\u26A0 " + frame.warnings[i], room, small, lettering), alarm);
  }
}

void draw_plots(Image& image, const Rect& place, const Frame& frame, Lettering& lettering) {
  if (place.height <= 0) return;
  fill(image, as_float(place.x), as_float(place.y), as_float(place.width), as_float(place.height), Color(0.96f, 0.965f, 0.97f));
  fill(image, as_float(place.x), as_float(place.y), as_float(place.width), 1, rule);
  const int count = static_cast<int>(frame.plots.size());
  for (int i = 0; i < count; ++i) {
    const int x = place.x + place.width * i / count;
    draw_plot(image, {x, place.y, place.x + place.width * (i + 1) / count - x, place.height}, frame.plots[i], frame.time, lettering);
  }
}

}  // namespace render
