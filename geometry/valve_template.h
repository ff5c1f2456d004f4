// Three parametric leaflets fitted to an aortic root (design note "geometry", section 2; Labrosse et al. 2006, Thubrikar 1981).
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "geometry/root_frame.h"
#include "geometry/triangle_mesh.h"

namespace geometry {

struct ValveOptions {
  double free_edge_angle = 0.5585;      // phi, rad (32 deg): slope of the free edge against the sector's plane
  double coaptation_ratio = 0.3;        // Xs / Rc, central coaptation height
  double over_closure = 1e-3;           // d, m past the axis
  double sector_offset = 1e-3;          // g, m: sector planes moved off the commissure planes; about half thickness + l0/4
  double attachment_exponent = 0.55;    // q: 0.5 an ellipse, 1 a parabola
  double surplus = 1.03;                // profile length over the chord
  double thickness = 0.5e-3;            // m, material
  double reference_pressure = 133.322;  // Pa: the reference is relaxed under it (1 mmHg)
  double reference_modulus = 2e6;       // Pa, of the relaxing membrane
  double reference_bending = 5e-3;      // of the tension stiffness, on second differences, in the second relaxing, which opens creases
  int reference_iterations = 4000;
  int columns = 49, rows = 25;          // of the structured surface (w along the attachment, u from attachment to free edge)
  double wall_inset = 0;                // m: the attachment is put this far inside the wall
};

// One leaflet's design measures, metres (Labrosse: Lf free edge, Lh height, h height of the free edge's centre, Xs central coaptation).
struct LeafletMeasures {
  double free_edge_length = 0, height = 0, edge_center_height = 0, coaptation_height = 0, base_angle = 0;  // rad for base_angle
  double attachment_gap_max = 0;                                                                           // m, attachment to the wall
  double area = 0;                                                                                         // m²
};

// Structured surface: index = row * columns + column; row 0 lies on the wall, the last row is the free edge; columns run from one
// commissure to the other, counter-clockwise about the axis. (w, u) in [-1, 1] x [0, 1].
struct LeafletSurface {
  int columns = 0, rows = 0;
  std::vector<Eigen::Vector3d> reference;  // m, slightly open, nearly stress-free: the start and rest position
  std::vector<Eigen::Vector3d> design;     // m, the closed design whose lengths the reference keeps (surfaces overlap at the axis)
  std::vector<Eigen::Vector3d> fibre;      // unit, tangent, circumferential (along rows), in the reference
  LeafletMeasures measures;
  std::size_t index(int row, int column) const { return std::size_t(row) * columns + column; }
};

struct ValveTemplate {
  std::array<LeafletSurface, 3> leaflets;
  double annulus_radius = 0, commissure_radius = 0, commissure_height = 0;  // Rb, Rc, H: means, m
  double largest_strain = 0;                                                // of the reference against the design, over rows
  std::vector<std::string> warnings;                                        // measures out of the usual range and the like
};

// Labrosse et al. 2006: Lf² = 4 [Rc² + (H - h)²], Lh = Xs + Rb / cos a, h = Xs + Rb tan a, with h = H - Rc tan phi and Xs a share of Rc.
LeafletMeasures labrosse_measures(double base_radius, double commissure_radius, double commissure_height, const ValveOptions& options);

using WallRadiusFunction = std::function<double(double theta, double z)>;  // m; distance of the wall from the axis

// Throws std::runtime_error with one clear line where no leaflet fits (commissures out of order, height too small, no wall).
ValveTemplate make_valve_template(const RootFrame& frame, const WallRadiusFunction& radius_at, const ValveOptions& options = {});

// Structured surface as triangles; right-hand normal on the aortic side.
TriangleMesh leaflet_mesh(const LeafletSurface& leaflet, const std::vector<Eigen::Vector3d>& points);

}  // namespace geometry
