#include "app/dry_case.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <utility>

namespace app {
namespace {

using Rows = sim::InitialParticles<3>;

template <class T>
void keep(std::vector<T>& values, const std::vector<std::size_t>& rows) {
  if (values.empty()) return;
  std::vector<T> kept;
  kept.reserve(rows.size());
  for (const std::size_t row : rows) kept.push_back(values[row]);
  values = std::move(kept);
}

// Leaflets, and of the wall what a leaflet can come to touch: three spacings round the box of all leaflets.
std::vector<std::size_t> rows_to_keep(const Rows& rows, double spacing) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows.kind[i] == sim::Kind::shell) box.extend(rows.position[i]);
  box.min().array() -= 3 * spacing;
  box.max().array() += 3 * spacing;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows.kind[i] == sim::Kind::shell || (rows.kind[i] == sim::Kind::wall && box.contains(rows.position[i]))) kept.push_back(i);
  return kept;
}

void keep_rows(sim::SceneDescription<3>& description, const std::vector<std::size_t>& kept) {
  Rows& rows = description.particles;
  for (std::vector<sim::Vector<3>>* vectors :
       {&rows.position, &rows.velocity, &rows.normal, &rows.surface_area, &rows.fibre, &rows.clamp_offset})
    keep(*vectors, kept);
  keep(rows.kind, kept), keep(rows.body, kept), keep(rows.volume, kept), keep(rows.depth, kept), keep(rows.fixed, kept);
  keep(rows.stiffness_scale, kept), keep(rows.clamp_axes, kept);
  rows.surface_begin.clear(), rows.piece_area.clear(), rows.piece_offset.clear();  // solids are not kept
  for (std::size_t b = 0; b < description.bodies.size(); ++b) {
    sim::Body& body = description.bodies[b];
    body.first = std::find(rows.body.begin(), rows.body.end(), static_cast<std::int32_t>(b)) - rows.body.begin();
    body.count = std::count(rows.body.begin(), rows.body.end(), static_cast<std::int32_t>(b));
    if (body.count == 0) body.first = 0;
  }
}

// Bodies are numbered: those that stay come first in every case (leaflets, then blood, then wall), so only indices behind the blood move.
void drop_fluid_bodies(sim::SceneDescription<3>& description) {
  std::vector<std::int32_t> number(description.bodies.size(), -1);
  std::vector<sim::Body> stay;
  for (std::size_t b = 0; b < description.bodies.size(); ++b) {
    if (description.bodies[b].kind == sim::Kind::fluid) continue;
    number[b] = static_cast<std::int32_t>(stay.size());
    stay.push_back(description.bodies[b]);
  }
  description.bodies = std::move(stay);
  for (std::int32_t& body : description.particles.body) body = number[static_cast<std::size_t>(body)];
  for (auto& mesh : description.shell_meshes) mesh.body = number[static_cast<std::size_t>(mesh.body)];
  for (std::int32_t& leaflet : description.valve->leaflet_bodies) leaflet = number[static_cast<std::size_t>(leaflet)];
}

// The pressure on every leaflet, towards the ventricle where it is positive, following the surface. Sheets take a pressure against their
// + side, which faces the aorta or the ventricle as the mesh was made.
void add_pressure(sim::SceneDescription<3>& description, const DrySettings& settings) {
  const Eigen::Vector3d axis = description.valve->axis;
  for (const std::int32_t leaflet : description.valve->leaflet_bodies) {
    sim::Body& body = description.bodies[static_cast<std::size_t>(leaflet)];
    body.elastic.damping = std::max(body.elastic.damping, settings.damping);
    double facing = 0;
    sim::Load<3> load;
    load.name = "pressure difference", load.body = leaflet, load.ramp = settings.ramp;
    double area = 0;
    for (std::int64_t row = body.first; row < body.first + body.count; ++row) {
      const auto i = static_cast<std::size_t>(row);
      facing += description.particles.volume[i] * description.particles.normal[i].dot(axis);
      area += description.particles.volume[i];
      load.rows.push_back(row);
    }
    for (const std::int64_t row : load.rows) load.share.push_back(description.particles.volume[static_cast<std::size_t>(row)] / area);
    load.pressure = facing >= 0 ? settings.pressure : -settings.pressure;
    description.loads.push_back(std::move(load));
  }
}

}  // namespace

void refuse_dry(const SceneFile& scene) {
  throw SceneError(scene.path.string() + ": has no valve with leaflets in space, so there is no dry preview of it; leave out --dry");
}

BuiltCase<3> dry_case(const SceneFile& scene, BuiltCase<3> built, const DrySettings& settings) {
  sim::SceneDescription<3>& description = built.description;
  if (!description.valve || description.valve->leaflet_bodies.empty()) refuse_dry(scene);
  for (const std::int32_t leaflet : description.valve->leaflet_bodies)
    if (description.bodies[static_cast<std::size_t>(leaflet)].kind != sim::Kind::shell) refuse_dry(scene);
  keep_rows(description, rows_to_keep(description.particles, description.spacing));
  drop_fluid_bodies(description);
  description.ports.clear(), description.probes.clear(), description.loads.clear(), description.motions.clear();
  description.valve->ventricle_port = description.valve->aorta_port = -1;
  description.time.mode = sim::TimeMode::dynamic;
  description.scheme.maximum_step = settings.step;
  description.time.end = settings.end, description.time.output = settings.output;
  description.title += " (dry preview, without blood)";
  add_pressure(description, settings);
  built.warnings.insert(built.warnings.begin(), dry_warning);
  return built;
}

}  // namespace app
