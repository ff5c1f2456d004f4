#include "app/view_plots.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace app {
namespace {

ImU32 color_of(const render::Color& color, float opacity) {
  return ImGui::ColorConvertFloat4ToU32(ImVec4(color.x(), color.y(), color.z(), opacity));
}

struct Span {
  double first = 1e300, last = -1e300, low = 1e300, high = -1e300;
  void add(const render::Curve& curve) {
    for (std::size_t i = 0; i < curve.time.size(); ++i) {
      if (!std::isfinite(curve.value[i])) continue;
      first = std::min(first, curve.time[i]), last = std::max(last, curve.time[i]);
      low = std::min(low, curve.value[i]), high = std::max(high, curve.value[i]);
    }
  }
  bool empty() const { return !(last > first); }
};

// The curves in a frame of their own; returns the time under the mouse while it is held down, else NaN.
double draw_plot(const char* id, const render::Plot& plot, const render::Plot* ghost, double now, ImVec2 size) {
  Span span;
  for (const render::Curve& curve : plot.curves) span.add(curve);
  if (ghost)
    for (const render::Curve& curve : ghost->curves) span.add(curve);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton(id, ImVec2(std::max(size.x, 8.0f), std::max(size.y, 8.0f)));
  if (span.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (!(span.high > span.low)) span.high = span.low + 1;
  const float line = ImGui::GetTextLineHeight(), left = corner.x + 46, right = corner.x + size.x - 10;
  const float top = corner.y + line + 4, bottom = corner.y + size.y - 6;
  const double pad = 0.05 * (span.high - span.low), low = span.low - pad, high = span.high + pad;
  const auto at = [&](double t, double v) {
    return ImVec2(left + static_cast<float>((t - span.first) / (span.last - span.first)) * (right - left),
                  bottom - static_cast<float>((v - low) / (high - low)) * (bottom - top));
  };
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(ImVec2(left, top), ImVec2(right, bottom), IM_COL32(255, 255, 255, 255));
  list->AddRect(ImVec2(left, top), ImVec2(right, bottom), IM_COL32(178, 186, 196, 255));
  char text[64];
  for (const double value : {span.low, span.high}) {
    std::snprintf(text, sizeof text, "%.3g", std::abs(value) < 1e-6 * std::max(std::abs(low), std::abs(high)) ? 0.0 : value);
    list->AddText(ImVec2(left - 4 - ImGui::CalcTextSize(text).x, at(span.first, value).y - 0.5f * line), IM_COL32(92, 102, 115, 255), text);
  }
  float x = left;
  const auto write = [&](const std::string& words, ImU32 color) {
    list->AddText(ImVec2(x, corner.y), color, words.c_str());
    x += ImGui::CalcTextSize(words.c_str()).x + 12;
  };
  write(plot.label + (plot.unit.empty() ? "" : " [" + plot.unit + "]"), IM_COL32(26, 31, 38, 255));
  const auto draw = [&](const render::Curve& curve, float opacity, float width) {
    std::vector<ImVec2> points;
    for (std::size_t i = 0; i < curve.time.size(); ++i)
      if (std::isfinite(curve.value[i])) points.push_back(at(curve.time[i], curve.value[i]));
    for (std::size_t i = 1; i < points.size(); ++i) list->AddLine(points[i - 1], points[i], color_of(curve.color, opacity), width);
  };
  if (ghost)
    for (const render::Curve& curve : ghost->curves) draw(curve, 0.35f, 1.2f);
  for (const render::Curve& curve : plot.curves) {
    draw(curve, 1, 1.8f);
    if (!curve.label.empty()) write(curve.label, color_of(curve.color, 1));
  }
  if (now >= span.first && now <= span.last)
    list->AddLine(ImVec2(at(now, low).x, top), ImVec2(at(now, low).x, bottom), IM_COL32(26, 31, 38, 180), 1.5f);
  if (!ImGui::IsItemActive()) return std::numeric_limits<double>::quiet_NaN();
  const double part = (ImGui::GetIO().MousePos.x - left) / std::max(1.0f, right - left);
  return span.first + std::clamp(part, 0.0, 1.0) * (span.last - span.first);
}

render::Plot plot_of(const sim::RunReader& run, const std::string& column, const char* label, const char* unit, double factor,
                     const render::Color& color) {
  render::Plot plot{label, unit, {}};
  const std::vector<double> time = run.column("time"), values = run.column(column);
  if (values.size() != time.size() || time.size() < 2) return plot;
  render::Curve curve{"", color, time, values};
  for (double& value : curve.value) value *= factor;
  plot.curves.push_back(std::move(curve));
  return plot;
}

}  // namespace

std::vector<render::Plot> window_plots(const sim::RunReader& run, std::vector<render::Plot> plots) {
  const sim::RunHeader& header = run.header();
  std::vector<render::Plot> more;
  if (header.valve) {
    if (const int port = header.valve->ventricle_port; port >= 0 && port < static_cast<int>(header.ports.size()))
      more.push_back(plot_of(run, "port." + header.ports[static_cast<std::size_t>(port)] + ".flow", "Flow", "mL/s", 1e6,
                             render::Color(0.55f, 0.20f, 0.55f)));
    more.push_back(plot_of(run, "leaflet_stress_p99", "Stress, 99 % lie below", "kPa", 1e-3, render::Color(0.85f, 0.45f, 0.05f)));
  }
  for (render::Plot& plot : more)
    if (!plot.curves.empty()) plots.push_back(std::move(plot));
  return plots;
}

double draw_curves(const ViewModel& model, float width, float height) {
  const std::vector<render::Plot>& plots = model.run().plots();
  double wanted = std::numeric_limits<double>::quiet_NaN();
  if (plots.empty()) {
    ImGui::Dummy(ImVec2(width, height));
    return wanted;
  }
  const std::vector<render::Plot>* ghost = model.ghost_plots();
  const float each = width / static_cast<float>(plots.size());
  for (std::size_t k = 0; k < plots.size(); ++k) {
    if (k > 0) ImGui::SameLine(0, 0);
    const render::Plot* before = nullptr;
    if (ghost)
      for (const render::Plot& plot : *ghost)
        if (plot.label == plots[k].label) before = &plot;
    const double time = draw_plot(("curve" + std::to_string(k)).c_str(), plots[k], before, model.time(), ImVec2(each, height));
    if (std::isfinite(time)) wanted = time;
  }
  return wanted;
}

void draw_history(const Picked& picked, const render::ColorScale& unit, double now) {
  render::Plot plot{unit.label, unit.unit, {{"", render::Color(0.85f, 0.45f, 0.05f), picked.time, picked.value}}};
  for (double& value : plot.curves.front().value) value *= unit.factor;
  draw_plot("history", plot, nullptr, now, ImVec2(ImGui::GetContentRegionAvail().x, 110));
}

}  // namespace app
