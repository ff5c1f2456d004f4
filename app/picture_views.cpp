// The views: which panels a choice means, and what stands in each.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "app/make_frame.h"

namespace app {
namespace {

const std::vector<std::string> valve_views = {"long_axis", "short_axis", "from_aorta", "from_ventricle", "pair", "standard"};
const std::vector<std::string> space_views = {"oblique", "front", "side", "top"};
const std::vector<std::string> flat_views = {"plane"};

const render::Color vessel(0.86f, 0.58f, 0.53f), tissue(0.95f, 0.91f, 0.82f), stone(0.62f, 0.65f, 0.68f);

bool holds(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

bool has_kind(const sim::RunHeader& header, std::initializer_list<sim::Kind> kinds) {
  return std::any_of(header.bodies.begin(), header.bodies.end(), [&](const sim::RunHeader::BodyInfo& body) {
    return std::find(kinds.begin(), kinds.end(), body.kind) != kinds.end() && body.count > 0;
  });
}
bool has_fluid(const sim::RunHeader& header) { return has_kind(header, {sim::Kind::fluid}); }
bool has_solid(const sim::RunHeader& header) { return has_kind(header, {sim::Kind::elastic, sim::Kind::shell}); }

// The views that the name stands for, with the field each shows when none was chosen.
std::vector<View> spelt_out(const std::string& name, const sim::RunHeader& header) {
  const std::string blood = has_fluid(header) ? "pressure" : "stress";
  if (name == "pair") return {{"long_axis", blood}, {"long_axis", "stress"}};
  if (name == "standard") {
    if (!has_fluid(header)) return {{"long_axis", "stress"}, {"from_aorta", "stress"}};
    return {{"long_axis", "pressure"}, {"long_axis", "stress"}, {"from_aorta", "stress"}};
  }
  if (name == "from_aorta" || name == "from_ventricle") return {{name, "stress"}};
  if (name == "long_axis" || name == "short_axis") return {{name, blood}};
  return {{name, ""}};  // both fields at once
}

std::string known_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

std::vector<View> chosen_views(const PictureChoice& choice, const sim::RunHeader& header, bool alone) {
  const bool valve = header.valve && header.dimension == 3;
  std::vector<std::string> known = header.dimension == 2 ? flat_views : space_views;
  if (valve) known.insert(known.begin(), valve_views.begin(), valve_views.end());
  std::vector<std::string> names = choice.views;
  if (names.empty()) names = {header.dimension == 2 ? "plane" : !valve ? "oblique" : alone ? "standard" : "from_aorta"};
  std::vector<View> views;
  for (const std::string& name : names) {
    if (!holds(known, name)) throw std::invalid_argument("--view: this run has no view '" + name + "'; use one of " + known_text(known));
    for (const View& view : spelt_out(name, header)) views.push_back(view);
  }
  if (choice.fields.size() > 1 && choice.fields.size() != views.size())
    throw std::invalid_argument("--field: " + std::to_string(choice.fields.size()) + " fields for " + std::to_string(views.size()) +
                                " pictures; give one for all, or one each");
  for (std::size_t i = 0; i < views.size() && !choice.fields.empty(); ++i) {
    const std::string& field = choice.fields[choice.fields.size() > 1 ? i : 0];
    field_index(field);  // refuses what is unknown
    if (is_fluid_field(field) && !has_fluid(header))
      throw std::invalid_argument("--field: '" + field + "' is of the blood, and this run has none");
    if (!is_fluid_field(field) && !has_solid(header))
      throw std::invalid_argument("--field: '" + field + "' is of solids, and this run has none");
    views[i].field = field;
  }
  return views;
}

namespace {

std::string panel_title(const View& view, const render::Frame& frame) {
  static const std::vector<std::pair<std::string, std::string>> places = {{"long_axis", "along the long axis"},
                                                                          {"short_axis", "across, from the aorta"},
                                                                          {"from_aorta", "from the aorta"},
                                                                          {"from_ventricle", "from the ventricle"}};
  std::string title = view.field == "pressure" ? "Pressure of the blood"
                      : view.field == "speed"  ? "Speed of the blood"
                      : view.field == "stress" ? "Stress on the valve"
                                               : frame.scales[scale_slot(view.field)].label;
  for (const auto& [name, words] : places)
    if (view.view == name) title += ", " + words;
  return title;
}

// A thing's style: by the field where it is the panel's, else plain.
render::Style styled(const std::string& field, bool fluid, const render::Color& plain) {
  render::Style style;
  style.color = plain;
  if (!field.empty() && is_fluid_field(field) == fluid) {
    style.field = field_index(field);
    style.scale = scale_slot(field);
  }
  return style;
}

void add_leaflets(render::Panel& panel, const render::Frame& frame, const std::string& field, bool cut) {
  for (int k = first_leaflet; k < static_cast<int>(frame.surfaces.size()); ++k) {
    render::SurfaceLayer layer{k, styled(field, false, tissue), true, cut};
    layer.style.clipped = cut;
    layer.rim = !cut;
    panel.surfaces.push_back(layer);
  }
}

void add_blood(render::Panel& panel, const render::Frame& frame, const std::string& field, const PictureChoice& choice) {
  if (frame.particles[fluid_set].positions.empty()) return;
  render::ParticleLayer layer{fluid_set, styled(field, true, render::Color(0.75f, 0.25f, 0.22f))};
  layer.section = panel.clip.has_value() && !choice.balls;
  panel.particles.push_back(layer);
}

void add_walls(render::Panel& panel, const render::Frame& frame, render::ParticleShape shape) {
  if (frame.particles[wall_set].positions.empty()) return;
  panel.particles.push_back({wall_set, styled("", false, stone), shape});
}

// The wall's largest distance from the valve's axis between annulus and commissures, m; without a wall, a third more than the annulus.
float widest_at_valve(const render::Surface& lumen, const sim::ValveFrame& valve) {
  double widest = 1.1 * valve.annulus_radius;
  bool found = false;
  for (const Eigen::Vector3f& vertex : lumen.vertices) {
    const Eigen::Vector3d from = vertex.cast<double>() - valve.annulus_center;
    const double height = from.dot(valve.axis), distance = (from - height * valve.axis).norm();
    if (height < 0 || height > valve.commissure_height || distance > 3 * valve.annulus_radius) continue;  // farther: another vessel
    widest = std::max(widest, distance);
    found = true;
  }
  return static_cast<float>(found ? widest : 1.33 * valve.annulus_radius);
}

// Views of a valve: lengths in multiples of the annulus radius.
render::Panel valve_panel(const View& view, const render::Frame& frame, const sim::ValveFrame& valve, const PictureChoice& choice,
                          const Eigen::Vector3f& toward_leaflet) {
  const Eigen::Vector3f annulus = valve.annulus_center.cast<float>(), axis = valve.axis.cast<float>();
  const auto radius = static_cast<float>(valve.annulus_radius), height = static_cast<float>(valve.commissure_height);
  const bool blood = is_fluid_field(view.field), along = view.view == "long_axis";
  const Eigen::Vector3f middle = annulus + 0.5f * height * axis;
  render::Panel panel;
  // Along the long axis the cut runs through the first leaflet's middle and the commissure opposite, as in an echocardiogram. From the
  // aorta the first leaflet lies at the bottom, from the ventricle likewise.
  const Eigen::Vector3f side = along ? Eigen::Vector3f(axis.cross(toward_leaflet))
                                     : Eigen::Vector3f((view.view == "from_ventricle" ? 1.0f : -1.0f) * toward_leaflet.cross(axis));
  const auto which = along                           ? render::StandardView::long_axis
                     : view.view == "from_aorta"     ? render::StandardView::from_aorta
                     : view.view == "from_ventricle" ? render::StandardView::from_ventricle
                                                     : render::StandardView::short_axis;
  const float reach = widest_at_valve(frame.surfaces[0], valve);
  panel.camera =
      render::standard_camera(which, middle, axis, side, along ? 2.5f * reach : 2.3f * reach, along ? 4.2f * radius : 2.3f * reach);
  if (along && blood) panel.clip = render::ClipPlane{middle, panel.camera.backward};
  if (view.view == "from_aorta") panel.clip = render::ClipPlane{annulus + (height + 0.15f * radius) * axis, axis};
  if (view.view == "from_ventricle") panel.clip = render::ClipPlane{annulus - 0.5f * radius * axis, -axis};
  if (view.view == "short_axis") panel.clip = render::ClipPlane{annulus + (blood ? 0.7f * height : height + 0.15f * radius) * axis, axis};
  const bool cut_leaflets = blood && (along || view.view == "short_axis");
  if (!frame.surfaces[0].triangles.empty()) {
    render::SurfaceLayer lumen{along ? lumen_surface : root_surface, {-1, -1, vessel, 0.25f}};
    lumen.section = panel.clip.has_value();
    panel.surfaces.push_back(lumen);
  }
  add_leaflets(panel, frame, view.field, cut_leaflets);
  if (cut_leaflets) add_blood(panel, frame, view.field, choice);
  panel.directions = {{"to aorta", axis, render::Color(0.70f, 0.15f, 0.15f)}};
  panel.legends = {scale_slot(view.field)};
  panel.title = panel_title(view, frame);
  return panel;
}

// Views of anything else in space, or of a 2-D scene: everything in its place, the blood by one field, the solids by another.
render::Panel plain_panel(const View& view, const render::Frame& frame, const sim::RunHeader& header, const PictureChoice& choice,
                          const render::Bounds& bounds) {
  const bool flat = header.dimension == 2;
  const std::string fluid_field = is_fluid_field(view.field) ? view.field : "pressure";
  const std::string solid_field = !view.field.empty() && !is_fluid_field(view.field) ? view.field : "stress";
  const render::ParticleShape shape = flat ? render::ParticleShape::disc : render::ParticleShape::sphere;
  render::Panel panel;
  panel.camera = render::flat_camera(bounds, 0.06f);
  panel.directions = {{"x", Eigen::Vector3f::UnitX(), stone * 0.7f}, {"y", Eigen::Vector3f::UnitY(), stone * 0.7f}};
  if (!flat) {
    Eigen::Vector3f back = -Eigen::Vector3f::UnitY(), up = Eigen::Vector3f::UnitZ();
    if (view.view == "side") back = Eigen::Vector3f::UnitX();
    if (view.view == "top") {
      back = Eigen::Vector3f::UnitZ();
      up = Eigen::Vector3f::UnitY();
    }
    if (view.view == "oblique") back = Eigen::Vector3f(0.5f, -0.8f, 0.45f).normalized();
    panel.camera.backward = back;
    panel.camera.up = up;
    panel.camera.width = panel.camera.height = 2.1f * bounds.radius();
    panel.directions.push_back({"z", Eigen::Vector3f::UnitZ(), stone * 0.7f});
    if (!frame.surfaces[0].triangles.empty()) panel.surfaces.push_back({0, {-1, -1, vessel, 0.25f}});
  }
  add_leaflets(panel, frame, solid_field, false);
  for (std::size_t k = 0; k < frame.lines.size(); ++k) {
    double thickness = 0;
    for (const auto& body : header.bodies)
      if (body.name == frame.lines[k].name) thickness = body.thickness;
    panel.lines.push_back(
        {static_cast<int>(k), styled(solid_field, false, tissue), 3, static_cast<float>(std::max(thickness, 0.8 * header.spacing))});
  }
  if (flat || choice.walls || !(has_fluid(header) || has_solid(header))) add_walls(panel, frame, shape);
  if (has_fluid(header)) {
    add_blood(panel, frame, fluid_field, choice);
    panel.particles.back().shape = shape;
    panel.legends.push_back(scale_slot(fluid_field));
  }
  if (has_solid(header)) {
    if (!frame.particles[solid_set].positions.empty()) panel.particles.push_back({solid_set, styled(solid_field, false, tissue), shape});
    panel.legends.push_back(scale_slot(solid_field));
  }
  return panel;
}

}  // namespace

render::Panel make_panel(const View& view, const render::Frame& frame, const sim::RunHeader& header, const PictureChoice& choice,
                         const render::Bounds& bounds, const Eigen::Vector3f& toward_leaflet) {
  if (header.valve && holds(valve_views, view.view)) return valve_panel(view, frame, *header.valve, choice, toward_leaflet);
  return plain_panel(view, frame, header, choice, bounds);
}

}  // namespace app
