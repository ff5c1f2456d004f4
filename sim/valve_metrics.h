// Clinical figures of a valve at one moment (docs/metrics.md has their definitions and sources). They need leaflets and blood as plain
// arrays, so a run computes them at every output and a report can compute them again from the frames of an older run file. 3-D.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/valve_sheet.h"

namespace sim {

// What is looked at. Leaflet arrays have one entry a sheet row.
struct ValveMoment {
  std::vector<Eigen::Vector3d> position, velocity;              // m, m/s
  std::vector<double> von_mises, principal;                     // Pa, of the face with the larger von Mises stress
  std::vector<Eigen::Vector3d> blood_position, blood_velocity;  // m, m/s: blood and port particles
  double flow = 0;                                              // m3/s through the valve, forward positive
  double pressure_difference = 0;                               // Pa, ventricle minus aorta
};
ValveMoment valve_moment(const ValveSheet& sheet, const RunFrame& frame);

struct NamedValue {
  std::string name, units;  // a column of the series
  double value = 0;
};
// All figures of the moment in a fixed order that depends on the number of leaflets alone. `rheology`: of the blood, for its shear stress.
std::vector<NamedValue> valve_metrics(const ValveSheet& sheet, const ValveMoment& moment, const Rheology& rheology);

// --- parts, each tested by itself ------------------------------------------------------------------------------------------------------

// 99.5th percentile of the blood's speed from the annulus to 15 mm beyond the commissures, m/s.
double jet_speed(const ValveFrame& frame, std::span<const Eigen::Vector3d> position, std::span<const Eigen::Vector3d> velocity);
// Continuity: flow / jet speed, m2; 0 where it means nothing: the flow is not forward, the jet slower than 0.2 m/s, or the largest opening
// smaller than 4 spacings squared (closed: what flow there is rings).
double effective_orifice_area(double flow, double jet_speed, double largest_opening, double spacing);
// Wall shear stress on each sheet row, Pa: the larger of its two sides. On a side, the blood's velocity relative to the row is fitted by
// u_t = g d through the surface (half the tissue's thickness off the mid-surface) over the particles within 1.8 l0; tau = mu(|g|) |g|.
std::vector<double> wall_shear_stress(const ValveSheet& sheet, const ValveMoment& moment, const Rheology& rheology);
// Largest principal membrane strain (stretch - 1) of each triangle, from its edges at rest and now.
std::vector<double> membrane_strain(const ValveSheet& sheet, std::span<const Eigen::Vector3d> position);
// Places of the tips of two leaflets along the line that joins their directions, m from the axis: what an M-mode beam through the right
// and the non-coronary cusp shows. first >= second where the leaflets are apart. Zeros where there are fewer than two tips.
struct MMode {
  double first = 0, second = 0;
};
MMode m_mode(const ValveSheet& sheet, std::span<const Eigen::Vector3d> position);
// q-quantile of the values, 0 of none. The q-th of n sorted values, without interpolation.
double quantile(std::vector<double> values, double q);

}  // namespace sim
