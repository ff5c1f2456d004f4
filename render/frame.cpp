#include "render/frame.h"

#include <algorithm>
#include <stdexcept>

namespace render {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("frame: " + what); }

void check_fields(const std::string& what, const std::vector<std::vector<float>>& fields, std::size_t size) {
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i].size() != size)
      refuse(what + ": field " + std::to_string(i) + " has " + std::to_string(fields[i].size()) + " values for " + std::to_string(size) +
             " points");
}

void check_style(const Frame& frame, const std::string& what, const Style& style, std::size_t fields) {
  if (style.field >= static_cast<int>(fields)) refuse(what + ": there is no field " + std::to_string(style.field));
  if (style.field >= 0 && (style.scale < 0 || style.scale >= static_cast<int>(frame.scales.size())))
    refuse(what + ": coloured by a field, but has no colour scale");
}

template <class Things>
void check_index(const char* what, int index, const Things& things) {
  if (index < 0 || index >= static_cast<int>(things.size()))
    refuse(std::string("a panel names ") + what + " " + std::to_string(index) + ", which is not there");
}

void check_panel(const Frame& frame, const Panel& panel) {
  for (const ParticleLayer& layer : panel.particles) {
    check_index("particle set", layer.set, frame.particles);
    check_style(frame, "particles '" + frame.particles[layer.set].name + "'", layer.style, frame.particles[layer.set].fields.size());
  }
  for (const SurfaceLayer& layer : panel.surfaces) {
    check_index("surface", layer.surface, frame.surfaces);
    check_style(frame, "surface '" + frame.surfaces[layer.surface].name + "'", layer.style, frame.surfaces[layer.surface].fields.size());
  }
  for (const LineLayer& layer : panel.lines) {
    check_index("line", layer.line, frame.lines);
    check_style(frame, "line '" + frame.lines[layer.line].name + "'", layer.style, frame.lines[layer.line].fields.size());
  }
  for (const int mark : panel.marks) check_index("mark", mark, frame.marks);
  for (const int scale : panel.legends) check_index("colour scale", scale, frame.scales);
  if (!(panel.camera.width > 0 && panel.camera.height > 0)) refuse("a camera sees a picture of no size");
}

template <class Layers>
void shift_scales(Layers& layers, int by) {
  for (auto& layer : layers)
    if (layer.style.scale >= 0) layer.style.scale += by;
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// The panel as it reads after all its things moved behind what `frame` already holds.
Panel shifted(Panel panel, const Frame& frame) {
  const int scales = static_cast<int>(frame.scales.size());
  for (ParticleLayer& layer : panel.particles) layer.set += static_cast<int>(frame.particles.size());
  for (SurfaceLayer& layer : panel.surfaces) layer.surface += static_cast<int>(frame.surfaces.size());
  for (LineLayer& layer : panel.lines) layer.line += static_cast<int>(frame.lines.size());
  for (int& mark : panel.marks) mark += static_cast<int>(frame.marks.size());
  for (int& scale : panel.legends) scale += scales;
  shift_scales(panel.particles, scales);
  shift_scales(panel.surfaces, scales);
  shift_scales(panel.lines, scales);
  return panel;
}

}  // namespace

void check_frame(const Frame& frame) {
  if (frame.panels.empty()) refuse("it has no panel");
  for (const ColorScale& scale : frame.scales)
    if (!(scale.maximum > scale.minimum)) refuse("colour scale '" + scale.label + "' ends where it begins");
  for (const ParticleSet& set : frame.particles) {
    check_fields("particles '" + set.name + "'", set.fields, set.positions.size());
    if (!(set.radius > 0)) refuse("particles '" + set.name + "' have no radius");
  }
  for (const Surface& surface : frame.surfaces) {
    check_fields("surface '" + surface.name + "'", surface.fields, surface.vertices.size());
    for (const auto& triangle : surface.triangles)
      for (const std::int32_t vertex : triangle)
        if (vertex < 0 || vertex >= static_cast<std::int32_t>(surface.vertices.size()))
          refuse("surface '" + surface.name + "': a triangle names vertex " + std::to_string(vertex) + ", which is not there");
  }
  for (const Line& line : frame.lines) check_fields("line '" + line.name + "'", line.fields, line.points.size());
  for (const Plot& plot : frame.plots)
    for (const Curve& curve : plot.curves)
      if (curve.time.size() != curve.value.size())
        refuse("curve '" + curve.label + "' has " + std::to_string(curve.time.size()) + " times for " + std::to_string(curve.value.size()) +
               " values");
  for (const Panel& panel : frame.panels) check_panel(frame, panel);
}

Frame side_by_side(const std::vector<Frame>& frames) {
  if (frames.empty()) throw std::invalid_argument("frame: nothing to put side by side");
  Frame all = frames.front();
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Frame& next = frames[i];
    for (const Panel& panel : next.panels) all.panels.push_back(shifted(panel, all));
    append(all.scales, next.scales);
    append(all.particles, next.particles);
    append(all.surfaces, next.surfaces);
    append(all.lines, next.lines);
    append(all.marks, next.marks);
    for (const std::string& warning : next.warnings)
      if (std::find(all.warnings.begin(), all.warnings.end(), warning) == all.warnings.end()) all.warnings.push_back(warning);
    if (!next.title.empty() && all.title.find(next.title) == std::string::npos) all.title += "  |  " + next.title;
  }
  for (ColorScale& scale : all.scales)
    for (const ColorScale& other : all.scales)
      if (other.label == scale.label && other.unit == scale.unit) {
        scale.minimum = std::min(scale.minimum, other.minimum);
        scale.maximum = std::max(scale.maximum, other.maximum);
      }
  all.columns = static_cast<int>(frames.front().panels.size()) == 1 ? 0 : static_cast<int>(frames.front().panels.size());
  return all;
}

}  // namespace render
