// The part of the lumen that is simulated: cut across the centreline below the annulus and above the sinotubular junction, capped,
// with straight flow extensions.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/aortic_root.h"
#include "geometry/sections.h"
#include "geometry/triangle_mesh.h"

namespace geometry {

struct DomainPort {
  std::string name;        // "ventricle" or "aorta"
  Eigen::Vector3d point;   // m, centre of the flat end of the extension
  Eigen::Vector3d normal;  // unit, out of the fluid
  double radius = 0;       // m, farthest rim point from `point`
  double area = 0;         // m²
};

struct CutOptions {                                             // for an annulus 23 mm wide; scaled with the root's own, 0.3 to 1.3
  double below_annulus_min = 0.012, below_annulus_max = 0.020;  // m along the centreline: cut where the section is smallest within
  double above_junction_min = 0.025, above_junction_max = 0.040;
  double extension = 0.020;  // m, straight; lengthened by what the vessel is too short
};

struct CutDomain {
  TriangleMesh surface;           // m; closed, oriented outward
  std::vector<DomainPort> ports;  // ventricle, aorta; branches inside the domain are walls, named in warnings
  std::vector<std::string> warnings;
};

// Throws std::runtime_error where no closed section exists to cut along.
CutDomain cut_domain(const TriangleMesh& lumen, const Centreline& centreline, const AorticRoot& root, const CutOptions& options = {});

}  // namespace geometry
