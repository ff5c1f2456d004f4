// The built-in patient: outflow tract, root with three sinuses, ascending aorta; smooth, straight axis +z, annulus at z = 0.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/cut_domain.h"
#include "geometry/root_frame.h"
#include "geometry/triangle_mesh.h"

namespace geometry {

// Metres. Defaults lie inside the corridors of the published measures (annulus 23, sinus 29.5, junction 25 mm).
struct SyntheticAorta {
  double annulus_diameter = 0.023, sinus_diameter = 0.0295, junction_diameter = 0.025, ascending_diameter = 0.028;
  double outflow_diameter = 0.0225;                          // of the outflow tract below the annulus
  double junction_height = 0.0185;                           // annulus to sinotubular junction
  double commissure_drop = 1.5e-3;                           // commissures lie this far below the junction
  double sinus_height = 0.0085;                              // z of the widest sinus section
  double outflow_length = 0.015, ascending_length = 0.0315;  // below the annulus; above the junction
  double extension = 0.020;                                  // straight flow extension at each end
  double first_commissure = 0.0;                             // rad; the others follow at 120 degrees
  double spacing = 0.7e-3;                                   // triangle edge
};

// Lumen radius R(theta, z), m.
double synthetic_radius(const SyntheticAorta& aorta, double theta, double z);

struct SyntheticPatient {
  TriangleMesh lumen;  // closed by flat caps, oriented outward, with the extensions
  RootFrame frame;
  AorticRoot root;
  std::vector<DomainPort> ports;  // ventricle (z lowest), aorta
};
SyntheticPatient make_synthetic_patient(const SyntheticAorta& aorta = {});

}  // namespace geometry
