// What the surgeon reads off a valve: orifice area and coaptation from the leaflets' positions. 3-D.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/scene_description.h"
#include "sim/shell.h"

namespace sim {

struct OrificeArea {
  double area = 0;             // m2: all openings
  double largest_opening = 0;  // m2: the largest connected one
};

// Geometric orifice area: the leaflets' triangles are projected along the valve's axis on a raster (pixel `resolution` m) inside the lumen
// radius (commissure_radius), thickened by half_thickness (half the contact distance: leaflets that touch are closed); what stays uncovered
// is open.
OrificeArea geometric_orifice_area(const ShellElasticity<3>& shells, std::span<const Eigen::Vector3d> position, const ValveFrame& valve,
                                   double half_thickness, double resolution = 1e-4);

struct Coaptation {
  double area = 0;    // m2: mean over both sides of leaflet area within `distance` of another leaflet
  double height = 0;  // m: area over the length of the coaptation lines (sum of the free edges / 2)
};
Coaptation coaptation(const ShellElasticity<3>& shells, std::span<const Eigen::Vector3d> position, double distance);

}  // namespace sim
