// What the surgeon reads off a valve: orifice area and coaptation from the leaflets' positions. 3-D.
#pragma once

#include <Eigen/Core>
#include <span>

#include "sim/scene_description.h"
#include "sim/shell.h"

namespace sim {

struct OrificeArea {
  double area = 0;             // m2: all openings
  double largest_opening = 0;  // m2: the largest connected one
};

// Geometric orifice area. The leaflets' triangles, thickened by half_thickness (half the contact distance: leaflets that touch are closed),
// are projected along the valve's axis on a raster of `resolution` m. Its region is the lumen as the attachments see it: within r(theta) of
// the held rows at the leaflets' base (commissure_radius where there are none). What stays uncovered there is open. Throws
// std::invalid_argument where the shells have no mesh.
OrificeArea geometric_orifice_area(const ShellElasticity<3>& shells, std::span<const Eigen::Vector3d> position, const ValveFrame& valve,
                                   double half_thickness, double resolution = 1e-4);

struct Coaptation {
  double area = 0;    // m2: leaflet area within `distance` of another leaflet, mean of the two sides
  double length = 0;  // m: half the sum of the free edges
  double height = 0;  // m: area / length
};
Coaptation coaptation(const ShellElasticity<3>& shells, std::span<const Eigen::Vector3d> position, double distance);

}  // namespace sim
