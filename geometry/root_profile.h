// Private to aortic_root: what is measured of a lumen along a line that may run through a root.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geometry/sections.h"
#include "geometry/triangle_mesh.h"
#include "geometry/triangle_tree.h"

namespace geometry::detail {

// A straight axis with angles about it; z from `origin`.
struct Axis {
  Eigen::Vector3d origin, direction, x_axis, y_axis;  // m; unit, right-handed
  Eigen::Vector3d at(double radius, double theta, double z) const;
};
Axis make_axis(const Eigen::Vector3d& origin, const Eigen::Vector3d& toward);

// Diameters D(s) of the sections across a centreline; 0 where there is no closed contour.
struct BoreProfile {
  std::vector<double> arc, diameter;  // m
  double length = 0;                  // m, of the whole centreline
};
BoreProfile measure_bore(const TriangleMesh& lumen, const Centreline& line);
BoreProfile reversed(const BoreProfile& bore);
// Leaves out the stations nearer than `share` diameters to the line's ends: there a cap's own edge would pass for wall.
BoreProfile without_ends(const BoreProfile& bore, double share);
std::vector<double> gauss_smooth(const std::vector<double>& values, double sigma);  // sigma in samples

// A widening between two narrower places, on the way from the ventricle (smaller s) to the aorta.
struct Candidate {
  double annulus_arc, sinus_arc, junction_arc;                 // m
  double annulus_diameter, sinus_diameter, junction_diameter;  // m
  bool inlet_missing = false;  // the line ends before the vessel has narrowed below the sinus: no outflow tract
};
std::vector<Candidate> find_widenings(const BoreProfile& profile);

// Step 5: three maxima of the mean r(theta) about the sinus.
struct Lobes {
  bool found = false;
  std::array<double, 3> peak{}, valley{};  // rad; valley i lies before peak i, peak i before valley i + 1
  double prominence = 0;                   // of the weakest lobe, share of the mean radius
  double third_harmonic = 0;               // amplitude, share of the mean radius
  std::string why;
};
Lobes find_lobes(const TriangleTree& tree, const Axis& axis, double z_sinus, double diameter);

// Step 6: where the sinus floor of the lobe at `theta` meets the outflow tract. Nothing where the wall shows no such bend.
std::optional<Eigen::Vector3d> find_nadir(const TriangleTree& tree, const Axis& axis, double theta, double z_sinus, double diameter);

// Step 7: z of the sinotubular junction above z_sinus.
std::optional<double> find_junction(const TriangleMesh& lumen, const Axis& axis, double z_sinus, double diameter);

}  // namespace geometry::detail
