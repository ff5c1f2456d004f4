// A valve case's particles: blood, three wall layers and three leaflets in a lumen.
#pragma once

#include <string>
#include <vector>

#include "geometry/cut_domain.h"
#include "geometry/place_particles.h"
#include "geometry/surface_particles.h"

namespace geometry {

struct ValveCaseOptions {
  double spacing = 1e-3;  // l0, m
  int wall_layers = 3;
  double leaflet_spacing = 0.8;  // in l0
  int embedded_rows = 2;
  std::int64_t particle_limit = 5'000'000;
  bool measure_leak = true;  // costs a second or two
};

struct ValveCase {
  ParticleSet wall, fluid;  // wall: open at the ports
  std::vector<SurfaceParticles> leaflets;
  std::vector<std::string> warnings;
  double fluid_density_mean = 0, fluid_density_deviation = 0;  // at interfaces, 1 = even
  double nearest = 0;  // smallest distance between two centres (embedded leaflet rows not counted), in l0
  double leak_clearance = 0;
  Eigen::Vector3d leak_place = Eigen::Vector3d::Zero();  // m, its narrowest point  // largest clearance to solid centres with which a path
                                                         // leads from ventricle to aorta, in l0
  double seconds = 0;
};

// `lumen` closed and oriented outward, `ports` its flat ends. Throws like place_particles.
ValveCase place_valve_case(const TriangleMesh& lumen, const std::vector<DomainPort>& ports, const ValveTemplate& valve,
                           const ValveCaseOptions& options);
// The same with leaflet particles already made (a user's leaflet mesh).
ValveCase place_valve_case(const TriangleMesh& lumen, const std::vector<DomainPort>& ports, std::vector<SurfaceParticles> leaflets,
                           const ValveCaseOptions& options);

}  // namespace geometry
