// A valve case: lumen from the built-in patient or a mesh, leaflets from the template or a mesh, blood and wall around them.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "app/assets.h"
#include "app/case_parts.h"
#include "geometry/check_mesh.h"
#include "geometry/cut_domain.h"
#include "geometry/import_mesh.h"
#include "geometry/place_valve_case.h"
#include "geometry/shape.h"
#include "geometry/synthetic_aorta.h"

namespace app {
namespace {

struct Vessel {
  geometry::TriangleMesh lumen;
  geometry::RootFrame frame;
  std::vector<geometry::DomainPort> ports;
  std::vector<std::string> warnings;
};

// The built-in patient, scaled to the annulus that was asked for.
Vessel synthetic_vessel(const PatientSpec& patient) {
  geometry::SyntheticAorta aorta;
  const double scale = patient.annulus_diameter ? *patient.annulus_diameter / aorta.annulus_diameter : 1;
  for (double* length : {&aorta.annulus_diameter, &aorta.sinus_diameter, &aorta.junction_diameter, &aorta.ascending_diameter,
                         &aorta.outflow_diameter, &aorta.junction_height, &aorta.commissure_drop, &aorta.sinus_height})
    *length *= scale;
  if (patient.junction_diameter) aorta.junction_diameter = *patient.junction_diameter;
  aorta.outflow_length = patient.below_annulus, aorta.ascending_length = patient.above_junction, aorta.extension = patient.extension;
  geometry::SyntheticPatient made = geometry::make_synthetic_patient(aorta);
  return {std::move(made.lumen), made.frame, made.ports, {}};
}

std::string unit_name(double unit) { return unit == 1 ? "m" : unit == 1e-2 ? "cm" : unit == 1e-6 ? "um" : unit == 0.0254 ? "in" : "mm"; }

Vessel imported_vessel(const PatientSpec& patient) {
  geometry::ImportOptions options;
  options.units = unit_name(patient.aorta_unit);
  options.build_root = patient.build_root;
  if (patient.annulus_diameter) options.built_root.annulus_diameter = *patient.annulus_diameter;
  if (patient.annulus) options.root.annulus = geometry::PlaneOverride{patient.annulus->center, patient.annulus->normal};
  if (patient.sinotubular_junction)
    options.root.sinotubular_junction = geometry::PlaneOverride{patient.sinotubular_junction->center, patient.sinotubular_junction->normal};
  if (patient.commissures.size() == 3)
    options.root.commissures = std::array{patient.commissures[0], patient.commissures[1], patient.commissures[2]};
  const geometry::ImportResult found = geometry::import_mesh(patient.aorta.string(), options);
  if (!found.root)
    refuse(patient.spot, "no aortic root found: " + found.root_reason, "give patient.root, or set patient.root.build = true");
  geometry::CutOptions cut;
  cut.below_annulus_min = patient.below_annulus, cut.below_annulus_max = patient.below_annulus + 0.008;
  cut.above_junction_min = patient.above_junction, cut.above_junction_max = patient.above_junction + 0.015;
  cut.extension = patient.extension;
  geometry::CutDomain domain = geometry::cut_domain(found.lumen, found.centreline, *found.root, cut);
  Vessel vessel{std::move(domain.surface), geometry::make_root_frame(*found.root), domain.ports, found.warnings};
  vessel.warnings.insert(vessel.warnings.end(), domain.warnings.begin(), domain.warnings.end());
  return vessel;
}

geometry::ValveOptions valve_options(const SceneFile& scene, const BodySpec& leaflets) {
  geometry::ValveOptions options;
  options.thickness = leaflets.elastic.thickness > 0 ? leaflets.elastic.thickness : options.thickness;
  options.sector_offset = 0.5 * options.thickness + 0.25 * scene.spacing;
  if (scene.patient->over_closure) options.over_closure = *scene.patient->over_closure;
  if (scene.patient->coaptation) options.coaptation_ratio = *scene.patient->coaptation;
  return options;
}

// The user's own leaflets: one connected surface each, held where they reach the wall.
std::vector<geometry::SurfaceParticles> leaflets_from_mesh(const PatientSpec& patient, const Vessel& vessel, double spacing) {
  geometry::TriangleMesh mesh = geometry::load_mesh(patient.leaflets.string()).mesh;
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex *= patient.leaflets_unit;
  geometry::weld_vertices(mesh);
  const geometry::MeshTopology topology = geometry::measure_topology(mesh);
  const geometry::Shape lumen = geometry::mesh_shape(std::make_shared<geometry::TriangleMesh>(vessel.lumen), spacing);
  std::vector<geometry::SurfaceParticles> leaflets;
  for (std::size_t part = 0; part < topology.components; ++part) {
    geometry::TriangleMesh one{mesh.vertices, {}};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (topology.component_of_triangle[t] == static_cast<std::int32_t>(part)) one.triangles.push_back(mesh.triangles[t]);
    geometry::weld_vertices(one);
    leaflets.push_back(geometry::mesh_particles(one, 0.8 * spacing));
    geometry::SurfaceParticles& made = leaflets.back();
    std::size_t held = 0;
    for (std::size_t i = 0; i < made.size(); ++i) {
      made.attached[i] = geometry::signed_distance(lumen, made.position[i], 3) > -0.8 * spacing;
      held += made.attached[i];
    }
    if (held == 0)
      refuse(patient.spot, "leaflet " + std::to_string(part + 1) + " of " + patient.leaflets.string() + " does not reach the wall",
             "give units, or move the mesh into the aorta's coordinates");
  }
  return leaflets;
}

BodyParticles leaflet_body(const geometry::SurfaceParticles& particles, int source, std::size_t number, double thickness) {
  BodyParticles body;
  body.source = source, body.name = "leaflet_" + std::to_string(number + 1), body.kind = sim::Kind::shell, body.thickness = thickness;
  body.position = particles.position, body.normal = particles.normal, body.fibre = particles.fibre, body.volume = particles.area;
  body.held = particles.attached, body.elements = particles.triangles;
  return body;
}

BodyParticles volume_body(const geometry::ParticleSet& set, const BodySpec& spec, int source) {
  BodyParticles body;
  body.source = source, body.name = spec.name, body.kind = spec.kind;
  body.position = set.position, body.volume = set.volume, body.normal = set.normal, body.depth = set.depth,
  body.surface_area = set.surface_area;
  return body;
}

int body_with_part(const SceneFile& scene, const std::string& part) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies[i].shape.type == ShapeType::patient && scene.bodies[i].shape.part == part) return static_cast<int>(i);
  refuse(scene.patient->spot, "the body for \"" + part + "\" has another shape", "leave its shape to [patient]");
}

sim::TimeTable scaled_wave(const WaveSpec& wave, const char* name, double heart_rate) {
  if (wave.table) return *wave.table;
  sim::TimeTable table = read_time_table(asset(std::string("waveforms/") + name), {});
  const auto [low, high] = std::minmax_element(table.value.begin(), table.value.end());
  const double least = *low, span = *high - *low;
  for (double& time : table.time) time *= (60 / heart_rate) / table.time.back();
  if (wave.systolic)
    for (double& value : table.value) value = *wave.diastolic + (value - least) / span * (*wave.systolic - *wave.diastolic);
  return table;
}

}  // namespace

CaseParticles place_patient(const SceneFile& scene) {
  const PatientSpec& patient = *scene.patient;
  const int leaflets = body_with_part(scene, "leaflets"), blood = body_with_part(scene, "blood"), aorta = body_with_part(scene, "aorta");
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies[i].shape.type != ShapeType::patient)
      refuse(scene.bodies[i].spot, "a valve case has no other bodies", "take it out, or take out [patient]");
  CaseParticles result;
  try {
    const Vessel vessel = patient.aorta.empty() ? synthetic_vessel(patient) : imported_vessel(patient);
    const double volume = geometry::signed_volume(vessel.lumen), l0 = scene.spacing;
    const double estimate = volume / std::pow(l0, 3) + 3.3 * geometry::surface_area(vessel.lumen) / (l0 * l0);
    if (estimate > static_cast<double>(scene.limits.particles))
      refuse(scene.spacing_spot, "makes about " + std::to_string(std::llround(estimate)) + " particles, more than limits.particles",
             "a spacing of " + std::to_string(l0 * std::cbrt(estimate / static_cast<double>(scene.limits.particles))) + " would fit");
    geometry::ValveCaseOptions options;
    options.spacing = l0, options.particle_limit = scene.limits.particles;
    const geometry::WallRadius wall(vessel.lumen, vessel.frame);
    const geometry::ValveTemplate valve = geometry::make_valve_template(
        vessel.frame, [&wall](double theta, double z) { return wall.radius_at(theta, z); }, valve_options(scene, scene.bodies[leaflets]));
    geometry::ValveCase placed =
        patient.leaflets.empty() ? geometry::place_valve_case(vessel.lumen, vessel.ports, valve, options)
                                 : geometry::place_valve_case(vessel.lumen, vessel.ports, leaflets_from_mesh(patient, vessel, l0), options);
    sim::ValveFrame frame;
    frame.annulus_center = vessel.frame.origin, frame.axis = vessel.frame.axis, frame.annulus_radius = valve.annulus_radius;
    frame.commissure_height = valve.commissure_height, frame.commissure_radius = valve.commissure_radius;
    const double thickness = scene.bodies[leaflets].elastic.thickness > 0 ? scene.bodies[leaflets].elastic.thickness : 0.5e-3;
    for (std::size_t k = 0; k < placed.leaflets.size(); ++k) {
      frame.leaflet_bodies.push_back(static_cast<std::int32_t>(k));
      result.bodies.push_back(leaflet_body(placed.leaflets[k], leaflets, k, thickness));
    }
    result.bodies.push_back(volume_body(placed.fluid, scene.bodies[blood], blood));
    result.bodies.push_back(volume_body(placed.wall, scene.bodies[aorta], aorta));
    for (const geometry::DomainPort& end : vessel.ports) {
      sim::Port<3> port;
      port.name = end.name, port.point = end.point, port.normal = end.normal, port.radius = end.radius;
      result.ports.push_back(port);
    }
    for (std::size_t k = 0; k < scene.ports.size(); ++k)
      (scene.ports[k].port.name == "ventricle" ? frame.ventricle_port : frame.aorta_port) = static_cast<std::int32_t>(k);
    result.valve = frame;
    result.lumen = vessel.lumen;
    for (const std::vector<std::string>* warnings : {&vessel.warnings, &std::as_const(valve).warnings, &std::as_const(placed).warnings})
      result.warnings.insert(result.warnings.end(), warnings->begin(), warnings->end());
    result.seconds = placed.seconds;
  } catch (const SceneError&) {
    throw;
  } catch (const std::exception& error) {
    refuse(patient.spot, error.what());
  }
  return result;
}

void set_patient_wave(const PatientSpec& patient, sim::Port<3>& port) {
  const bool ventricle = port.name == "ventricle";
  port.condition = sim::PortCondition::pressure;
  port.table = scaled_wave(ventricle ? patient.ventricle_pressure : patient.aortic_pressure,
                           ventricle ? "ventricle_pressure.csv" : "aortic_pressure.csv", patient.heart_rate);
  // The vessel beyond the outlet gives way to fast changes of flow (ports.h); a rigid outlet rings. Half of rho c, c = 5 m/s: the full
  // value keeps 0.5 kPa of the opening pressure from the valve.
  if (!ventricle && port.impedance == 0) port.impedance = 0.5 * 1060 * 5.0;
}

}  // namespace app
