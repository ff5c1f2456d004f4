#include "sim/valve_metrics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sim/orifice.h"
#include "sim/point_grid.h"
#include "sim/rheology.h"

namespace sim {
namespace {

using Eigen::Vector3d;

// The tip's speed across the axis, outward positive; of the leaflets the one largest in size: opening positive, closing negative.
double tip_speed(const ValveSheet& sheet, const ValveMoment& moment) {
  double fastest = 0;
  for (const ValveSheet::Leaflet& leaflet : sheet.leaflets) {
    if (leaflet.tip < 0) continue;
    const double speed = leaflet.outward.dot(moment.velocity[static_cast<std::size_t>(leaflet.tip)]);
    if (std::abs(speed) > std::abs(fastest)) fastest = speed;
  }
  return fastest;
}

// Mean over pairs of leaflets of the distance between their tips across the axis.
double tip_separation(const ValveSheet& sheet, std::span<const Vector3d> position) {
  double sum = 0;
  int pairs = 0;
  for (std::size_t a = 0; a < sheet.leaflets.size(); ++a)
    for (std::size_t b = a + 1; b < sheet.leaflets.size(); ++b) {
      if (sheet.leaflets[a].tip < 0 || sheet.leaflets[b].tip < 0) continue;
      Vector3d between =
          position[static_cast<std::size_t>(sheet.leaflets[a].tip)] - position[static_cast<std::size_t>(sheet.leaflets[b].tip)];
      between -= sheet.frame.axis * sheet.frame.axis.dot(between);
      sum += between.norm(), ++pairs;
    }
  return pairs > 0 ? sum / pairs : 0;
}

// 99th percentile over the rows of a leaflet (-1: all) and a region (none: all but the clamp's).
double stress_quantile(const ValveSheet& sheet, const std::vector<double>& stress, int leaflet, const LeafletRegion* region) {
  std::vector<double> values;
  for (std::size_t i = 0; i < sheet.size(); ++i)
    if ((leaflet < 0 || sheet.leaflet[i] == leaflet) && (region ? sheet.region[i] == *region : sheet.region[i] != LeafletRegion::clamp))
      values.push_back(stress[i]);
  return quantile(std::move(values), 0.99);
}

// Weighted sums of one side of a row for the fit u_t = g d.
struct SideFit {
  Vector3d moment = Vector3d::Zero();
  double square = 0;
  void add(double distance, const Vector3d& velocity) { moment += distance * velocity, square += distance * distance; }
  double rate() const { return square > 0 ? moment.norm() / square : 0; }
};

}  // namespace

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

ValveMoment valve_moment(const ValveSheet& sheet, const RunFrame& frame) {
  ValveMoment moment;
  for (const std::int64_t signed_row : sheet.row) {
    const auto row = static_cast<std::size_t>(signed_row);
    moment.position.emplace_back(frame.position[row].data());
    moment.velocity.push_back(Eigen::Vector3f(frame.velocity[row].data()).cast<double>());
    moment.von_mises.push_back(frame.von_mises[row]), moment.principal.push_back(frame.principal_stress[row]);
  }
  for (std::size_t row = 0; row < frame.size(); ++row) {
    if (frame.kind[row] != static_cast<std::uint8_t>(Kind::fluid) && frame.kind[row] != static_cast<std::uint8_t>(Kind::port)) continue;
    moment.blood_position.emplace_back(frame.position[row].data());
    moment.blood_velocity.push_back(Eigen::Vector3f(frame.velocity[row].data()).cast<double>());
  }
  return moment;
}

double jet_speed(const ValveFrame& frame, std::span<const Vector3d> position, std::span<const Vector3d> velocity) {
  std::vector<double> speed;
  for (std::size_t i = 0; i < position.size(); ++i) {
    const double height = (position[i] - frame.annulus_center).dot(frame.axis);
    if (height > 0 && height < frame.commissure_height + 0.015) speed.push_back(velocity[i].norm());
  }
  return quantile(std::move(speed), 0.995);
}

double effective_orifice_area(double flow, double jet, double largest_opening, double spacing) {
  return flow > 0 && jet >= 0.2 && largest_opening >= 4 * spacing * spacing ? flow / jet : 0;
}

std::vector<double> wall_shear_stress(const ValveSheet& sheet, const ValveMoment& moment, const Rheology& rheology) {
  const double reach = 1.8 * sheet.spacing, half = 0.5 * sheet.thickness;
  std::vector<Vector3d> normal, position = moment.blood_position;
  std::vector<double> area, stress(sheet.size(), 0.0);
  sheet_normals_and_areas(sheet, moment.position, normal, area);
  const PointGrid<3> grid(position, reach);
  const auto rows = static_cast<std::int64_t>(sheet.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < rows; ++i) {
    SideFit side[2];
    grid.for_each_near(moment.position[i], reach, [&](std::int32_t j, double) {
      const Vector3d offset = moment.blood_position[j] - moment.position[i];
      const double height = offset.dot(normal[i]), distance = std::abs(height) - half;
      if (distance <= 0.1 * sheet.spacing || (offset - height * normal[i]).norm() > 1.2 * sheet.spacing) return;
      Vector3d relative = moment.blood_velocity[j] - moment.velocity[i];
      relative -= normal[i] * normal[i].dot(relative);
      side[height > 0].add(distance, relative);
    });
    for (const SideFit& fit : side)
      if (const double rate = fit.rate(); rate > 0) stress[i] = std::max(stress[i], rate * viscosity(rheology, rate, 1e3));
  }
  return stress;
}

std::vector<double> membrane_strain(const ValveSheet& sheet, std::span<const Vector3d> position) {
  std::vector<double> strain;
  strain.reserve(sheet.elements.size());
  for (const auto& e : sheet.elements) {
    const Vector3d r1 = sheet.rest[e[1]] - sheet.rest[e[0]], r2 = sheet.rest[e[2]] - sheet.rest[e[0]];
    const Vector3d d1 = position[e[1]] - position[e[0]], d2 = position[e[2]] - position[e[0]];
    const Vector3d t = r1.normalized(), s = (r2 - t * t.dot(r2)).normalized();
    Eigen::Matrix2d rest;
    rest << t.dot(r1), t.dot(r2), s.dot(r1), s.dot(r2);
    if (std::abs(rest.determinant()) < 1e-14) continue;  // a sliver of the mesh tells nothing
    Eigen::Matrix<double, 3, 2> now;
    now << d1, d2;
    const Eigen::Matrix<double, 3, 2> gradient = now * rest.inverse();
    const Eigen::Matrix2d metric = gradient.transpose() * gradient;  // C = F^T F; its largest eigenvalue is the stretch squared
    const double mean = 0.5 * metric.trace();
    strain.push_back(std::sqrt(mean + std::sqrt(std::max(0.0, mean * mean - metric.determinant()))) - 1);
  }
  return strain;
}

MMode m_mode(const ValveSheet& sheet, std::span<const Vector3d> position) {
  if (sheet.leaflets.size() < 2 || sheet.leaflets[0].tip < 0 || sheet.leaflets[1].tip < 0) return {};
  const Vector3d between = sheet.leaflets[0].outward - sheet.leaflets[1].outward;
  if (between.norm() < 1e-6) return {};
  const Vector3d line = between.normalized();
  const auto along = [&](int k) {
    return line.dot(position[static_cast<std::size_t>(sheet.leaflets[k].tip)] - sheet.frame.annulus_center);
  };
  return {along(0), along(1)};
}

std::vector<NamedValue> valve_metrics(const ValveSheet& sheet, const ValveMoment& moment, const Rheology& rheology) {
  std::vector<NamedValue> values;
  const auto add = [&](const std::string& name, const char* units, double value) { values.push_back({name, units, value}); };
  const OrificeArea orifice = geometric_orifice_area(sheet, moment.position, 0.5 * sheet.thickness, 0.5 * sheet.contact_distance());
  const Coaptation closed = coaptation(sheet, moment.position, sheet.contact_distance());
  const double jet = jet_speed(sheet.frame, moment.blood_position, moment.blood_velocity);
  add("orifice_area", "m2", orifice.area), add("largest_opening", "m2", orifice.largest_opening);
  add("coaptation_area", "m2", closed.area), add("coaptation_height", "m", closed.height);
  add("jet_speed", "m/s", jet);
  add("leaflet_stress_p99", "Pa", stress_quantile(sheet, moment.von_mises, -1, nullptr));
  add("leaflet_principal_p99", "Pa", stress_quantile(sheet, moment.principal, -1, nullptr));
  add("leaflet_strain_p99", "1", quantile(membrane_strain(sheet, moment.position), 0.99));
  add("central_coaptation", "m", closed.central), add("effective_height", "m", closed.effective_height);
  add("tip_speed", "m/s", tip_speed(sheet, moment)), add("tip_separation", "m", tip_separation(sheet, moment.position));
  const MMode echo = m_mode(sheet, moment.position);
  add("m_mode.first", "m", echo.first), add("m_mode.second", "m", echo.second);
  add("valve_flow", "m3/s", moment.flow), add("pressure_difference", "Pa", moment.pressure_difference);
  add("effective_orifice_area", "m2", effective_orifice_area(moment.flow, jet, orifice.largest_opening, sheet.spacing));
  const std::vector<double> shear = wall_shear_stress(sheet, moment, rheology);
  double mean = 0, count = 0;
  for (std::size_t i = 0; i < sheet.size(); ++i)
    if (!sheet.held[i]) mean += shear[i], ++count;
  add("leaflet_wall_shear_p99", "Pa", quantile(shear, 0.99)), add("leaflet_wall_shear_mean", "Pa", mean / std::max(1.0, count));
  for (int leaflet = 0; leaflet < static_cast<int>(sheet.leaflets.size()); ++leaflet)
    for (const LeafletRegion region : reported_regions) {
      const std::string name = "leaflet_" + std::to_string(leaflet + 1) + "." + region_name(region);
      add(name + ".von_mises", "Pa", stress_quantile(sheet, moment.von_mises, leaflet, &region));
      add(name + ".principal", "Pa", stress_quantile(sheet, moment.principal, leaflet, &region));
    }
  for (NamedValue& value : values)
    if (!std::isfinite(value.value)) value.value = 0;
  return values;
}

}  // namespace sim
