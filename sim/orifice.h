// What the surgeon reads off a valve: orifice area and coaptation from the leaflets' positions. 3-D.
#pragma once

#include <Eigen/Core>
#include <span>

#include "sim/valve_sheet.h"

namespace sim {

struct OrificeArea {
  double area = 0;             // m2: all openings
  double largest_opening = 0;  // m2: the largest connected one
};

// Geometric orifice area, as planimetry in short-axis view measures it: what is seen through, along the valve's axis, between the leaflets.
// The leaflets' triangles, thickened by half_thickness (half the tissue's thickness), are projected along the axis on a raster of
// `resolution` m. The region is the lumen as the attachments see it: within r(theta) of the held rows (commissure_radius where there are
// none). What stays uncovered is open, but for gaps narrower than 2 half_contact: no particle of blood fits
// through, so such gaps are closed (morphological opening of the uncovered region with a disc of half_contact - half_thickness).
OrificeArea geometric_orifice_area(const ValveSheet& sheet, std::span<const Eigen::Vector3d> position, double half_thickness,
                                   double half_contact, double resolution = 1e-4);

struct Coaptation {
  double area = 0;              // m2: leaflet area nearer than `distance` to another leaflet's surface, mean of the two sides
  double length = 0;            // m: half the sum of the free edges
  double height = 0;            // m: area / length
  double central = 0;           // m: length along which a leaflet's mid-line touches another leaflet; mean of the leaflets
  double effective_height = 0;  // m: of the free edges' middles over the annulus plane, mean of the leaflets (Schaefers' eH)
};
// Between rows the distance to the other leaflets is taken as linear, so that the border of the touching area lies between them.
Coaptation coaptation(const ValveSheet& sheet, std::span<const Eigen::Vector3d> position, double distance);

}  // namespace sim
