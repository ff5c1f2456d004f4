#include "app/build_case.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "app/case_parts.h"
#include "app/jitter.h"
#include "app/loaded_surface.h"
#include "app/region_rows.h"
#include "app/to_geometry.h"

namespace app {
namespace {

template <int D>
sim::Vector<D> reduced(const Eigen::Vector3d& v) {
  return v.head<D>();
}

template <int D>
struct Builder {
  const SceneFile& scene;
  CaseParticles parts;
  BuiltCase<D> result;
  std::vector<std::vector<int>> parts_of;  // per SceneFile body: indices into parts.bodies = description.bodies

  sim::SceneDescription<D>& description() { return result.description; }

  void add_body(int index) {
    const BodyParticles& part = parts.bodies[index];
    const BodySpec& spec = scene.bodies[part.source];
    sim::Body body;
    body.name = part.name, body.kind = part.kind, body.fluid = spec.fluid, body.elastic = spec.elastic;
    if (part.kind == sim::Kind::shell) body.elastic.thickness = part.thickness;
    description().bodies.push_back(body);
  }

  void add_rows(int index) {
    const BodyParticles& part = parts.bodies[index];
    const BodySpec& spec = scene.bodies[part.source];
    sim::InitialParticles<D>& rows = description().particles;
    sim::Body& body = description().bodies[index];
    body.first = static_cast<std::int64_t>(rows.size());
    body.count = static_cast<std::int64_t>(part.size());
    const auto velocity = spec.velocity.compile();
    const bool solid = part.kind == sim::Kind::elastic || part.kind == sim::Kind::shell;
    const bool fibres = solid && spec.elastic.law == sim::ElasticLaw::fibre_reinforced;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Eigen::Vector3d start = velocity(part.position[i], 0);
      if (!start.allFinite())
        refuse({scene.path.string(), spec.spot.line, "body." + spec.name + ".velocity"}, "is not finite somewhere in the body",
               "mend the formula");
      rows.position.push_back(reduced<D>(part.position[i]));
      rows.velocity.push_back(part.kind == sim::Kind::wall ? sim::Vector<D>::Zero() : reduced<D>(start));
      rows.kind.push_back(part.kind);
      rows.body.push_back(index);
      rows.volume.push_back(part.volume[i]);
      rows.normal.push_back(part.normal.empty() ? sim::Vector<D>::Zero() : reduced<D>(part.normal[i]));
      rows.depth.push_back(part.depth.empty() ? 0 : part.depth[i]);
      rows.surface_area.push_back(part.surface_area.empty() ? sim::Vector<D>::Zero() : reduced<D>(part.surface_area[i]));
      rows.fixed.push_back(!part.held.empty() && part.held[i] ? static_cast<std::uint8_t>((1 << D) - 1) : 0);
      rows.stiffness_scale.push_back(1);
      sim::Vector<D> fibre = sim::Vector<D>::Zero();
      if (fibres) fibre = reduced<D>(spec.fibre_direction ? *spec.fibre_direction : part.fibre[i]);
      rows.fibre.push_back(fibre);
    }
    if (part.kind == sim::Kind::elastic) add_surface(part);
    rows.clamp_offset.resize(rows.size(), sim::Vector<D>::Zero());
    rows.clamp_axes.resize(rows.size(), 0);
    for (const FixedSpec& fixed : spec.fixed)
      if (part.kind == sim::Kind::elastic)
        hold_solid(fixed, part, body);
      else
        for (std::int64_t row : rows_in_region(fixed.region, part, D, scene.spacing)) rows.fixed[body.first + row] |= fixed.directions;
    for (const StiffnessSpec& stiffness : spec.stiffness_map)
      for (std::int64_t row : rows_in_region(stiffness.region, part, D, scene.spacing))
        rows.stiffness_scale[body.first + row] *= stiffness.scale;
    if (part.kind == sim::Kind::shell) add_mesh(index);
  }

  // Elastic rows come first, so that the lists of pieces stay aligned with them.
  void add_surface(const BodyParticles& part) {
    sim::InitialParticles<D>& rows = description().particles;
    if (rows.surface_begin.empty()) rows.surface_begin.push_back(0);
    std::size_t next = 0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (; next < part.surface.size() && part.surface[next].particle == i; ++next) {
        rows.piece_area.push_back(reduced<D>(part.surface[next].area));
        rows.piece_offset.push_back(reduced<D>(part.surface[next].offset));
      }
      rows.surface_begin.push_back(static_cast<std::int64_t>(rows.piece_area.size()));
    }
  }

  // Particles inside a fixed region are held; those outside but next to its face learn where the face is, so that the clamp
  // acts there wherever it cuts the lattice. The region may merely touch the body.
  void hold_solid(const FixedSpec& fixed, const BodyParticles& part, const sim::Body& body) {
    const geometry::Shape shape = region_shape(fixed.region, D, scene.spacing);
    sim::InitialParticles<D>& rows = description().particles;
    const auto distance = [&](const Eigen::Vector3d& x) { return geometry::signed_distance(shape, x, D); };
    bool any = false;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::size_t row = static_cast<std::size_t>(body.first) + i;
      const double away = distance(part.position[i]);
      if (away >= 1.6 * scene.spacing) continue;
      any = any || away <= 1.001 * scene.spacing;
      if (away <= 1e-9 * scene.spacing) {
        rows.fixed[row] |= fixed.directions;
        continue;
      }
      if (rows.clamp_axes[row] && rows.clamp_offset[row].norm() <= away) continue;  // another region's face is nearer
      Eigen::Vector3d slope = Eigen::Vector3d::Zero();
      for (int axis = 0; axis < D; ++axis) {
        const Eigen::Vector3d step = 1e-4 * scene.spacing * Eigen::Vector3d::Unit(axis);
        slope[axis] = distance(part.position[i] + step) - distance(part.position[i] - step);
      }
      rows.clamp_offset[row] = reduced<D>(-away * slope.normalized());
      rows.clamp_axes[row] = fixed.directions;
    }
    if (!any)
      refuse(fixed.region.spot, "holds no particle of body \"" + body.name + "\"", "regions are in the initial configuration, in m");
  }

  void add_mesh(int index) {
    sim::ShellMesh<D> mesh;
    mesh.body = index;
    for (const auto& element : parts.bodies[index].elements) {
      std::array<std::int32_t, D> corners{};
      std::copy_n(element.begin(), D, corners.begin());
      mesh.elements.push_back(corners);
    }
    description().shell_meshes.push_back(std::move(mesh));
  }

  void check_held() {
    if (scene.time.mode != sim::TimeMode::static_equilibrium) return;
    for (const sim::Body& body : description().bodies) {
      if (body.kind != sim::Kind::elastic && body.kind != sim::Kind::shell) continue;
      std::uint8_t held = 0;
      for (std::int64_t row = body.first; row < body.first + body.count; ++row)
        held |= description().particles.fixed[row] | description().particles.clamp_axes[row];
      for (int axis = 0; axis < D; ++axis)
        if (!(held >> axis & 1))
          refuse({scene.path.string(), 0, "body." + body.name},
                 "nothing holds it along " + std::string(1, "xyz"[axis]) + ", so it has no equilibrium", "add fixed = [ ... ]");
    }
  }

  void add_loads() {
    for (const LoadSpec& spec : scene.loads) {
      const auto& indices = parts_of[spec.body];
      double whole = 0;
      std::vector<std::vector<std::int64_t>> rows;
      for (int index : indices) rows.push_back(load_rows(spec, parts.bodies[index]));
      for (std::size_t k = 0; k < indices.size(); ++k)
        for (std::int64_t row : rows[k]) whole += parts.bodies[indices[k]].volume[row];
      for (std::size_t k = 0; k < indices.size(); ++k) {
        if (rows[k].empty() && parts.bodies[indices[k]].kind != sim::Kind::fluid) continue;
        description().loads.push_back(make_load(spec, indices[k], rows[k], whole));
      }
    }
  }

  std::vector<std::int64_t> load_rows(const LoadSpec& spec, const BodyParticles& part) {
    if (part.kind == sim::Kind::fluid) return {};
    if (spec.pressure) return surface_rows(spec.region, part, D, scene.spacing);
    if (spec.region) return rows_in_region(*spec.region, part, D, scene.spacing);
    std::vector<std::int64_t> rows(part.size());
    std::iota(rows.begin(), rows.end(), std::int64_t{0});
    return rows;
  }

  // A pressure on part of a solid: rows, areas and offsets of that part alone (sim/solid_loads.cpp).
  void set_loaded_surface(const LoadSpec& spec, int index, sim::Load<D>& load) {
    const BodyParticles& part = parts.bodies[index];
    const geometry::Shape region = region_shape(*spec.region, D, scene.spacing);
    const geometry::Shape body = to_geometry(scene.bodies[part.source].shape, D, scene.spacing);
    const LoadedSurface surface = loaded_surface(body, part, region, D, scene.spacing);
    if (surface.row.empty())
      refuse(spec.region->spot, "holds no part of the surface of body \"" + part.name + "\"", "let it enclose the surface");
    load.rows = surface.row;
    load.share.clear();
    for (std::size_t k = 0; k < surface.row.size(); ++k) {
      for (int axis = 0; axis < D; ++axis) load.share.push_back(surface.area[k][axis]);
      for (int axis = 0; axis < D; ++axis) load.share.push_back(surface.offset[k][axis]);
    }
  }

  // A force on a region that holds no particle's centre but a part of a solid's surface (an end face) acts there as an even traction: rows,
  // and shares and offsets in load.share (sim/solid_loads.h). False where the region holds no surface.
  bool set_traction(const LoadSpec& spec, int index, sim::Load<D>& load) {
    const BodyParticles& part = parts.bodies[index];
    const geometry::Shape region = region_shape(*spec.region, D, scene.spacing);
    for (const Eigen::Vector3d& x : part.position)
      if (geometry::signed_distance(region, x, D) <= 1e-9 * scene.spacing) return false;
    const geometry::Shape body = to_geometry(scene.bodies[part.source].shape, D, scene.spacing);
    const LoadedSurface surface = loaded_surface(body, part, region, D, scene.spacing);
    if (surface.row.empty()) return false;
    double whole = 0;
    for (const Eigen::Vector3d& area : surface.area) whole += area.norm();
    load.rows = surface.row;
    load.share.clear();
    for (std::size_t k = 0; k < surface.row.size(); ++k) {
      load.share.push_back(surface.area[k].norm() / whole);
      for (int axis = 0; axis < D; ++axis) load.share.push_back(surface.offset[k][axis]);
    }
    return true;
  }

  sim::Load<D> make_load(const LoadSpec& spec, int index, const std::vector<std::int64_t>& rows, double whole) {
    const BodyParticles& part = parts.bodies[index];
    sim::Load<D> load;
    load.name = spec.name, load.body = index, load.ramp = spec.ramp, load.factor = spec.factor, load.pressure = spec.pressure;
    double mine = 0;
    for (std::int64_t row : rows) mine += part.volume[row];
    load.rows = rows;
    for (std::int64_t row : rows) load.share.push_back(part.volume[row] / mine);
    if (spec.pressure && spec.region && part.kind == sim::Kind::elastic) set_loaded_surface(spec, index, load);
    if (spec.force && spec.region && !(part.kind == sim::Kind::elastic && set_traction(spec, index, load)))
      move_shares_to_region(*spec.region, part, D, scene.spacing, load.rows, load.share);
    for (std::int64_t& row : load.rows) row += description().bodies[index].first;
    if (spec.force) load.force = reduced<D>(*spec.force) * (mine / whole);
    if (spec.acceleration) {
      const auto formula = spec.acceleration->compile();
      std::optional<geometry::Shape> region;
      if (spec.region && part.kind == sim::Kind::fluid) region = to_geometry(*spec.region, D, scene.spacing);
      load.acceleration = [formula, region](const sim::Vector<D>& x, double time) -> sim::Vector<D> {
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        place.head<D>() = x;
        if (region && !geometry::contains(*region, place, D)) return sim::Vector<D>::Zero();
        return formula(place, time).template head<D>();
      };
    }
    return load;
  }

  void add_motions() {
    for (const MotionSpec& spec : scene.motions) {
      sim::Motion<D> motion;
      motion.body = parts_of[spec.body].front();
      std::copy_n(spec.velocity.begin(), D, motion.velocity.begin());
      motion.angular_velocity = spec.angular_velocity;
      motion.center = reduced<D>(spec.center);
      motion.axis = spec.axis;
      motion.surface_velocity = reduced<D>(spec.surface_velocity);
      description().motions.push_back(motion);
    }
  }

  void add_ports() {
    for (const PortSpec& spec : scene.ports) {
      sim::Port<3> full = spec.port;
      if (!spec.has_plane)
        for (const sim::Port<3>& end : parts.ports)
          if (end.name == full.name) full.point = end.point, full.normal = end.normal, full.radius = end.radius;
      if (!spec.has_condition && scene.patient) set_patient_wave(*scene.patient, full);
      sim::Port<D> port;
      port.name = full.name, port.point = reduced<D>(full.point), port.normal = reduced<D>(full.normal), port.radius = full.radius;
      port.condition = full.condition, port.table = full.table, port.windkessel = full.windkessel;
      port.impedance = full.impedance, port.start_speed = full.start_speed;
      description().ports.push_back(port);
    }
  }

  // A body of several parts (leaflets) is probed on the part nearest to the first point.
  int probed_part(const sim::Probe<3>& probe) {
    if (probe.body < 0) return -1;
    const auto& indices = parts_of[probe.body];
    if (probe.points.empty()) return indices.front();
    int best = indices.front();
    double nearest = std::numeric_limits<double>::infinity();
    for (int index : indices)
      for (const Eigen::Vector3d& x : parts.bodies[index].position)
        if ((x - probe.points.front()).norm() < nearest) nearest = (x - probe.points.front()).norm(), best = index;
    return best;
  }

  void add_probes() {
    for (const ProbeSpec& spec : scene.probes) {
      sim::Probe<D> probe;
      probe.name = spec.probe.name, probe.quantity = spec.probe.quantity, probe.body = probed_part(spec.probe),
      probe.line = spec.probe.line;
      for (const Eigen::Vector3d& x : spec.probe.points) probe.points.push_back(reduced<D>(x));
      probe.plane_point = reduced<D>(spec.probe.plane_point), probe.plane_normal = reduced<D>(spec.probe.plane_normal);
      probe.plane_radius = spec.probe.plane_radius, probe.axis = spec.probe.axis;
      description().probes.push_back(std::move(probe));
    }
  }

  void add_valve() {
    description().valve = parts.valve;
    if (!scene.valve) return;
    sim::ValveFrame valve;
    valve.annulus_center = scene.valve->annulus_center, valve.axis = scene.valve->axis, valve.annulus_radius = scene.valve->annulus_radius;
    valve.commissure_height = scene.valve->commissure_height, valve.commissure_radius = scene.valve->commissure_radius;
    for (int leaflet : scene.valve->leaflets)
      for (int index : parts_of[leaflet]) valve.leaflet_bodies.push_back(index);
    valve.ventricle_port = scene.valve->ventricle_port, valve.aorta_port = scene.valve->aorta_port;
    description().valve = valve;
  }

  void build() {
    jitter_particles(parts, scene.start, D, scene.spacing);
    description().title = scene.title, description().spacing = scene.spacing;
    description().domain.present = scene.domain.present;
    description().domain.min = reduced<D>(scene.domain.min), description().domain.max = reduced<D>(scene.domain.max);
    std::copy_n(scene.domain.periodic.begin(), D, description().domain.periodic.begin());
    description().time = scene.time, description().scheme = scene.scheme, description().limits = scene.limits;
    if (scene.gravity) description().gravity = reduced<D>(*scene.gravity);
    parts_of.resize(scene.bodies.size());
    for (int i = 0; i < static_cast<int>(parts.bodies.size()); ++i) {
      parts_of[parts.bodies[i].source].push_back(i);
      add_body(i);
    }
    for (sim::Kind kind : {sim::Kind::elastic, sim::Kind::shell, sim::Kind::wall, sim::Kind::fluid})
      for (int i = 0; i < static_cast<int>(parts.bodies.size()); ++i)
        if (parts.bodies[i].kind == kind) add_rows(i);
    check_held();
    add_loads();
    add_motions();
    add_ports();
    add_probes();
    add_valve();
    result.warnings = parts.warnings;
    result.lumen = std::move(parts.lumen);
    result.placement_seconds = parts.seconds;
  }
};

}  // namespace

std::shared_ptr<const CaseParticles> place_case(const SceneFile& scene) {
  return std::make_shared<const CaseParticles>(scene.patient ? place_patient(scene) : place_bodies(scene));
}

template <int D>
BuiltCase<D> build_case(const SceneFile& scene, const CaseParticles& placed) {
  Builder<D> builder{scene, placed, {}, {}};
  builder.build();
  return std::move(builder.result);
}

template <int D>
BuiltCase<D> build_case(const SceneFile& scene) {
  return build_case<D>(scene, *place_case(scene));
}

template BuiltCase<2> build_case<2>(const SceneFile&);
template BuiltCase<3> build_case<3>(const SceneFile&);
template BuiltCase<2> build_case<2>(const SceneFile&, const CaseParticles&);
template BuiltCase<3> build_case<3>(const SceneFile&, const CaseParticles&);

}  // namespace app
