// Picking in the window: which particle lies under the mouse, and what it went through.
#include <algorithm>
#include <cmath>

#include "app/view_model.h"
#include "render/panel_painter.h"

namespace app {
namespace {

constexpr float reach = 14;  // pixels round the mouse

struct Nearest {
  float depth = 2;
  int surface = -1, vertex = -1;  // a leaflet's
  int particle = -1;              // or one of the solids, or of the blood
  int set = -1;
};

bool cut_away(const std::optional<render::ClipPlane>& clip, const Eigen::Vector3f& p) {
  return clip && clip->normal.dot(p - clip->point) > 0;
}

// Nearest to the eye of all drawn points within reach of the mouse.
Nearest nearest_point(const render::Frame& frame, const render::Panel& panel, const render::Projection& projection, float x, float y) {
  Nearest best;
  const auto is_nearer = [&](const Eigen::Vector3f& p, bool clipped) {
    if (clipped && cut_away(panel.clip, p)) return false;
    const Eigen::Vector3f at = render::to_pixel(projection, p);
    if (std::hypot(at.x() - x, at.y() - y) > reach || at.z() >= best.depth) return false;
    best.depth = at.z();
    return true;
  };
  for (const render::SurfaceLayer& layer : panel.surfaces) {
    if (layer.surface < first_leaflet) continue;
    const render::Surface& surface = frame.surfaces[static_cast<std::size_t>(layer.surface)];
    for (const auto& triangle : surface.triangles)
      for (const std::int32_t vertex : triangle)
        if (is_nearer(surface.vertices[static_cast<std::size_t>(vertex)], layer.style.clipped))
          best.surface = layer.surface, best.vertex = vertex, best.particle = best.set = -1;
  }
  for (const render::ParticleLayer& layer : panel.particles) {
    const auto& positions = frame.particles[static_cast<std::size_t>(layer.set)].positions;
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (layer.set == solid_set && is_nearer(positions[i], layer.style.clipped))
        best.set = layer.set, best.particle = static_cast<int>(i), best.surface = best.vertex = -1;
  }
  return best;
}

}  // namespace

bool ViewModel::pick(std::size_t number, int width, int height, int reserved_right, float x, float y) {
  picked.reset();
  const std::vector<Picture> all = pictures();
  if (number >= all.size()) return false;
  const Picture& picture = all[number];
  const Nearest found = nearest_point(*picture.frame, picture.panel,
                                      render::panel_projection(*picture.frame, picture.panel, width, height, reserved_right), x, y);
  const sim::RunHeader& header = main_->reader().header();
  Picked result;
  if (found.surface >= 0) {
    const sim::RunHeader::ShellInfo& shell = header.shells.at(static_cast<std::size_t>(found.surface - first_leaflet));
    const sim::RunHeader::BodyInfo& body = header.bodies.at(static_cast<std::size_t>(shell.body));
    result.row = body.first + found.vertex;
    result.what = body.name + ", particle " + std::to_string(found.vertex);
    result.place = picture.frame->surfaces[static_cast<std::size_t>(found.surface)].vertices[static_cast<std::size_t>(found.vertex)];
  } else if (found.particle >= 0) {
    result.row = found.particle;  // elastic particles are the first rows of a run
    result.what = "solid, particle " + std::to_string(found.particle);
    result.place = picture.frame->particles[solid_set].positions[static_cast<std::size_t>(found.particle)];
  } else {
    return false;
  }
  const auto& start = main_->maker().start().at(static_cast<std::size_t>(result.row));
  result.start = Eigen::Vector3d(start[0], start[1], start[2]);
  picked = std::move(result);
  return true;
}

void ViewModel::read_history(std::size_t frames) {
  if (!picked || !main_) return;
  const std::string field = is_fluid_field(shown.field) ? "stress" : shown.field;
  for (; frames > 0 && picked->read < main_->times().size(); --frames, ++picked->read) {
    const sim::RunFrame state = main_->reader().frame(picked->read);
    if (static_cast<std::size_t>(picked->row) >= state.size()) continue;
    picked->time.push_back(state.time);
    picked->value.push_back(field_value(field, state, static_cast<std::size_t>(picked->row), main_->maker().start()));
  }
}

}  // namespace app
